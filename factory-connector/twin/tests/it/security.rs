//! Who gets in.

use opcua_stack::opcua::{
    client::IdentityToken,
    crypto::SecurityPolicy,
    types::{ObjectId, StatusCode, UserTokenType},
};
use twin::CertificateState;

use crate::harness::{Client, TestTwin};

#[tokio::test]
async fn every_offered_policy_works() {
    let twin = TestTwin::start().await;
    for policy in
        [SecurityPolicy::Basic256Sha256, SecurityPolicy::Aes128Sha256RsaOaep, SecurityPolicy::Aes256Sha256RsaPss]
    {
        let client = twin.connect("vera", "vera-secret", policy).await.unwrap();
        assert!(!client.children(ObjectId::ObjectsFolder).await.is_empty(), "{policy}");
        client.close().await;
    }
    twin.stop().await;
}

#[tokio::test]
async fn neither_deprecated_nor_missing_security_is_offered() {
    let twin = TestTwin::start().await;
    let client = twin.client("vera").await;
    let builder = opcua_stack::opcua::client::ClientBuilder::new()
        .application_name("test client")
        .application_uri("urn:verbund:test:client")
        .pki_dir(twin.folder.path().join("client-vera"));
    let endpoints = builder.client().unwrap().get_server_endpoints_from_url(twin.url.as_ref()).await.unwrap();
    assert_eq!(endpoints.len(), 6, "three policies, each signed and encrypted");
    for endpoint in endpoints {
        let policy = SecurityPolicy::from_uri(endpoint.security_policy_uri.as_ref());
        assert!(policy != SecurityPolicy::None && !policy.is_deprecated(), "{policy}");
        let tokens = endpoint.user_identity_tokens.unwrap_or_default();
        assert!(tokens.iter().all(|token| token.token_type == UserTokenType::UserName), "{policy}: {tokens:?}");
    }
    for policy in [SecurityPolicy::Basic128Rsa15, SecurityPolicy::Basic256, SecurityPolicy::None] {
        assert!(twin.connect("vera", "vera-secret", policy).await.is_err(), "{policy}");
    }
    client.close().await;
    twin.stop().await;
}

#[tokio::test]
async fn wrong_passwords_and_unknown_users_are_told_apart_by_nobody() {
    let twin = TestTwin::start_with(|config| {
        config.security.trust_unknown_certificates = true;
        config.security.login_failures_max = 3;
    })
    .await;
    let policy = SecurityPolicy::Basic256Sha256;
    for (user, password) in [("vera", "wrong"), ("nobody", "x"), ("vera", ""), ("vera", "wrong")] {
        let refused = twin.connect(user, password, policy).await.err();
        assert_eq!(refused, Some(StatusCode::BadIdentityTokenRejected), "{user}");
    }
    // Three failures close the door for this user, even with the right password, and for no other.
    let throttled = twin.connect("vera", "vera-secret", policy).await.err();
    assert_eq!(throttled, Some(StatusCode::BadIdentityTokenRejected));
    twin.connect("otto", "otto-secret", policy).await.unwrap().close().await;
    twin.stop().await;
}

#[tokio::test]
async fn a_certificate_waits_for_its_approval() {
    let twin = TestTwin::start_with(|_| {}).await;
    let policy = SecurityPolicy::Basic256Sha256;
    assert!(twin.connect("vera", "vera-secret", policy).await.is_err());
    let list = twin.handle.trust_list().list().unwrap();
    assert_eq!(list.len(), 1);
    assert_eq!(list[0].state, CertificateState::Rejected);
    assert!(twin.handle.trust_list().trust(&list[0].thumbprint).unwrap());
    twin.connect("vera", "vera-secret", policy).await.unwrap().close().await;
    assert!(twin.handle.trust_list().reject(&list[0].thumbprint).unwrap());
    assert!(twin.connect("vera", "vera-secret", policy).await.is_err());
    assert!(!twin.handle.trust_list().trust("00").unwrap());
    twin.stop().await;
}

/// A certificate authority of the plant.
struct Authority {
    issuer: rcgen::Issuer<'static, rcgen::KeyPair>,
    certificate: Vec<u8>,
}

impl Authority {
    fn new(name: &str) -> Self {
        let mut params = rcgen::CertificateParams::default();
        params.distinguished_name.push(rcgen::DnType::CommonName, name);
        params.is_ca = rcgen::IsCa::Ca(rcgen::BasicConstraints::Unconstrained);
        params.key_usages = vec![rcgen::KeyUsagePurpose::KeyCertSign, rcgen::KeyUsagePurpose::CrlSign];
        let key = rcgen::KeyPair::generate().unwrap();
        let certificate = params.self_signed(&key).unwrap().der().to_vec();
        Self { issuer: rcgen::Issuer::new(params, key), certificate }
    }

    /// Writes a key and a certificate with this serial number where a client looks for them.
    fn issue(&self, folder: &std::path::Path, serial: u64) {
        let key = opcua_stack::opcua::crypto::PrivateKey::new(2048).unwrap().to_der().unwrap();
        let key = rcgen::KeyPair::try_from(key.as_bytes()).unwrap();
        let mut params = rcgen::CertificateParams::new(vec!["localhost".to_owned()]).unwrap();
        params.distinguished_name.push(rcgen::DnType::CommonName, format!("client {serial}"));
        params.serial_number = Some(serial.into());
        params.subject_alt_names.insert(0, rcgen::SanType::URI("urn:verbund:test:client".try_into().unwrap()));
        params.key_usages = vec![rcgen::KeyUsagePurpose::DigitalSignature, rcgen::KeyUsagePurpose::KeyEncipherment];
        let certificate = params.signed_by(&key, &self.issuer).unwrap();
        for name in ["own", "private"] {
            std::fs::create_dir_all(folder.join(name)).unwrap();
        }
        std::fs::write(folder.join("own/cert.der"), certificate.der()).unwrap();
        std::fs::write(folder.join("private/private.pem"), key.serialize_pem()).unwrap();
    }

    /// The list of what was revoked.
    fn revocation_list(&self, serials: &[u64]) -> Vec<u8> {
        let revoked = serials.iter().map(|serial| rcgen::RevokedCertParams {
            serial_number: (*serial).into(),
            revocation_time: rcgen::date_time_ymd(2026, 1, 1),
            reason_code: None,
            invalidity_date: None,
        });
        let params = rcgen::CertificateRevocationListParams {
            this_update: rcgen::date_time_ymd(2026, 1, 1),
            next_update: rcgen::date_time_ymd(2096, 1, 1),
            crl_number: 1_u64.into(),
            issuing_distribution_point: None,
            revoked_certs: revoked.collect(),
            key_identifier_method: rcgen::KeyIdMethod::Sha256,
        };
        params.signed_by(&self.issuer).unwrap().der().to_vec()
    }
}

#[tokio::test]
async fn certificates_of_a_trusted_authority_open_the_door_until_they_are_revoked() {
    let twin = TestTwin::start_with(|_| {}).await;
    let (plant, stranger) = (Authority::new("Plant CA"), Authority::new("Plant CA"));
    let connect = async |folder: &std::path::Path| {
        let identity = IdentityToken::new_user_name("vera", "vera-secret");
        Client::connect(&twin.url, folder.to_owned(), identity, SecurityPolicy::Basic256Sha256).await
    };
    let folder = |name: &str| twin.folder.path().join(name);
    let list = twin.handle.trust_list();
    list.trust_new(&plant.certificate).unwrap();
    for (name, authority, serial) in [("a", &plant, 1), ("b", &plant, 2), ("c", &stranger, 3), ("d", &plant, 4)] {
        authority.issue(&folder(name), serial);
    }

    assert_eq!(connect(&folder("a")).await.err(), Some(StatusCode::BadSecurityChecksFailed), "no revocation list yet");
    list.put_revocation_list(&stranger.revocation_list(&[])).unwrap();
    assert!(connect(&folder("a")).await.is_err(), "the list of another of the same name");
    list.put_revocation_list(&plant.revocation_list(&[2])).unwrap();
    connect(&folder("a")).await.unwrap().close().await;
    assert_eq!(connect(&folder("b")).await.err(), Some(StatusCode::BadSecurityChecksFailed), "revoked");
    assert!(connect(&folder("c")).await.is_err(), "another authority of the same name");
    list.put_revocation_list(&plant.revocation_list(&[1, 2])).unwrap();
    assert!(connect(&folder("a")).await.is_err(), "revoked now");
    connect(&folder("d")).await.unwrap().close().await;

    assert!(list.add_issuer(b"nonsense").is_err() && list.put_revocation_list(b"nonsense").is_err());
    twin.stop().await;
}

#[tokio::test]
async fn nobody_is_anonymous_unless_a_developer_says_so() {
    let open = TestTwin::start_with(|config| config.security.allow_anonymous_unencrypted = true).await;
    let pki = open.folder.path().join("client");
    let client = Client::connect(&open.url, pki, IdentityToken::Anonymous, SecurityPolicy::None).await.unwrap();
    assert!(!client.children(ObjectId::ObjectsFolder).await.is_empty());
    client.close().await;
    open.stop().await;

    let closed = TestTwin::start().await;
    let pki = closed.folder.path().join("client");
    let refused = Client::connect(&closed.url, pki, IdentityToken::Anonymous, SecurityPolicy::None).await;
    assert!(refused.is_err());
    closed.stop().await;
}
