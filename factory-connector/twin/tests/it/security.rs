//! Who gets in.

use opcua_stack::opcua::{
    client::IdentityToken,
    crypto::SecurityPolicy,
    types::{ObjectId, StatusCode},
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
