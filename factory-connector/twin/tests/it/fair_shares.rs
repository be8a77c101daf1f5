//! Shares of clients that have signed in: what one uses up, the others do not feel.

use std::{path::PathBuf, time::Duration};

use opcua_stack::opcua::{
    client::{DataChangeCallback, IdentityToken},
    crypto::SecurityPolicy,
    types::{
        AttributeId, BrowseDescription, BrowseDirection, BrowseResultMask,
        MonitoredItemCreateRequest, NodeId, ReadValueId, ReferenceTypeId, StatusCode,
        TimestampsToReturn,
    },
};
use twin::TwinConfig;

use crate::{
    harness::{Client, DEADLINE, TestTwin, document, instance, message},
    hostile::assert_served,
    raw_session::RawSession,
    wire::{frame, refusal},
};

async fn twin_with(adjust: impl FnOnce(&mut TwinConfig)) -> TestTwin {
    let twin = TestTwin::start_with(|config| {
        config.security.trust_unknown_certificates = true;
        adjust(config);
    })
    .await;
    twin.handle.apply(document(message("net", 1)));
    twin
}

/// Connects a user with another certificate than its usual one.
async fn elsewhere(twin: &TestTwin, user: &str) -> Result<Client, StatusCode> {
    let identity = IdentityToken::new_user_name(user, format!("{user}-secret"));
    let pki: PathBuf = twin.folder.path().join("elsewhere");
    Client::connect(&twin.url, pki, identity, SecurityPolicy::Basic256Sha256).await
}

#[tokio::test]
async fn one_client_leaves_sessions_to_others() {
    let twin = twin_with(|config| {
        config.limits.sessions_max = 6;
        config.limits.sessions_per_client_max = 3;
    })
    .await;
    let mut greedy = Vec::new();
    for _ in 0..3 {
        greedy.push(twin.client("vera").await);
    }
    // Another certificate makes no other client of a user.
    assert_eq!(elsewhere(&twin, "vera").await.err(), Some(StatusCode::BadTooManySessions));
    for _ in 0..8 {
        let policy = SecurityPolicy::Basic256Sha256;
        let refused = twin.connect("vera", "vera-secret", policy).await.err();
        assert_eq!(refused, Some(StatusCode::BadTooManySessions));
    }
    let other = twin.client("otto").await;
    assert_served(&other).await;
    for client in &greedy {
        assert_served(client).await;
    }
    // Who lost a connection gets in again, long before the session's timeout.
    greedy.remove(0).vanish();
    let mut again = elsewhere(&twin, "vera").await;
    for _ in 0..20 {
        if again.is_ok() {
            break;
        }
        again = elsewhere(&twin, "vera").await;
    }
    assert_served(again.as_ref().unwrap()).await;
    for client in greedy.into_iter().chain(again).chain([other]) {
        assert_served(&client).await;
        client.close().await;
    }
    twin.stop().await;
}

async fn subscription(client: &Client) -> Result<u32, StatusCode> {
    let callback = DataChangeCallback::new(|_, _| {});
    let interval = Duration::from_millis(100);
    let created = client.session.create_subscription(interval, 1000, 100, 0, 0, true, callback);
    created.await.map_err(|error| error.status())
}

async fn monitor(client: &Client, subscription: u32, items: usize) -> Result<(), StatusCode> {
    let item = MonitoredItemCreateRequest {
        item_to_monitor: ReadValueId {
            node_id: instance("net#Revision"),
            attribute_id: AttributeId::Value as u32,
            ..ReadValueId::default()
        },
        ..MonitoredItemCreateRequest::default()
    };
    let created = client.session.create_monitored_items(
        subscription,
        TimestampsToReturn::Both,
        vec![item; items],
    );
    created.await.map(drop).map_err(|error| error.status())
}

#[tokio::test]
async fn subscriptions_and_items_count_over_all_sessions_of_a_client() {
    let twin = twin_with(|config| {
        config.limits.subscriptions_per_client_max = 2;
        config.limits.monitored_items_per_client_max = 3;
    })
    .await;
    let (first, second) = (twin.client("vera").await, elsewhere(&twin, "vera").await.unwrap());
    let other = twin.client("otto").await;
    let (one, two) = (subscription(&first).await.unwrap(), subscription(&second).await.unwrap());
    assert_eq!(subscription(&second).await, Err(StatusCode::BadTooManySubscriptions));
    assert_eq!(monitor(&first, one, 2).await, Ok(()));
    assert_eq!(monitor(&second, two, 2).await, Err(StatusCode::BadTooManyMonitoredItems));
    assert_eq!(monitor(&second, two, 1).await, Ok(()));
    // Another client feels nothing of it.
    let theirs = subscription(&other).await.unwrap();
    assert_eq!(monitor(&other, theirs, 3).await, Ok(()));
    // What ends gives its place back.
    first.session.delete_subscription(one).await.unwrap();
    assert_eq!(monitor(&second, two, 2).await, Ok(()));
    assert!(subscription(&second).await.is_ok());
    for client in [first, second, other] {
        client.close().await;
    }
    twin.stop().await;
}

#[tokio::test]
async fn continuation_points_count_over_all_sessions_of_a_client() {
    let twin = twin_with(|_| {}).await;
    let (first, second) = (twin.client("vera").await, elsewhere(&twin, "vera").await.unwrap());
    let other = twin.client("otto").await;
    let wanted = BrowseDescription {
        node_id: instance("net#OperationNetwork"),
        browse_direction: BrowseDirection::Both,
        reference_type_id: ReferenceTypeId::References.into(),
        include_subtypes: true,
        node_class_mask: 0,
        result_mask: BrowseResultMask::All as u32,
    };
    let browse = async |client: &Client| {
        let results = client.session.browse(&vec![wanted.clone(); 60], 1, None).await.unwrap();
        results.iter().filter(|result| result.status_code.is_good()).count()
    };
    assert_eq!([browse(&first).await, browse(&second).await, browse(&other).await], [60, 40, 60]);
    // They end with their session.
    first.close().await;
    assert_eq!(browse(&second).await, 60);
    second.close().await;
    other.close().await;
    twin.stop().await;
}

/// Sends intermediate chunks of 50 024 bytes, of which 83 are less than 4 MiB.
async fn unfinished(session: &mut RawSession, chunks: usize) {
    for _ in 0..chunks {
        // The twin may have closed the connection.
        if session.chunk(b"MSGC", &[0; 50_000]).await.is_err() {
            break;
        }
    }
}

#[tokio::test]
async fn unfinished_messages_have_a_length_a_share_and_an_end() {
    let twin = twin_with(|config| config.security.allow_anonymous_unencrypted = true).await;
    let other = twin.client("otto").await;
    let mut long = RawSession::sign_in(&twin).await;
    unfinished(&mut long, 84).await;
    assert_eq!(refusal(&mut long.stream).await, StatusCode::BadTcpMessageTooLarge.bits());
    // Below that length, several connections have a share of 16 MiB.
    let mut several = Vec::new();
    for _ in 0..4 {
        let mut session = RawSession::sign_in(&twin).await;
        unfinished(&mut session, 80).await;
        several.push(session);
    }
    let mut one_more = RawSession::sign_in(&twin).await;
    unfinished(&mut one_more, 16).await;
    several.push(one_more);
    // The server reads all of them at once, so it is one of the five that goes beyond the share.
    let ended = futures::future::select_all(
        several.iter_mut().map(|session| Box::pin(frame(&mut session.stream))),
    );
    let (answer, refused, _) = tokio::time::timeout(DEADLINE, ended).await.expect("one in time");
    assert_eq!(&answer[..4], b"ERRF");
    let status = u32::from_le_bytes(answer[8..12].try_into().unwrap());
    assert_eq!(status, StatusCode::BadTcpNotEnoughResources.bits());
    several.remove(refused);
    assert_served(&other).await;
    // And they are not kept.
    for session in &mut several {
        let ended = tokio::time::timeout(Duration::from_secs(40), frame(&mut session.stream));
        let ended = ended.await.expect("the connection ends in time");
        assert_eq!(&ended[..4], b"ERRF");
        let status = u32::from_le_bytes(ended[8..12].try_into().unwrap());
        assert_eq!(status, StatusCode::BadTimeout.bits());
    }
    let mut next = RawSession::sign_in(&twin).await;
    unfinished(&mut next, 80).await;
    let answer = tokio::time::timeout(Duration::from_millis(500), frame(&mut next.stream)).await;
    assert!(answer.is_err(), "there is room for the next one");
    assert_served(&other).await;
    other.close().await;
    twin.stop().await;
}

#[tokio::test]
async fn a_client_learns_how_long_requests_may_be() {
    let twin = twin_with(|_| {}).await;
    let client = twin.client("vera").await;
    let read = async |bytes: usize| {
        let wanted = ReadValueId {
            node_id: NodeId::new(1, "x".repeat(bytes)),
            attribute_id: AttributeId::Value as u32,
            ..ReadValueId::default()
        };
        client.session.read(&[wanted], TimestampsToReturn::Both, 0.0).await.is_ok()
    };
    assert!(read(3 << 20).await, "3 MiB");
    assert!(!read(5 << 20).await, "5 MiB");
    // It did not even send it, so that it stays connected.
    assert_served(&client).await;
    client.close().await;
    twin.stop().await;
}
