//! A client that makes its requests itself, as no client of the library would make them.

use std::{path::PathBuf, sync::Arc, time::Duration};

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
            RequestHeader, SignatureData, StatusCode,
        },
    },
};

use crate::harness::{DEADLINE, TestTwin};

/// A client with its certificate and the endpoint that it uses.
pub struct RawClient {
    pub pki: PathBuf,
    pub endpoint: EndpointDescription,
    /// Lifetime of the tokens of its channels.
    pub token_lifetime: Duration,
}

/// A secure channel, closed without a word when dropped.
pub struct RawChannel {
    session: Arc<Session>,
    polling: tokio::task::JoinHandle<()>,
}

/// Token and nonce with which a client uses a session.
#[derive(Clone)]
pub struct SessionKey {
    pub token: NodeId,
    pub server_nonce: ByteString,
}

impl RawClient {
    /// Makes a client with vera's certificate, which a connection makes first.
    pub async fn new(twin: &TestTwin, policy: SecurityPolicy, mode: MessageSecurityMode) -> Self {
        twin.client("vera").await.close().await;
        Self::of(twin, twin.folder.path().join("client-vera"), policy, mode).await
    }

    /// Makes a client with the certificate and key of a folder.
    pub async fn of(
        twin: &TestTwin,
        pki: PathBuf,
        policy: SecurityPolicy,
        mode: MessageSecurityMode,
    ) -> Self {
        let offered = Self::builder(&pki)
            .client()
            .unwrap()
            .get_server_endpoints_from_url(twin.url.as_ref())
            .await
            .unwrap();
        let is_meant = |one: &EndpointDescription| {
            one.security_policy_uri.as_ref() == policy.to_uri() && one.security_mode == mode
        };
        let endpoint = offered.into_iter().find(is_meant).unwrap();
        Self { pki, endpoint, token_lifetime: Duration::from_secs(60) }
    }

    fn builder(pki: &std::path::Path) -> ClientBuilder {
        limits::raise_client(ClientBuilder::new())
            .application_name("test client")
            .application_uri("urn:verbund:test:client")
            .pki_dir(pki)
            .trust_server_certs(true)
            .session_retry_limit(0)
    }

    pub async fn open_channel(&self) -> RawChannel {
        let lifetime = u32::try_from(self.token_lifetime.as_millis()).unwrap();
        let mut client = Self::builder(&self.pki).channel_lifetime(lifetime).client().unwrap();
        let (session, _) = client
            .connect_to_endpoint_directly(self.endpoint.clone(), IdentityToken::Anonymous)
            .unwrap();
        let connector = self.endpoint.endpoint_url.as_ref().build().unwrap();
        let mut connection = session.channel().connect_no_retry(&connector).await.unwrap();
        let polling = tokio::spawn(async move {
            while !matches!(connection.poll().await, TransportPollResult::Closed(_)) {}
        });
        RawChannel { session, polling }
    }

    pub async fn create_session(&self, channel: &RawChannel) -> Result<SessionKey, StatusCode> {
        let certificate = CertificateStore::read_cert(&self.pki.join("own/cert.der")).unwrap();
        let create = CreateSessionRequest {
            request_header: channel.header(&NodeId::null()),
            client_description: ApplicationDescription::default(),
            endpoint_url: self.endpoint.endpoint_url.clone(),
            session_name: "raw".into(),
            client_nonce: crypto::random::byte_string(32),
            client_certificate: certificate.as_byte_string(),
            requested_session_timeout: 60_000.0,
            ..CreateSessionRequest::default()
        };
        match channel.exchange(create.into()).await {
            ResponseMessage::CreateSession(created) => Ok(SessionKey {
                token: created.authentication_token.clone(),
                server_nonce: created.server_nonce.clone(),
            }),
            other => Err(other.response_header().service_result),
        }
    }

    /// Activates a session with a token of its user, and takes the next nonce of the server.
    pub async fn activate(
        &self,
        channel: &RawChannel,
        key: &mut SessionKey,
        user_identity_token: ExtensionObject,
    ) -> StatusCode {
        let policy = SecurityPolicy::from_uri(self.endpoint.security_policy_uri.as_ref());
        let private = CertificateStore::read_pkey(&self.pki.join("private/private.pem")).unwrap();
        let client_signature: SignatureData = crypto::create_signature_data(
            &private,
            policy,
            &self.endpoint.server_certificate,
            &key.server_nonce,
        )
        .unwrap();
        let activate = ActivateSessionRequest {
            request_header: channel.header(&key.token),
            client_signature,
            user_identity_token,
            ..ActivateSessionRequest::default()
        };
        match channel.exchange(activate.into()).await {
            ResponseMessage::ActivateSession(activated) => {
                key.server_nonce = activated.server_nonce.clone();
                StatusCode::Good
            }
            other => other.response_header().service_result,
        }
    }
}

impl RawChannel {
    pub fn header(&self, token: &NodeId) -> RequestHeader {
        RequestHeader {
            timeout_hint: 10_000,
            ..RequestHeader::new(token, &DateTime::now(), self.session.channel().request_handle())
        }
    }

    pub async fn exchange(&self, request: RequestMessage) -> ResponseMessage {
        self.try_exchange(request).await.unwrap()
    }

    /// Sends a request, renewing the channel before if it is time; an error where the channel is closed.
    pub async fn try_exchange(
        &self,
        request: RequestMessage,
    ) -> Result<ResponseMessage, StatusCode> {
        self.exchange_within(request, DEADLINE).await
    }

    /// Sends a request as [`Self::try_exchange`] does, and gives its answer up after some time.
    pub async fn exchange_within(
        &self,
        request: RequestMessage,
        patience: Duration,
    ) -> Result<ResponseMessage, StatusCode> {
        self.session.channel().send(request, patience).await.map_err(|error| error.status())
    }
}

impl Drop for RawChannel {
    fn drop(&mut self) {
        self.polling.abort();
    }
}
