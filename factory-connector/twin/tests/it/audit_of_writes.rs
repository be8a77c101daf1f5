//! Audit events of writes: who hears them, and which values they contain.

use asi_model::StatusCode as ModelStatus;
use opcua_stack::opcua::{
    client::IdentityToken,
    crypto::SecurityPolicy,
    types::{NodeId, ObjectTypeId, StatusCode, Variant},
};
use tokio::sync::mpsc::UnboundedReceiver;

use crate::{
    audit::next_of,
    changes::events,
    harness::{
        COARSENED, Client, TestTwin, document, external, field, field_id, instance, message, next,
    },
};

/// Every field that an AuditWriteUpdateEventType has.
const FIELDS: [&str; 17] = [
    "EventType",
    "SourceNode",
    "ClientUserId",
    "Status",
    "StatusCodeId",
    "OldValue",
    "NewValue",
    "EventId",
    "SourceName",
    "Time",
    "ReceiveTime",
    "Message",
    "Severity",
    "ActionTimeStamp",
    "ClientAuditEntryId",
    "AttributeId",
    "IndexRange",
];

/// The answers for values that the gate does not let through as they are: coarsened, held back by a
/// delay, a time step or a withheld state, and refused.
const NOT_RELEASED: [ModelStatus; 3] =
    [ModelStatus::GOOD_CLAMPED, ModelStatus::GOOD_COMPLETES_ASYNCHRONOUSLY, ModelStatus::BAD];

type Heard = UnboundedReceiver<Vec<Variant>>;

fn is_write(event: &[Variant]) -> bool {
    event[0] == NodeId::from(ObjectTypeId::AuditWriteUpdateEventType).into()
}

/// Returns the event types heard until a failed sign-in, which everybody hears.
async fn heard_until_sign_in(heard: &mut Heard) -> Vec<Vec<Variant>> {
    let end = NodeId::from(ObjectTypeId::AuditActivateSessionEventType).into();
    let mut before = Vec::new();
    loop {
        let event = next(heard).await;
        if event[0] == end && event[3] == false.into() {
            return before;
        }
        before.push(event);
    }
}

#[tokio::test]
async fn only_those_who_may_write_hear_of_writes() {
    let twin = TestTwin::start_with(|config| {
        config.security.trust_unknown_certificates = true;
        config.security.allow_anonymous_unencrypted = true;
    })
    .await;
    twin.handle.apply(document(message("net", 1)));
    twin.handle.publish_decision(&field("net", "progressStatus"), external());
    let nobody = Client::connect(
        &twin.url,
        twin.folder.path().join("client-nobody"),
        IdentityToken::Anonymous,
        SecurityPolicy::None,
    )
    .await
    .unwrap();
    let (anna, otto, vera) =
        (twin.client("anna").await, twin.client("otto").await, twin.client("vera").await);
    let mut of_writers = Vec::new();
    for client in [&anna, &otto] {
        of_writers.push(events(client, ObjectTypeId::AuditEventType, &FIELDS).await);
    }
    let mut of_readers = Vec::new();
    for client in [&vera, &nobody] {
        of_readers.push(events(client, ObjectTypeId::BaseEventType, &FIELDS).await);
    }

    let id = field_id("net", "progressStatus");
    for answer in NOT_RELEASED.into_iter().chain([ModelStatus::GOOD]) {
        *twin.connector.answer.lock() = Some(answer);
        otto.write(&id, 4711_u64).await;
    }
    assert_eq!(vera.write(&id, 4711_u64).await, StatusCode::BadUserAccessDenied);
    // What everybody may read, everybody hears of, too.
    twin.handle.publish_decision(&field("net", "percent"), external());
    assert!(twin.connect("otto", "wrong", SecurityPolicy::Basic256Sha256).await.is_err());

    for heard in &mut of_writers {
        let writes = heard_until_sign_in(heard).await;
        let writes: Vec<&Variant> = writes
            .iter()
            .filter(|event| is_write(event) && event[1] == instance(&id).into())
            .map(|event| &event[4])
            .collect();
        let statuses = [
            StatusCode::GoodClamped,
            StatusCode::GoodCompletesAsynchronously,
            StatusCode::Bad,
            StatusCode::Good,
            StatusCode::BadUserAccessDenied,
        ];
        assert_eq!(writes, statuses.map(Variant::from).iter().collect::<Vec<_>>());
    }
    let decided = instance(&format!("{}#MappingState", field_id("net", "percent")));
    for heard in &mut of_readers {
        let writes = heard_until_sign_in(heard).await;
        let about: Vec<&Variant> =
            writes.iter().filter(|event| is_write(event)).map(|event| &event[1]).collect();
        assert_eq!(about, [&decided.clone().into()], "no write, but the decision");
    }
    for client in [anna, otto, vera, nobody] {
        client.close().await;
    }
    twin.stop().await;
}

#[tokio::test]
async fn a_session_that_ended_leaves_the_others_listening() {
    let twin = TestTwin::start().await;
    twin.handle.apply(document(message("net", 1)));
    twin.handle.publish_decision(&field("net", "progressStatus"), external());
    let anna = twin.client("anna").await;
    let mut heard = events(&anna, ObjectTypeId::AuditWriteUpdateEventType, &FIELDS).await;
    let otto = twin.client("otto").await;
    events(&otto, ObjectTypeId::AuditWriteUpdateEventType, &FIELDS).await;
    otto.close().await;
    let gone = twin.client("otto").await;
    events(&gone, ObjectTypeId::AuditWriteUpdateEventType, &FIELDS).await;
    gone.vanish();
    assert_eq!(twin.handle.end_sessions_of("otto").await, 1);
    anna.write(&field_id("net", "progressStatus"), 5_u64).await;
    assert_eq!(next(&mut heard).await[6], 5_u64.into());
    anna.close().await;
    twin.stop().await;
}

#[tokio::test]
async fn audit_events_contain_no_value_that_was_not_disclosed() {
    let twin = TestTwin::start().await;
    twin.handle.apply(document(message("net", 1)));
    let client = twin.client("anna").await;
    let mut heard = events(&client, ObjectTypeId::AuditEventType, &FIELDS).await;
    let of_write = ObjectTypeId::AuditWriteUpdateEventType;
    let id = field_id("net", "progressStatus");
    let mut raw = 47_110_000_u64;
    // What no role or type allows, in whichever state the field is.
    let mut written = Vec::new();
    for value in [Variant::from(raw), "47110000".into(), vec![raw].into()] {
        client.write(&id, value).await;
        written.push(next_of(&mut heard, of_write).await);
    }
    twin.handle.publish_decision(&field("net", "progressStatus"), external());
    next_of(&mut heard, of_write).await;
    client.write(&id, "47110000").await;
    written.push(next_of(&mut heard, of_write).await);
    // What the gate does not let through as it is, one after the other: the value of the one is the
    // old value of the next.
    for answer in NOT_RELEASED.into_iter().chain(NOT_RELEASED) {
        *twin.connector.answer.lock() = Some(answer);
        raw += 1;
        client.write(&id, raw).await;
        written.push(next_of(&mut heard, of_write).await);
    }
    for event in &written {
        // Times and the id of the event have any digits.
        let has_any = |one: &&Variant| matches!(one, Variant::DateTime(_) | Variant::ByteString(_));
        let said: Vec<_> = event.iter().filter(|one| !has_any(one)).collect();
        let text = format!("{said:?}");
        assert!(!text.contains("4711"), "{text}");
        assert_eq!(event[6], Variant::Empty, "{text}");
    }
    assert_eq!(written.last().unwrap()[5], COARSENED.into(), "the value that was disclosed");

    *twin.connector.answer.lock() = None;
    for (value, before) in [(47_120_000_u64, COARSENED), (47_130_000, 47_120_000)] {
        client.write(&id, value).await;
        let event = next_of(&mut heard, of_write).await;
        assert_eq!((&event[5], &event[6]), (&before.into(), &value.into()), "as disclosed");
    }
    client.close().await;
    twin.stop().await;
}
