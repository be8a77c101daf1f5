//! Passwords on the wire, sent as no client of the library would send them.

use std::{path::PathBuf, time::Duration};

use opcua_stack::{
    limits,
    opcua::{
        client::{
            ClientBuilder, IdentityToken, Session,
            transport::{ConnectorBuilder, TransportPollResult},
        },
        core::{RequestMessage, ResponseMessage},
        crypto::{self, CertificateStore, SecurityPolicy},
        types::{
            ActivateSessionRequest, ApplicationDescription, ByteString, CreateSessionRequest,
            DateTime, EndpointDescription, ExtensionObject, MessageSecurityMode, NodeId,
            RequestHeader, SignatureData, StatusCode, UAString, UserNameIdentityToken,
        },
    },
};

use crate::harness::{DEADLINE, TestTwin};

/// Form of a password in a token.
#[derive(Debug, Clone, Copy)]
enum Secret {
    /// Text without encryption.
    Plain,
    /// Encrypted as another policy has it.
    As(SecurityPolicy),
    /// Under the name of an algorithm.
    Named(&'static str),
}

/// A client that makes its requests itself.
struct Client {
    pki: PathBuf,
    endpoint: EndpointDescription,
}

impl Client {
    async fn new(twin: &TestTwin, policy: SecurityPolicy, mode: MessageSecurityMode) -> Self {
        // The connection makes the client's certificate.
        twin.client("vera").await.close().await;
        let pki = twin.folder.path().join("client-vera");
        let offered = Self::builder(&pki)
            .client()
            .unwrap()
            .get_server_endpoints_from_url(twin.url.as_ref())
            .await
            .unwrap();
        let is_meant = |one: &EndpointDescription| {
            one.security_policy_uri.as_ref() == policy.to_uri() && one.security_mode == mode
        };
        Self { pki, endpoint: offered.into_iter().find(is_meant).unwrap() }
    }

    fn builder(pki: &std::path::Path) -> ClientBuilder {
        limits::raise_client(ClientBuilder::new())
            .application_name("test client")
            .application_uri("urn:verbund:test:client")
            .pki_dir(pki)
            .trust_server_certs(true)
            .session_retry_limit(0)
    }

    /// Signs vera in; the status of the answer.
    async fn sign_in(&self, secret: Secret) -> StatusCode {
        let mut client = Self::builder(&self.pki).client().unwrap();
        let (session, _) = client
            .connect_to_endpoint_directly(self.endpoint.clone(), IdentityToken::Anonymous)
            .unwrap();
        let policy = SecurityPolicy::from_uri(self.endpoint.security_policy_uri.as_ref());
        let certificate = CertificateStore::read_cert(&self.pki.join("own/cert.der")).unwrap();
        let key = CertificateStore::read_pkey(&self.pki.join("private/private.pem")).unwrap();
        let header = |session: &Session, token: &NodeId| RequestHeader {
            timeout_hint: 10_000,
            ..RequestHeader::new(token, &DateTime::now(), session.channel().request_handle())
        };
        let create = CreateSessionRequest {
            request_header: header(&session, &NodeId::null()),
            client_description: ApplicationDescription::default(),
            endpoint_url: self.endpoint.endpoint_url.clone(),
            session_name: "raw".into(),
            client_nonce: crypto::random::byte_string(32),
            client_certificate: certificate.as_byte_string(),
            requested_session_timeout: 60_000.0,
            ..CreateSessionRequest::default()
        };
        let connector = self.endpoint.endpoint_url.as_ref().build().unwrap();
        let mut connection = session.channel().connect_no_retry(&connector).await.unwrap();
        let mut exchange = async |request: RequestMessage| {
            let answer = session.channel().send(request, DEADLINE);
            tokio::pin!(answer);
            loop {
                tokio::select! {
                    answer = &mut answer => break answer.unwrap(),
                    polled = connection.poll() => {
                        assert!(!matches!(polled, TransportPollResult::Closed(_)), "it was closed");
                    }
                }
            }
        };
        let created = match exchange(create.into()).await {
            ResponseMessage::CreateSession(created) => created,
            other => return other.response_header().service_result,
        };
        let user_identity_token = self.token(secret, created.server_nonce.as_ref());
        let client_signature: SignatureData = crypto::create_signature_data(
            &key,
            policy,
            &self.endpoint.server_certificate,
            &created.server_nonce,
        )
        .unwrap();
        let activate = ActivateSessionRequest {
            request_header: header(&session, &created.authentication_token),
            client_signature,
            user_identity_token,
            ..ActivateSessionRequest::default()
        };
        exchange(activate.into()).await.response_header().service_result
    }

    fn token(&self, secret: Secret, nonce: &[u8]) -> ExtensionObject {
        let password = b"vera-secret";
        let mut policy =
            self.endpoint.user_identity_tokens.iter().flatten().next().unwrap().clone();
        let server = crypto::X509::from_byte_string(&self.endpoint.server_certificate).ok();
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
}

#[tokio::test]
async fn a_password_is_taken_only_as_the_endpoint_says() {
    const RSA_15: &str = "http://www.w3.org/2001/04/xmlenc#rsa-1_5";
    const OAEP_SHA256: &str = "http://opcfoundation.org/UA/security/rsa-oaep-sha2-256";
    let twin = TestTwin::start().await;
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
        let client = Client::new(&twin, SecurityPolicy::Basic256Sha256, mode).await;
        let answer = tokio::time::timeout(Duration::from_secs(30), client.sign_in(secret)).await;
        assert_eq!(answer.expect("an answer in time"), expected, "{mode:?} {secret:?}");
    }
    twin.stop().await;
}
