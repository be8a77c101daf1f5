//! Audit trail of access, as the Server object's subscribers receive it, and renewal of the
//! certificate during sessions.

use std::time::{Duration, SystemTime};

use opcua_stack::opcua::{
    client::IdentityToken,
    crypto::{PrivateKey, SecurityPolicy},
    types::{NodeId, ObjectTypeId, StatusCode, Variant},
};
use testkit::wait::eventually;
use tokio::sync::mpsc::UnboundedReceiver;

use crate::{
    changes::events,
    harness::{Client, DEADLINE, TestTwin, document, message, next},
};

pub const FIELDS: [&str; 7] =
    ["EventType", "SourceName", "ClientUserId", "Status", "StatusCodeId", "SessionId", "Message"];

/// Waits for the next event of a type; others are skipped.
pub async fn next_of(
    heard: &mut UnboundedReceiver<Vec<Variant>>,
    of: ObjectTypeId,
) -> Vec<Variant> {
    loop {
        let event = next(heard).await;
        if event[0] == NodeId::from(of).into() {
            return event;
        }
    }
}

#[tokio::test]
async fn channels_and_sessions_are_audited() {
    let twin = TestTwin::start().await;
    let client = twin.client("anna").await;
    let mut heard = events(&client, ObjectTypeId::AuditEventType, &FIELDS).await;

    twin.client("otto").await.close().await;
    let opened = next_of(&mut heard, ObjectTypeId::AuditOpenSecureChannelEventType).await;
    assert_eq!((&opened[1], &opened[3]), (&"SecureChannel/OpenSecureChannel".into(), &true.into()));
    let created = next_of(&mut heard, ObjectTypeId::AuditCreateSessionEventType).await;
    assert_eq!((&created[2], &created[3]), (&"System/CreateSession".into(), &true.into()));
    let activated = next_of(&mut heard, ObjectTypeId::AuditActivateSessionEventType).await;
    assert_eq!((&activated[2], &activated[3]), (&"otto".into(), &true.into()));
    assert_eq!(activated[5], created[5], "both name the session");
    let closed = next_of(&mut heard, ObjectTypeId::AuditSessionEventType).await;
    assert_eq!((&closed[1], &closed[2]), (&"Session/CloseSession".into(), &"otto".into()));
    assert_eq!(closed[5], created[5]);

    assert!(twin.connect("otto", "wrong", SecurityPolicy::Basic256Sha256).await.is_err());
    let refused = next_of(&mut heard, ObjectTypeId::AuditActivateSessionEventType).await;
    assert_eq!((&refused[2], &refused[3]), (&"otto".into(), &false.into()));
    assert_eq!(refused[4], StatusCode::BadIdentityTokenRejected.into());

    let list = twin.handle.trust_list();
    let certificate = std::fs::read(twin.folder.path().join("client-otto/own/cert.der")).unwrap();
    list.trust_new(&certificate, "anna").unwrap();
    let changed = next_of(&mut heard, ObjectTypeId::TrustListUpdatedAuditEventType).await;
    assert_eq!((&changed[1], &changed[2]), (&"Method/UpdateTrustList".into(), &"anna".into()));
    assert!(list.reject(&list.list().unwrap()[0].thumbprint, "anna").unwrap());
    assert!(list.trust(&list.list().unwrap()[0].thumbprint, "anna").unwrap());

    let (identity, pki) = (
        IdentityToken::new_user_name("otto", "otto-secret"),
        twin.folder.path().join("client-otto"),
    );
    let silence = Duration::from_secs(1);
    let silent =
        Client::connect_for(&twin.url, pki, identity, SecurityPolicy::Basic256Sha256, silence)
            .await
            .unwrap();
    silent.vanish();
    let expired = next_of(&mut heard, ObjectTypeId::AuditSessionEventType).await;
    assert_eq!((&expired[1], &expired[2]), (&"Session/Timeout".into(), &"otto".into()));
    client.close().await;
    twin.stop().await;
}

#[tokio::test]
async fn sessions_of_a_user_can_be_ended() {
    let twin = TestTwin::start().await;
    twin.handle.apply(document(message("net", 1)));
    let anna = twin.client("anna").await;
    let (otto, vera) = (twin.client("otto").await, twin.client("vera").await);
    let mut heard = events(&anna, ObjectTypeId::AuditEventType, &FIELDS).await;
    let state = crate::harness::instance("net#Revision");
    let mut values = otto.subscribe(&[state]).await;
    next(&mut values).await;

    assert_eq!(twin.handle.end_sessions_of("otto").await, 1);
    let ended = next_of(&mut heard, ObjectTypeId::AuditSessionEventType).await;
    assert_eq!((&ended[1], &ended[2]), (&"Session/Terminated".into(), &"otto".into()));
    assert!(vera.read("net#Revision").await.status().is_good(), "others stay");
    assert_eq!(twin.handle.end_sessions_of("nobody").await, 0);
    // The subscription is gone with the session.
    twin.handle.apply(document(message("net", 2)));
    assert!(vera.read("net#Revision").await.status().is_good());
    let silence = tokio::time::timeout(Duration::from_millis(300), values.recv()).await;
    assert!(!matches!(silence, Ok(Some(_))), "nothing more is told: {silence:?}");
    otto.vanish();
    anna.close().await;
    vera.close().await;
    twin.stop().await;
}

#[tokio::test]
async fn sessions_are_listed_and_ended_one_by_one() {
    let twin = TestTwin::start().await;
    twin.handle.apply(document(message("net", 1)));
    let (one, other) = (twin.client("otto").await, twin.client("otto").await);
    let vera = twin.client("vera").await;
    let mut sessions = twin.handle.sessions_of("otto");
    sessions.sort_by_key(|session| session.number);
    let [first, second] = &sessions[..] else { panic!("{sessions:?}") };
    assert_eq!(first.address, Some(std::net::Ipv4Addr::LOCALHOST.into()));
    assert_eq!(first.application_name, "test client");
    let subject = first.certificate_subject.as_deref().unwrap_or_default();
    assert!(subject.contains("CN=test client"), "{subject}");
    assert!(first.started_at <= first.last_used_at, "{first:?}");

    assert!(!twin.handle.end_session_of("vera", first.number).await, "not hers");
    assert!(twin.handle.end_session_of("otto", first.number).await);
    assert!(!twin.handle.end_session_of("otto", first.number).await, "it is gone");
    assert!(other.read("net#Revision").await.status().is_good(), "the other one stays");
    assert!(vera.read("net#Revision").await.status().is_good());
    assert_eq!(twin.handle.sessions_of("otto").len(), 1);
    assert_eq!(twin.handle.sessions_of("otto")[0].number, second.number);
    assert!(twin.handle.sessions_of("nobody").is_empty());
    one.vanish();
    for client in [other, vera] {
        client.close().await;
    }
    twin.stop().await;
}

#[tokio::test]
async fn rejected_clients_are_audited() {
    let twin = TestTwin::start_with(|_| {}).await;
    assert!(twin.connect("anna", "anna-secret", SecurityPolicy::Basic256Sha256).await.is_err());
    let list = twin.handle.trust_list();
    list.trust(&list.list().unwrap()[0].thumbprint, "anna").unwrap();
    let client = twin.connect("anna", "anna-secret", SecurityPolicy::Basic256Sha256).await.unwrap();
    let mut heard = events(&client, ObjectTypeId::AuditSecurityEventType, &FIELDS).await;

    // Every user of these tests has a certificate of its own.
    assert!(twin.connect("otto", "otto-secret", SecurityPolicy::Basic256Sha256).await.is_err());
    let certificate = next_of(&mut heard, ObjectTypeId::AuditCertificateUntrustedEventType).await;
    assert_eq!(certificate[4], StatusCode::BadCertificateUntrusted.into());
    let refused = next_of(&mut heard, ObjectTypeId::AuditCreateSessionEventType).await;
    assert_eq!(
        (&refused[3], &refused[4]),
        (&false.into(), &StatusCode::BadSecurityChecksFailed.into())
    );

    // Encrypted for another certificate, a channel does not open.
    let mut bytes = crate::wire::hello(&twin.url, 65_535);
    bytes.extend(crate::wire::framed(b"OPNF", &[0xFF; 64]));
    crate::wire::send(&twin, &bytes).await;
    loop {
        let channel = next_of(&mut heard, ObjectTypeId::AuditOpenSecureChannelEventType).await;
        if channel[3] == false.into() {
            break;
        }
    }
    client.close().await;
    twin.stop().await;
}

/// Stores a certificate for the twin that is due for renewal in some seconds.
fn put_old_certificate(pki: &std::path::Path, seconds_left: i64, renewal_days: u32) {
    let key = rcgen::KeyPair::try_from(PrivateKey::new(2048).unwrap().to_der().unwrap().as_bytes())
        .unwrap();
    let mut params = rcgen::CertificateParams::new(Vec::new()).unwrap();
    params.subject_alt_names = vec![
        rcgen::SanType::URI("urn:verbund:twin:FOR_MUC".try_into().unwrap()),
        rcgen::SanType::IpAddress("127.0.0.1".parse().unwrap()),
    ];
    params.key_usages = vec![
        rcgen::KeyUsagePurpose::DigitalSignature,
        rcgen::KeyUsagePurpose::KeyEncipherment,
        rcgen::KeyUsagePurpose::DataEncipherment,
        rcgen::KeyUsagePurpose::ContentCommitment,
    ];
    let now = time::OffsetDateTime::from(SystemTime::now());
    params.not_before = now - time::Duration::days(1);
    params.not_after =
        now + time::Duration::days(renewal_days.into()) + time::Duration::seconds(seconds_left);
    let certificate = params.self_signed(&key).unwrap();
    for name in ["own", "private"] {
        std::fs::create_dir_all(pki.join(name)).unwrap();
    }
    std::fs::write(pki.join("own/cert.der"), certificate.der()).unwrap();
    std::fs::write(pki.join("private/private.pem"), key.serialize_pem()).unwrap();
}

#[tokio::test]
async fn the_certificate_is_renewed_during_sessions() {
    let mut old = Vec::new();
    let twin = TestTwin::start_with(|config| {
        config.security.trust_unknown_certificates = true;
        put_old_certificate(&config.pki_directory, 6, config.security.certificate_renewal_days);
        old = std::fs::read(config.pki_directory.join("own/cert.der")).unwrap();
    })
    .await;
    let own = twin.folder.path().join("pki/own/cert.der");
    assert_eq!(std::fs::read(&own).unwrap(), old, "it is good enough at the start");
    twin.handle.apply(document(message("net", 1)));
    let before = twin.client("vera").await;
    assert_eq!(shown(&before), old);
    let renewed = eventually("the certificate is renewed", 2 * DEADLINE, || async {
        // The session goes on, whatever happens to the certificate.
        assert!(before.read("net#Revision").await.status().is_good());
        another_than(&old, &twin).await
    });
    assert_eq!(renewed.await.unwrap(), std::fs::read(&own).unwrap());
    assert!(before.read("net#Revision").await.status().is_good());
    before.close().await;
    twin.stop().await;
}

/// Returns the certificate of the server, as this client got it.
pub fn shown(client: &Client) -> Vec<u8> {
    client.session.endpoint_info().endpoint.server_certificate.as_ref().to_vec()
}

/// Interval between two looks at the certificate: each is a connection.
const LOOK_INTERVAL: Duration = Duration::from_millis(100);

/// Returns the certificate that a new client gets when it is another one than `old`.
pub async fn another_than(old: &[u8], twin: &TestTwin) -> Result<Vec<u8>, String> {
    let client = connect_again(twin).await;
    let certificate = shown(&client);
    client.close().await;
    if certificate != old {
        return Ok(certificate);
    }
    tokio::time::sleep(LOOK_INTERVAL).await;
    Err("the old certificate".to_owned())
}

/// Connects with one more attempt: the certificate may change between the request for the endpoints
/// and the connection.
async fn connect_again(twin: &TestTwin) -> Client {
    for _ in 0..2 {
        let identity = IdentityToken::new_user_name("otto", "otto-secret");
        let pki = twin.folder.path().join("client-otto");
        if let Ok(client) =
            Client::connect(&twin.url, pki, identity, SecurityPolicy::Basic256Sha256).await
        {
            return client;
        }
    }
    panic!("clients get in before and after")
}
