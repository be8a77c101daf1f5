//! Conformance of a database behind the repositories. Only `fresh` names a database; a second one
//! runs the same cases.

use asi_model::{
    DateTime, FieldKey, OperationNetworkId, RequestKey, StatusCode,
    messages::{Decision, DecisionTarget, MappingState},
};
use messaging::{Fetch, Lane, LogicalAddress, Rejection, RowId, RowOutcome, SendOutcome};
use platform::store::{
    BrokerCredential, Collaboration, CurrentValue, DecisionEffect, Holder, NetworkRow,
    NewDeadLetter, NewField, NewInboxMessage, NewOutgoing, Organisation, Scope, Store, Work,
};
use serde_json::json;

use crate::harness::opened;

struct Fresh {
    store: Store,
    _folder: tempfile::TempDir,
}

async fn fresh() -> Fresh {
    let folder = tempfile::tempdir().expect("a folder");
    let store = Store::open(&folder.path().join("store.sqlite")).await.expect("it opens");
    Fresh { store, _folder: folder }
}

fn at(seconds: i64) -> DateTime {
    DateTime::from_unix_micros(seconds * 1_000_000)
}

fn id<T: std::str::FromStr<Err: std::fmt::Debug>>(text: &str) -> T {
    text.parse().expect("valid")
}

async fn seed(work: &mut Work) {
    for name in ["a", "b"] {
        let organisation =
            Organisation { organisation_id: id(name), name: name.into(), created_at: at(0) };
        assert!(work.organisations().add(&organisation).await.expect("stored"));
        assert!(
            !work.organisations().add(&organisation).await.expect("stored"),
            "an id is taken once"
        );
    }
    work.factories().add(&id("F"), &id("a"), "F", at(0)).await.expect("stored");
    let collaboration = Collaboration {
        collaboration_id: id("c"),
        name: "c".into(),
        created_at: at(0),
        members: vec![id("a")],
        factories: vec![id("F")],
    };
    assert!(work.collaborations().add(&collaboration).await.expect("stored"));
    let network =
        serde_json::from_value(json!({ "operationNetworkId": "net", "operationList": [] }))
            .expect("valid");
    let row = NetworkRow {
        collaboration_id: id("c"),
        revision: 1,
        network,
        updated_at: at(1),
        updated_by: "u".into(),
        author_organisation: None,
        withdrawn_at: None,
        drawn_by: Some(id("a")),
    };
    work.networks().put(&row).await.expect("stored");
}

fn field(name: &str) -> FieldKey {
    let request = RequestKey {
        operation_network_id: id("net"),
        operation_id: id("op"),
        dynamic_data_request_id: id("req"),
    };
    request.field(id(name))
}

fn value(epoch: u32, sequence: u32, value: u32) -> CurrentValue {
    CurrentValue {
        key: field("count"),
        epoch,
        sequence,
        value: json!(value),
        built_in_type: 7,
        status: StatusCode::GOOD,
        source_timestamp: None,
        report_timestamp: None,
        received_at: at(5),
        recipient_set: None,
    }
}

fn decision(state: MappingState, seconds: i64, factory: &str) -> Decision {
    Decision {
        message_id: id("m"),
        factory_id: id(factory),
        target: DecisionTarget::Field {
            operation_network_id: id("net"),
            operation_id: id("op"),
            dynamic_data_request_id: id("req"),
            field_name: id("count"),
        },
        mapping_state: state,
        reason: None,
        decided_at: at(seconds),
        disclosure: None,
    }
}

#[tokio::test]
async fn work_that_is_not_committed_did_not_happen() {
    let Fresh { store, _folder } = fresh().await;
    let mut work = store.begin().await.expect("begun");
    seed(&mut work).await;
    drop(work);
    let mut work = store.read().await.expect("begun");
    assert!(work.organisations().list(&Scope::Platform).await.expect("read").is_empty());
}

#[tokio::test]
async fn scopes_hide_what_was_not_granted() {
    let Fresh { store, _folder } = fresh().await;
    let mut work = store.begin().await.expect("begun");
    seed(&mut work).await;
    let net: OperationNetworkId = id("net");
    for (scope, is_visible) in [
        (Scope::Platform, true),
        (Scope::Administration { looking_for: None }, true),
        (Scope::Organisation(id("a")), true),
        (Scope::Organisation(id("b")), false),
        (Scope::Nothing, false),
    ] {
        assert_eq!(
            work.networks().lookup(&scope, &net).await.expect("read").is_some(),
            is_visible,
            "{scope:?}"
        );
        assert_eq!(
            work.networks().list(&scope, "", 10).await.expect("read").len() == 1,
            is_visible,
            "{scope:?}"
        );
        assert_eq!(
            work.factories().list(&scope).await.expect("read").len() == 1,
            is_visible,
            "{scope:?}"
        );
        assert_eq!(
            work.collaborations().list(&scope).await.expect("read").len() == 1,
            is_visible,
            "{scope:?}"
        );
    }
}

#[tokio::test]
async fn tokens_are_used_once_and_in_time() {
    let Fresh { store, _folder } = fresh().await;
    let mut work = store.begin().await.expect("begun");
    seed(&mut work).await;
    let mut credentials = work.credentials();
    credentials.add_token(&[1; 32], &id("F"), at(0), at(10)).await.expect("stored");
    assert_eq!(credentials.use_token(&[2; 32], at(1)).await.expect("read"), None, "unknown");
    assert_eq!(credentials.use_token(&[1; 32], at(10)).await.expect("read"), None, "too late");
    assert_eq!(credentials.use_token(&[1; 32], at(9)).await.expect("read"), Some(id("F")));
    assert_eq!(credentials.use_token(&[1; 32], at(9)).await.expect("read"), None, "used");
}

#[tokio::test]
async fn the_newest_two_credentials_of_each_holder_are_alive() {
    let Fresh { store, _folder } = fresh().await;
    let mut work = store.begin().await.expect("begun");
    let mut credentials = work.credentials();
    for (holder, secret) in [("F", 1), ("F", 2), ("G", 9), ("F", 3)] {
        let credential =
            BrokerCredential { holder: Holder::Factory(id(holder)), secret_hash: [secret; 32] };
        credentials.add(&credential, at(0)).await.expect("stored");
    }
    let alive: Vec<u8> = credentials
        .list()
        .await
        .expect("read")
        .iter()
        .map(|(known, _)| known.secret_hash[0])
        .collect();
    assert_eq!(alive, [2, 9, 3]);
    assert_eq!(
        credentials
            .revoke(&Holder::Factory(id("F")), DateTime::from_ticks(1))
            .await
            .expect("revoked"),
        2
    );
    assert_eq!(credentials.list().await.expect("read").len(), 1);
}

#[tokio::test]
async fn the_current_value_is_that_of_the_highest_epoch_and_sequence() {
    let Fresh { store, _folder } = fresh().await;
    let mut work = store.begin().await.expect("begun");
    seed(&mut work).await;
    let wanted = [NewField { key: field("count"), factory_id: id("F"), position: 0 }];
    work.fields().replace(&id("net"), &wanted).await.expect("stored");
    let open = decision(MappingState::Mapped, 0, "F");
    let effect = work.fields().decide(&field("count"), &open).await.expect("stored");
    assert_eq!(effect, DecisionEffect::Opened);
    for (epoch, sequence, number, expected) in
        [(2, 5, 1, 1), (2, 4, 2, 1), (2, 5, 3, 1), (1, 9, 4, 1), (3, 0, 5, 5)]
    {
        work.fields().put_values(&[value(epoch, sequence, number)]).await.expect("stored");
        let fields = work.fields().list(&Scope::Platform, &id("net")).await.expect("read");
        let fields = opened(fields).await;
        let current = fields[0].current.as_ref().map(|current| current.value.clone());
        assert_eq!(current, Some(json!(expected)), "epoch {epoch}, sequence {sequence}");
    }
    // A field that is no longer asked for takes its value along.
    work.fields().replace(&id("net"), &[]).await.expect("stored");
    work.fields().replace(&id("net"), &wanted).await.expect("stored");
    let effect = work.fields().decide(&field("count"), &open).await.expect("stored");
    assert_eq!(effect, DecisionEffect::Opened);
    let fields = work.fields().list(&Scope::Platform, &id("net")).await.expect("read");
    assert_eq!(opened(fields).await[0].current, None);
}

#[tokio::test]
async fn a_decision_holds_until_a_later_one_and_survives_a_revision() {
    let Fresh { store, _folder } = fresh().await;
    let mut work = store.begin().await.expect("begun");
    seed(&mut work).await;
    let wanted = [NewField { key: field("count"), factory_id: id("F"), position: 0 }];
    work.fields().replace(&id("net"), &wanted).await.expect("stored");
    for (state, seconds, factory, effect) in [
        (MappingState::Mapped, 10, "F", DecisionEffect::Opened),
        (MappingState::Mapped, 10, "F", DecisionEffect::Repeated),
        (MappingState::Mapped, 12, "F", DecisionEffect::Changed),
        (MappingState::Refused, 9, "F", DecisionEffect::Ignored),
        (MappingState::Refused, 11, "G", DecisionEffect::Ignored),
    ] {
        let taken = work
            .fields()
            .decide(&field("count"), &decision(state, seconds, factory))
            .await
            .expect("stored");
        assert_eq!(taken, effect, "{state:?} at {seconds} by {factory}");
    }
    work.fields().replace(&id("net"), &wanted).await.expect("stored");
    let fields = work.fields().list(&Scope::Platform, &id("net")).await.expect("read");
    let fields = opened(fields).await;
    assert_eq!(fields[0].mapping_state, MappingState::Mapped);
}

#[tokio::test]
async fn each_set_of_recipients_is_stored_once() {
    let Fresh { store, _folder } = fresh().await;
    let mut work = store.begin().await.expect("begun");
    let set = |ids: &[&str]| ids.iter().map(|organisation| id(organisation)).collect();
    let mut sets = Vec::new();
    for ids in [&["a", "b"][..], &["b", "a"], &["a"], &[]] {
        sets.push(work.recipient_sets().intern(&set(ids)).await.expect("stored"));
    }
    assert!(sets[0].is_some() && sets[0] == sets[1] && sets[1] != sets[2]);
    assert_eq!(sets[3], None, "nobody");
}

#[tokio::test]
async fn messages_are_new_once_per_address() {
    let Fresh { store, _folder } = fresh().await;
    let mut work = store.begin().await.expect("begun");
    let message = |text: &str, seconds| NewInboxMessage {
        message_id: id(text),
        message_type: "ua-data".into(),
        received_at: at(seconds),
        body: "{}".into(),
    };
    let first = work
        .inbox()
        .store("x", &[message("1", 0), message("2", 9), message("1", 9)])
        .await
        .expect("stored");
    assert_eq!(first.len(), 2);
    assert!(work.inbox().store("x", &[message("1", 9)]).await.expect("stored").is_empty());
    assert_eq!(work.inbox().store("y", &[message("1", 9)]).await.expect("stored").len(), 1);
    assert_eq!(work.inbox().forget(at(5), 100).await.expect("forgotten"), 1);
    assert_eq!(work.inbox().store("x", &[message("1", 9)]).await.expect("stored").len(), 1);
}

#[tokio::test]
async fn outgoing_messages_wait_in_order_until_they_are_gone_or_parked() {
    let Fresh { store, _folder } = fresh().await;
    let mut work = store.begin().await.expect("begun");
    let address = LogicalAddress::FactoryRequests(id("F"));
    for number in 0..3 {
        let message = NewOutgoing {
            address: address.clone(),
            message_id: id(&format!("m{number}")),
            subject: "comment".into(),
            correlation_id: None,
            created_at: at(number),
            time_to_live: None,
            content_encoding: None,
            body: "{}".into(),
        };
        work.outgoing().add(&message).await.expect("stored");
    }
    let fetch = Fetch { lane: Lane::Control, after: RowId(0), through: None, limit: 10 };
    let rows = work.outgoing().fetch(fetch).await.expect("read");
    assert_eq!(rows.iter().map(|row| row.id.0).collect::<Vec<_>>(), [1, 2, 3]);
    let outcome =
        |number: usize, outcome| RowOutcome { id: rows[number].id, outcome, at: at(9).into() };
    let rejection = || Rejection { code: "c".into(), reason: "r".into() };
    let outcomes = [
        outcome(0, SendOutcome::Accepted),
        outcome(1, SendOutcome::Parked(rejection())),
        outcome(2, SendOutcome::Rejected(rejection())),
    ];
    work.outgoing().record(&outcomes).await.expect("stored");
    let rows = work.outgoing().fetch(fetch).await.expect("read");
    assert_eq!(rows.iter().map(|row| (row.id.0, row.attempts)).collect::<Vec<_>>(), [(3, 1)]);
    let backlog = work.outgoing().backlog().await.expect("read");
    assert_eq!((backlog.waiting, backlog.oldest_at), (1, Some(at(2).into())));
}

#[tokio::test]
async fn dead_letters_are_listed_newest_first_in_pages() {
    let Fresh { store, _folder } = fresh().await;
    let mut work = store.begin().await.expect("begun");
    for number in 0..5 {
        let letter = NewDeadLetter {
            address: "factory.F.ingress".into(),
            message_id: None,
            subject: "ua-data".into(),
            code: "NOT_UTF8",
            reason: "The body is not UTF-8.".into(),
            received_at: at(number),
            body: vec![0xff],
            content_encoding: None,
            signature: None,
        };
        work.dead_letters().add(&letter).await.expect("stored");
    }
    let ids = async |work: &mut Work, before| -> Vec<u64> {
        let letters = work.dead_letters().list(before, 2).await.expect("read");
        letters.iter().map(|letter| letter.dead_letter_id).collect()
    };
    assert_eq!(ids(&mut work, None).await, [5, 4]);
    assert_eq!(ids(&mut work, Some(4)).await, [3, 2]);
    assert_eq!(ids(&mut work, Some(2)).await, [1]);
}
