//! Passwords on the wire, sent as no client of the library would send them.

use std::time::Duration;

use opcua_stack::opcua::{
    crypto::{self, SecurityPolicy},
    types::{
        ByteString, ExtensionObject, MessageSecurityMode, StatusCode, UAString,
        UserNameIdentityToken,
    },
};

use crate::{harness::TestTwin, raw_client::RawClient};

/// Form of a password in a token.
#[derive(Debug, Clone, Copy)]
pub enum Secret {
    /// Text without encryption.
    Plain,
    /// Encrypted as another policy has it.
    As(SecurityPolicy),
    /// Under the name of an algorithm.
    Named(&'static str),
}

/// Signs vera in; the status of the answer.
async fn sign_in(client: &RawClient, secret: Secret) -> StatusCode {
    let channel = client.open_channel().await;
    match client.create_session(&channel).await {
        Ok(mut key) => {
            let token = token(client, secret, key.server_nonce.as_ref());
            client.activate(&channel, &mut key, token).await
        }
        Err(status) => status,
    }
}

/// Makes vera's token.
pub fn token(client: &RawClient, secret: Secret, nonce: &[u8]) -> ExtensionObject {
    let password = b"vera-secret";
    let mut policy = client.endpoint.user_identity_tokens.iter().flatten().next().unwrap().clone();
    let server = crypto::X509::from_byte_string(&client.endpoint.server_certificate).ok();
    let of = match secret {
        Secret::As(of) => of,
        Secret::Plain | Secret::Named(_) => SecurityPolicy::Basic256Sha256,
    };
    policy.security_policy_uri = of.to_uri().into();
    let encrypted = crypto::legacy_encrypt_secret(
        of,
        MessageSecurityMode::SignAndEncrypt,
        &policy,
        nonce,
        &server,
        password,
    )
    .unwrap();
    let (password, encryption_algorithm) = match secret {
        Secret::Plain => (ByteString::from(password), UAString::null()),
        Secret::As(_) => (encrypted.secret, encrypted.encryption_algorithm),
        Secret::Named(name) => (encrypted.secret, name.into()),
    };
    ExtensionObject::from_message(UserNameIdentityToken {
        policy_id: policy.policy_id,
        user_name: "vera".into(),
        password,
        encryption_algorithm,
    })
}
#[tokio::test]
async fn a_password_is_taken_only_as_the_endpoint_says() {
    const RSA_15: &str = "http://www.w3.org/2001/04/xmlenc#rsa-1_5";
    const OAEP_SHA256: &str = "http://opcfoundation.org/UA/security/rsa-oaep-sha2-256";
    let twin = TestTwin::start_with(|config| {
        config.security.trust_unknown_certificates = true;
        config.security.allow_signed_unencrypted = true;
    })
    .await;
    let (signed, encrypted) = (MessageSecurityMode::Sign, MessageSecurityMode::SignAndEncrypt);
    let (good, refused) = (StatusCode::Good, StatusCode::BadIdentityTokenRejected);
    for (mode, secret, expected) in [
        (signed, Secret::As(SecurityPolicy::Basic256Sha256), good),
        (signed, Secret::Plain, refused),
        (signed, Secret::As(SecurityPolicy::Aes256Sha256RsaPss), refused),
        (signed, Secret::Named(RSA_15), refused),
        (signed, Secret::Named(OAEP_SHA256), refused),
        (encrypted, Secret::As(SecurityPolicy::Basic256Sha256), good),
        // The channel encrypts it.
        (encrypted, Secret::Plain, good),
        (encrypted, Secret::As(SecurityPolicy::Aes256Sha256RsaPss), refused),
        (encrypted, Secret::Named(RSA_15), refused),
    ] {
        let client = RawClient::new(&twin, SecurityPolicy::Basic256Sha256, mode).await;
        let answer = tokio::time::timeout(Duration::from_secs(30), sign_in(&client, secret)).await;
        assert_eq!(answer.expect("an answer in time"), expected, "{mode:?} {secret:?}");
    }
    twin.stop().await;
}
