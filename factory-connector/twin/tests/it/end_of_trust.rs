//! Sessions of clients whose certificate loses its trust.

use std::{
    fs,
    path::Path,
    time::{Duration, Instant},
};

use opcua_stack::opcua::{
    core::RequestMessage,
    crypto::SecurityPolicy,
    types::{
        AnonymousIdentityToken, AttributeId, ExtensionObject, MessageSecurityMode, ObjectId,
        ReadRequest, ReadValueId, StatusCode, TimestampsToReturn,
    },
};
use twin::{CertificateState, TrustList};

use crate::{
    authority::Authority,
    harness::{DEADLINE, TestTwin},
    raw_client::{RawChannel, RawClient, SessionKey},
    sign_in::{Secret, token},
};

const POLICY: SecurityPolicy = SecurityPolicy::Basic256Sha256;

/// Approves the certificate of a client that was rejected.
async fn approve(twin: &TestTwin, user: &str) -> String {
    assert!(twin.connect(user, &format!("{user}-secret"), POLICY).await.is_err());
    let list = twin.handle.trust_list();
    let waiting = list.list().unwrap().into_iter().find(|one| one.rejection.is_some()).unwrap();
    assert!(list.trust(&waiting.thumbprint, "anna").unwrap());
    waiting.thumbprint
}

/// Reads a node that is always there; the status of the answer.
async fn read(channel: &RawChannel, key: &SessionKey) -> StatusCode {
    let wanted = ReadValueId {
        node_id: ObjectId::Server.into(),
        attribute_id: AttributeId::BrowseName as u32,
        ..ReadValueId::default()
    };
    let request = ReadRequest {
        request_header: channel.header(&key.token),
        max_age: 0.0,
        timestamps_to_return: TimestampsToReturn::Both,
        nodes_to_read: Some(vec![wanted]),
    };
    match channel.try_exchange(RequestMessage::from(request)).await {
        Ok(answer) => answer.response_header().service_result,
        Err(closed) => closed,
    }
}

/// Waits until a session answers no more; the status with which it refuses.
async fn refused_in_time(channel: &RawChannel, key: &SessionKey) -> StatusCode {
    let read = async {
        loop {
            let status = read(channel, key).await;
            if status.is_bad() {
                break status;
            }
            tokio::time::sleep(Duration::from_millis(20)).await;
        }
    };
    tokio::time::timeout(DEADLINE, read).await.expect("the session ends in time")
}

/// Signs vera in with the certificate of a folder.
async fn sign_in(twin: &TestTwin, folder: &Path) -> (RawClient, RawChannel, SessionKey) {
    let client =
        RawClient::of(twin, folder.to_owned(), POLICY, MessageSecurityMode::SignAndEncrypt).await;
    let channel = client.open_channel().await;
    let mut key = client.create_session(&channel).await.unwrap();
    let user = token(&client, Secret::Plain, key.server_nonce.as_ref());
    assert_eq!(client.activate(&channel, &mut key, user).await, StatusCode::Good);
    assert_eq!(read(&channel, &key).await, StatusCode::Good);
    (client, channel, key)
}

async fn resume(client: &RawClient, key: &mut SessionKey) -> (RawChannel, StatusCode) {
    let channel = client.open_channel().await;
    let user = token(client, Secret::Plain, key.server_nonce.as_ref());
    let status = client.activate(&channel, key, user).await;
    (channel, status)
}

#[tokio::test]
async fn a_denied_client_loses_its_sessions() {
    let twin = TestTwin::start_with(|_| {}).await;
    let thumbprint = approve(&twin, "vera").await;
    approve(&twin, "otto").await;
    let (client, channel, mut key) = sign_in(&twin, &twin.folder.path().join("client-vera")).await;
    let (_, others, other) = sign_in(&twin, &twin.folder.path().join("client-otto")).await;
    let idle = client.create_session(&channel).await.unwrap();

    assert!(twin.handle.trust_list().reject(&thumbprint, "anna").unwrap());
    assert_eq!(refused_in_time(&channel, &key).await, StatusCode::BadSessionIdInvalid);
    assert_eq!(read(&others, &other).await, StatusCode::Good, "others stay");
    // On the channel that is still open, a session that was not activated is gone as well.
    let user = token(&client, Secret::Plain, idle.server_nonce.as_ref());
    let activated = client.activate(&channel, &mut idle.clone(), user).await;
    assert_eq!(activated, StatusCode::BadSessionIdInvalid);
    drop(channel);
    assert_eq!(resume(&client, &mut key).await.1, StatusCode::BadSessionIdInvalid);
    twin.stop().await;
}

#[tokio::test]
async fn a_session_is_resumed_only_with_its_certificate_and_while_that_is_trusted() {
    let twin = TestTwin::start_with(|config| {
        config.security.trust_unknown_certificates = true;
        config.security.allow_anonymous_unencrypted = true;
    })
    .await;
    for user in ["vera", "otto"] {
        twin.client(user).await.close().await;
    }
    let folder = |user: &str| twin.folder.path().join(format!("client-{user}"));
    let (client, channel, mut key) = sign_in(&twin, &folder("vera")).await;
    drop(channel);
    let (channel, status) = resume(&client, &mut key).await;
    assert_eq!(status, StatusCode::Good, "it moves to another channel of the same client");
    assert_eq!(read(&channel, &key).await, StatusCode::Good);
    drop(channel);

    // A client that got hold of token, nonce and key: its channel has another certificate.
    let mode = MessageSecurityMode::SignAndEncrypt;
    let other = RawClient::of(&twin, folder("otto"), POLICY, mode).await;
    let channel = other.open_channel().await;
    let user = token(&client, Secret::Plain, key.server_nonce.as_ref());
    let status = client.activate(&channel, &mut key.clone(), user).await;
    assert_eq!(status, StatusCode::BadSecurityChecksFailed);
    // Nor does it go on without security.
    let none = MessageSecurityMode::None;
    let open = RawClient::of(&twin, folder("vera"), SecurityPolicy::None, none).await;
    let channel = open.open_channel().await;
    let anonymous = AnonymousIdentityToken { policy_id: "anonymous".into() };
    let user = ExtensionObject::from_message(anonymous);
    let status = client.activate(&channel, &mut key.clone(), user).await;
    assert_eq!(status, StatusCode::BadSecurityChecksFailed);

    // Denied by hand: the session is still there, and its client gets it no more.
    let pki = twin.folder.path().join("pki");
    fs::copy(folder("vera").join("own/cert.der"), pki.join("denied/vera.der")).unwrap();
    let status = resume(&client, &mut key).await.1;
    assert_eq!(status, StatusCode::BadSecurityChecksFailed);
    fs::remove_file(pki.join("denied/vera.der")).unwrap();
    assert_eq!(resume(&client, &mut key).await.1, StatusCode::Good, "the session was there");
    twin.stop().await;
}

#[tokio::test]
async fn the_channel_of_a_client_that_lost_its_trust_is_not_renewed() {
    let twin = TestTwin::start().await;
    twin.client("vera").await.close().await;
    let folder = twin.folder.path().join("client-vera");
    let mode = MessageSecurityMode::SignAndEncrypt;
    let mut client = RawClient::of(&twin, folder.clone(), POLICY, mode).await;
    client.token_lifetime = Duration::from_secs(2);
    let channel = client.open_channel().await;
    let mut key = client.create_session(&channel).await.unwrap();
    let user = token(&client, Secret::Plain, key.server_nonce.as_ref());
    assert_eq!(client.activate(&channel, &mut key, user).await, StatusCode::Good);
    let begun = Instant::now();
    while begun.elapsed() < client.token_lifetime * 2 {
        assert_eq!(read(&channel, &key).await, StatusCode::Good, "it is renewed while trusted");
        tokio::time::sleep(Duration::from_millis(100)).await;
    }
    // Denied by hand, of which the twin learns when it looks.
    fs::copy(folder.join("own/cert.der"), twin.folder.path().join("pki/denied/vera.der")).unwrap();
    let status = refused_in_time(&channel, &key).await;
    assert_ne!(status, StatusCode::BadSessionIdInvalid, "the session was still there");
    twin.stop().await;
}

#[tokio::test]
async fn sessions_end_when_their_certificate_is_revoked_or_its_authority_removed() {
    let twin = TestTwin::start_with(|_| {}).await;
    let plant = Authority::new("Plant CA");
    let list: &TrustList = twin.handle.trust_list();
    list.trust_new(&plant.certificate, "anna").unwrap();
    list.put_revocation_list(&plant.revocation_list(&[]), "anna").unwrap();
    let mut clients = Vec::new();
    for serial in 1..=2 {
        let folder = twin.folder.path().join(format!("machine-{serial}"));
        plant.issue(&folder, serial);
        clients.push(sign_in(&twin, &folder).await);
    }
    let [(_, first, first_key), (_, second, second_key)] = &clients[..] else { unreachable!() };

    list.put_revocation_list(&plant.revocation_list(&[1]), "anna").unwrap();
    assert_eq!(refused_in_time(first, first_key).await, StatusCode::BadSessionIdInvalid);
    assert_eq!(read(second, second_key).await, StatusCode::Good, "it is not revoked");
    let authority = list.authorities().unwrap().remove(0);
    assert!(list.remove_authority(&authority.thumbprint, "anna").unwrap());
    assert_eq!(refused_in_time(second, second_key).await, StatusCode::BadSessionIdInvalid);
    twin.stop().await;
}

#[tokio::test]
async fn a_client_of_a_trusted_authority_is_denied_by_itself_and_loses_its_sessions() {
    let twin = TestTwin::start_with(|_| {}).await;
    let plant = Authority::new("Plant CA");
    let list: &TrustList = twin.handle.trust_list();
    list.trust_new(&plant.certificate, "anna").unwrap();
    list.put_revocation_list(&plant.revocation_list(&[]), "anna").unwrap();
    let folder = |serial: u64| twin.folder.path().join(format!("machine-{serial}"));
    let mut clients = Vec::new();
    for serial in 1..=4 {
        plant.issue(&folder(serial), serial);
    }
    for serial in 1..=3 {
        clients.push(sign_in(&twin, &folder(serial)).await);
    }
    let [(client, first, first_key), (_, second, second_key), (_, third, third_key)] = &clients[..]
    else {
        unreachable!()
    };
    let listed = list.list().unwrap();
    let states: Vec<_> = listed.iter().map(|one| one.state).collect();
    assert_eq!(states, [CertificateState::Issued; 3], "all that came in are there to be denied");

    let denied = listed.iter().find(|one| one.subject.contains("client 1")).unwrap();
    assert!(list.reject(&denied.thumbprint, "anna").unwrap());
    assert_eq!(refused_in_time(first, first_key).await, StatusCode::BadSessionIdInvalid);
    let again = client.open_channel().await;
    assert!(client.create_session(&again).await.is_err(), "nor does it come in again");
    // By its certificate, as where a machine was stolen.
    let certificate = |serial| fs::read(folder(serial).join("own/cert.der")).unwrap();
    list.deny_new(&certificate(2), "anna").unwrap();
    assert_eq!(refused_in_time(second, second_key).await, StatusCode::BadSessionIdInvalid);
    list.deny_new(&certificate(4), "anna").unwrap();
    let mode = MessageSecurityMode::SignAndEncrypt;
    let fourth = RawClient::of(&twin, folder(4), POLICY, mode).await;
    let channel = fourth.open_channel().await;
    assert!(fourth.create_session(&channel).await.is_err(), "it never came in");
    assert_eq!(read(third, third_key).await, StatusCode::Good, "others stay");
    twin.stop().await;
}
