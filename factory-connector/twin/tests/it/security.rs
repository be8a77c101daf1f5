//! Access of clients: policies, passwords, certificates, authorities.

use opcua_stack::opcua::{
    client::IdentityToken,
    crypto::SecurityPolicy,
    types::{MessageSecurityMode, ObjectId, StatusCode, UserTokenType},
};
use twin::{CertificateState, RejectionReason, RevocationKnowledge, TwinError};

use crate::{
    authority::Authority,
    harness::{Client, DEADLINE, TestTwin, now},
};

#[tokio::test]
async fn every_offered_policy_works() {
    let twin = TestTwin::start().await;
    for policy in [
        SecurityPolicy::Basic256Sha256,
        SecurityPolicy::Aes128Sha256RsaOaep,
        SecurityPolicy::Aes256Sha256RsaPss,
    ] {
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
    let endpoints =
        builder.client().unwrap().get_server_endpoints_from_url(twin.url.as_ref()).await.unwrap();
    assert_eq!(endpoints.len(), 3, "three policies, each encrypted");
    for endpoint in endpoints {
        let policy = SecurityPolicy::from_uri(endpoint.security_policy_uri.as_ref());
        assert!(policy != SecurityPolicy::None && !policy.is_deprecated(), "{policy}");
        assert_eq!(endpoint.security_mode, MessageSecurityMode::SignAndEncrypt, "{policy}");
        let tokens = endpoint.user_identity_tokens.unwrap_or_default();
        assert!(
            tokens.iter().all(|token| token.token_type == UserTokenType::UserName),
            "{policy}: {tokens:?}"
        );
    }
    for policy in [SecurityPolicy::Basic128Rsa15, SecurityPolicy::Basic256, SecurityPolicy::None] {
        assert!(twin.connect("vera", "vera-secret", policy).await.is_err(), "{policy}");
    }
    client.close().await;
    twin.stop().await;
}

#[tokio::test]
async fn wrong_passwords_and_unknown_users_get_the_same_answer() {
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
    assert_eq!(list[0].application_uri.as_deref(), Some("urn:verbund:test:client"));
    let first = list[0].rejection.clone().expect("the rejection is listed");
    assert_eq!(
        (first.reason, first.address),
        (RejectionReason::NotTrusted, Some("127.0.0.1".parse().unwrap()))
    );
    assert_eq!(first.application_name.as_deref(), Some("test client"));
    assert!(now().since(first.rejected_at) < DEADLINE);
    assert!(twin.handle.trust_list().trust(&list[0].thumbprint, "anna").unwrap());
    twin.connect("vera", "vera-secret", policy).await.unwrap().close().await;
    let trusted = twin.handle.trust_list().list().unwrap();
    assert_eq!((trusted[0].state, &trusted[0].rejection), (CertificateState::Trusted, &None));
    assert!(twin.handle.trust_list().reject(&list[0].thumbprint, "anna").unwrap());
    assert_eq!(
        twin.handle.trust_list().list().unwrap()[0].rejection,
        None,
        "no client was rejected since"
    );
    assert!(twin.connect("vera", "vera-secret", policy).await.is_err());
    let again =
        twin.handle.trust_list().list().unwrap()[0].rejection.clone().expect("a second rejection");
    assert!(again.rejected_at > first.rejected_at);
    assert!(!twin.handle.trust_list().trust("00", "anna").unwrap());
    twin.stop().await;
}

#[tokio::test]
async fn certificates_of_a_trusted_authority_are_accepted_until_they_are_revoked() {
    let twin = TestTwin::start_with(|_| {}).await;
    let (plant, stranger) = (Authority::new("Plant CA"), Authority::new("Plant CA"));
    let connect = async |folder: &std::path::Path| {
        let identity = IdentityToken::new_user_name("vera", "vera-secret");
        Client::connect(&twin.url, folder.to_owned(), identity, SecurityPolicy::Basic256Sha256)
            .await
    };
    let folder = |name: &str| twin.folder.path().join(name);
    let list = twin.handle.trust_list();
    list.trust_new(&plant.certificate, "anna").unwrap();
    for (name, authority, serial) in
        [("a", &plant, 1), ("b", &plant, 2), ("c", &stranger, 3), ("d", &plant, 4)]
    {
        authority.issue(&folder(name), serial);
    }

    assert_eq!(
        connect(&folder("a")).await.err(),
        Some(StatusCode::BadSecurityChecksFailed),
        "no revocation list yet"
    );
    // By hand, as it would not be taken.
    std::fs::write(folder("pki/crl/stranger.crl"), stranger.revocation_list(&[])).unwrap();
    assert!(connect(&folder("a")).await.is_err(), "the list of another of the same name");
    list.put_revocation_list(&plant.revocation_list(&[2]), "anna").unwrap();
    connect(&folder("a")).await.unwrap().close().await;
    assert_eq!(
        connect(&folder("b")).await.err(),
        Some(StatusCode::BadSecurityChecksFailed),
        "revoked"
    );
    assert!(connect(&folder("c")).await.is_err(), "another authority of the same name");
    list.put_revocation_list(&plant.revocation_list(&[1, 2]), "anna").unwrap();
    assert!(connect(&folder("a")).await.is_err(), "revoked now");
    connect(&folder("d")).await.unwrap().close().await;

    let authority = list.authorities().unwrap().remove(0);
    assert!(list.remove_authority(&authority.thumbprint, "anna").unwrap());
    assert!(connect(&folder("d")).await.is_err(), "its authority is no longer trusted");
    assert!(!list.remove_authority(&authority.thumbprint, "anna").unwrap());
    twin.stop().await;
}

#[tokio::test]
async fn authorities_are_listed_with_the_state_of_their_revocation_lists() {
    let twin = TestTwin::start_with(|_| {}).await;
    let list = twin.handle.trust_list();
    let (root, between) = (Authority::new("Root"), Authority::new("Between"));
    list.trust_new(&root.certificate, "anna").unwrap();
    list.add_issuer(&between.certificate, "anna").unwrap();
    // Lists that were there before, under any name, give way to the newer one.
    std::fs::write(
        twin.folder.path().join("pki/crl/old.crl"),
        root.revocation_list_of(&[1], 2024, 2025),
    )
    .unwrap();
    let shown = list.authorities().unwrap();
    let names: Vec<_> = shown.iter().map(|one| (one.subject.as_str(), one.is_trusted)).collect();
    assert_eq!(names, [("CN=Root", true), ("CN=Between", false)]);
    assert!(
        matches!(shown[0].revocation, RevocationKnowledge::Outdated { .. }),
        "{:?}",
        shown[0].revocation
    );
    assert_eq!(shown[1].revocation, RevocationKnowledge::Missing);
    assert!(list.list().unwrap().is_empty(), "an authority is no client");

    list.put_revocation_list(&root.revocation_list(&[1, 2]), "anna").unwrap();
    let lists = list.revocation_lists().unwrap();
    assert_eq!(lists.len(), 1, "{lists:?}");
    assert_eq!((lists[0].issuer.as_str(), lists[0].revoked), ("CN=Root", 2));
    assert!(lists[0].is_signed_by_known_authority && lists[0].next_update.is_some());
    assert!(matches!(
        list.authorities().unwrap()[0].revocation,
        RevocationKnowledge::Current { .. }
    ));

    assert!(list.remove_authority(&shown[0].thumbprint, "anna").unwrap());
    assert!(!list.revocation_lists().unwrap()[0].is_signed_by_known_authority);
    assert!(list.remove_revocation_list(&lists[0].id, "anna").unwrap());
    assert!(!list.remove_revocation_list("../trusted/x", "anna").unwrap());
    assert!(list.revocation_lists().unwrap().is_empty());
    twin.stop().await;
}

#[tokio::test]
async fn files_for_the_trust_list_are_refused_with_all_their_faults() {
    let twin = TestTwin::start_with(|_| {}).await;
    let list = twin.handle.trust_list();
    let codes = |result: Result<(), TwinError>| match result {
        Err(TwinError::Refused { faults }) => {
            faults.into_iter().map(|fault| fault.code).collect::<Vec<_>>()
        }
        other => panic!("it should be refused, not {other:?}"),
    };
    let (plant, stranger) = (Authority::new("Plant CA"), Authority::new("Plant CA"));
    let current = plant.revocation_list(&[]);
    let old = plant.revocation_list_of(&[], 2024, 2025);
    assert_eq!(codes(list.trust_new(b"nonsense", "anna")), ["NOT_A_CERTIFICATE"]);
    assert_eq!(codes(list.trust_new(&current, "anna")), ["NOT_A_CERTIFICATE"]);
    assert_eq!(
        codes(list.put_revocation_list(&plant.certificate, "anna")),
        ["NOT_A_REVOCATION_LIST"]
    );
    assert_eq!(codes(list.put_revocation_list(&current, "anna")), ["UNKNOWN_ISSUER"]);
    assert_eq!(codes(list.put_revocation_list(&old, "anna")), ["UNKNOWN_ISSUER", "OUTDATED"]);
    list.trust_new(&plant.certificate, "anna").unwrap();
    assert_eq!(
        codes(list.put_revocation_list(&stranger.revocation_list(&[]), "anna")),
        ["WRONG_SIGNATURE"]
    );
    list.put_revocation_list(&current, "anna").unwrap();
    assert_eq!(codes(list.put_revocation_list(&old, "anna")), ["OUTDATED", "OLDER_THAN_KNOWN"]);

    // The client's key is none for RSA policies and not for signing, and it expired; that of an
    // authority neither.
    let mut params = rcgen::CertificateParams::default();
    params.not_after = rcgen::date_time_ymd(2020, 1, 1);
    params.key_usages = vec![rcgen::KeyUsagePurpose::KeyEncipherment];
    let wrong = params.self_signed(&rcgen::KeyPair::generate().unwrap()).unwrap();
    assert_eq!(codes(list.trust_new(wrong.der(), "anna")), ["EXPIRED", "WRONG_USAGE", "WRONG_KEY"]);
    assert_eq!(
        codes(list.add_issuer(wrong.der(), "anna")),
        ["NOT_AN_AUTHORITY", "WRONG_USAGE", "EXPIRED"]
    );
    assert!(list.list().unwrap().is_empty());
    twin.stop().await;
}

#[tokio::test]
async fn anonymous_users_need_the_development_setting() {
    let open =
        TestTwin::start_with(|config| config.security.allow_anonymous_unencrypted = true).await;
    let pki = open.folder.path().join("client");
    let client = Client::connect(&open.url, pki, IdentityToken::Anonymous, SecurityPolicy::None)
        .await
        .unwrap();
    assert!(!client.children(ObjectId::ObjectsFolder).await.is_empty());
    client.close().await;
    open.stop().await;

    let closed = TestTwin::start().await;
    let pki = closed.folder.path().join("client");
    let refused =
        Client::connect(&closed.url, pki, IdentityToken::Anonymous, SecurityPolicy::None).await;
    assert!(refused.is_err());
    closed.stop().await;
}
