//! From an address to a session: discovery, choice of the endpoint, trust, sign-in.

mod endpoint;
mod failure;

use std::{sync::Arc, time::Duration};

use futures::StreamExt as _;
use opcua_stack::{
    limits,
    opcua::{
        client::{Client, ClientBuilder, IdentityToken, Session, SessionPollResult},
        crypto::X509,
        types::{EndpointDescription, Error, StatusCode},
    },
};
use tokio::{sync::watch, task::AbortHandle};

use super::problem;
use crate::{
    ChosenEndpoint, EndpointOffer, Identity, SecurityPolicy, ShopFloorError, SourceConfig,
    SourceProblem, SourceProblemKind as Kind, service::Floor,
};

use endpoint::{choose, mode_of, offer, policy_of, reachable_url, text};
use failure::explain;

/// Longest wait for a server's list of endpoints.
const DISCOVERY_TIMEOUT: Duration = Duration::from_secs(5);
/// Longest wait for channel, session and sign-in together.
const SESSION_TIMEOUT: Duration = Duration::from_secs(15);
/// Longest wait for a single answer inside the stack.
const REQUEST_TIMEOUT: Duration = Duration::from_secs(8);
/// How long a server keeps a session that it does not hear from. Short: after a lost connection we
/// make a new session, and small devices have room for few.
const SESSION_LIFE: Duration = Duration::from_secs(30);
/// We watch for signs of life ourselves; the stack's own question is only a backstop.
const STACK_KEEP_ALIVE: Duration = Duration::from_secs(600);
/// Most endpoints of a server that are looked at.
const ENDPOINTS_MAX: usize = 200;

/// A session with its running event loop. Dropped, the connection is cut.
pub(super) struct Link {
    pub(super) session: Arc<Session>,
    pub(super) endpoint: ChosenEndpoint,
    state: watch::Receiver<LinkState>,
    event_loop: AbortHandle,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum LinkState {
    Connecting,
    Up,
    Down(StatusCode),
}

impl Link {
    /// Waits until the connection is lost, and says why.
    pub(super) async fn lost(&self) -> StatusCode {
        let mut state = self.state.clone();
        match state.wait_for(|state| matches!(state, LinkState::Down(_))).await.map(|state| *state)
        {
            Ok(LinkState::Down(status)) => status,
            _ => StatusCode::BadConnectionClosed,
        }
    }
}

impl Drop for Link {
    fn drop(&mut self) {
        self.event_loop.abort();
    }
}

/// Makes a session.
pub(super) async fn open(floor: &Arc<Floor>, source: &SourceConfig) -> Result<Link, SourceProblem> {
    own_certificate(floor).await?;
    let client = client(floor, Some(source))?;
    let offered = endpoints(&client, &source.endpoint_url).await?;
    let mut endpoint = choose(&offered, source.security, &source.identity)?.clone();
    let policy = policy_of(&endpoint).unwrap_or(SecurityPolicy::None);
    if policy != SecurityPolicy::None {
        check_trust(floor, &endpoint).await?;
    }
    // Servers behind address translation or with a wrong name of themselves say addresses that we
    // cannot reach.
    endpoint.endpoint_url =
        reachable_url(&source.endpoint_url, endpoint.endpoint_url.as_ref()).into();
    let chosen = ChosenEndpoint {
        endpoint_url: endpoint.endpoint_url.to_string(),
        security_policy: policy,
        message_security: mode_of(endpoint.security_mode),
        server_name: text(&endpoint.server.application_name.text),
        application_uri: text(&endpoint.server.application_uri),
    };
    let token = identity_token(source.identity.clone()).await?;
    let refused = |error: Error| explain(error.status(), &error.to_string(), policy);
    let (session, event_loop) = client
        .session_builder()
        .connect_to_endpoint_directly(endpoint)
        .map_err(refused)?
        .user_identity_token(token)
        .build(Arc::clone(client.certificate_store()))
        .map_err(refused)?;
    let (sender, mut state) = watch::channel(LinkState::Connecting);
    let task = tokio::spawn(async move {
        let events = event_loop.enter();
        tokio::pin!(events);
        loop {
            let state = match events.next().await {
                Some(Ok(SessionPollResult::Reconnected(_))) => LinkState::Up,
                Some(Ok(
                    SessionPollResult::ConnectionLost(status)
                    | SessionPollResult::ReconnectFailed(status),
                )) => LinkState::Down(status),
                Some(Ok(_)) => continue,
                Some(Err(status)) => LinkState::Down(status),
                None => LinkState::Down(StatusCode::BadConnectionClosed),
            };
            sender.send_replace(state);
            if matches!(state, LinkState::Down(_)) {
                return;
            }
        }
    });
    let link =
        Link { session, endpoint: chosen, state: state.clone(), event_loop: task.abort_handle() };
    let settled = tokio::time::timeout(
        SESSION_TIMEOUT,
        state.wait_for(|state| *state != LinkState::Connecting),
    )
    .await;
    match settled.map(|state| state.map(|state| *state)) {
        Ok(Ok(LinkState::Up)) => Ok(link),
        Ok(Ok(LinkState::Down(status))) => Err(explain(status, "", policy)),
        Ok(Ok(LinkState::Connecting) | Err(_)) => {
            Err(explain(StatusCode::BadConnectionClosed, "", policy))
        }
        Err(_) => Err(explain(StatusCode::BadTimeout, "", policy)),
    }
}

/// What a server offers.
pub(crate) async fn discover(
    floor: &Arc<Floor>,
    endpoint_url: &str,
) -> Result<Vec<EndpointOffer>, ShopFloorError> {
    let unreachable = |problem: SourceProblem| ShopFloorError::Unreachable(problem.message);
    let client = client(floor, None).map_err(unreachable)?;
    let offered = endpoints(&client, endpoint_url).await.map_err(unreachable)?;
    Ok(offered.iter().map(offer).collect())
}

async fn own_certificate(floor: &Arc<Floor>) -> Result<(), SourceProblem> {
    let floor = Arc::clone(floor);
    let own = tokio::task::spawn_blocking(move || floor.certificates.own().map(drop)).await;
    match own {
        Ok(Ok(())) => Ok(()),
        Ok(Err(error)) => Err(problem(Kind::Configuration, error.to_string())),
        Err(error) => Err(problem(
            Kind::Configuration,
            format!("The certificate could not be made: {error}."),
        )),
    }
}

fn client(floor: &Floor, source: Option<&SourceConfig>) -> Result<Client, SourceProblem> {
    let session_life = u32::try_from(SESSION_LIFE.as_millis()).expect("half a minute fits");
    let mut builder = limits::raise_client(ClientBuilder::new())
        .application_name(&floor.config.application_name)
        .application_uri(&floor.config.application_uri)
        .product_uri("urn:verbund:factory-connector")
        .pki_dir(floor.certificates.directory())
        .certificate_path("own/cert.der")
        .private_key_path("private/private.pem")
        .create_sample_keypair(false)
        // Trust is exactly the approved certificates; what stands inside them is the approving
        // person's concern.
        .trust_server_certs(false)
        .verify_server_certs(false)
        .session_retry_limit(0)
        .recreate_subscriptions(false)
        .keep_alive_interval(STACK_KEEP_ALIVE)
        .session_timeout(session_life)
        .request_timeout(REQUEST_TIMEOUT);
    if let Some(source) = source {
        builder =
            builder.session_name(format!("{} {}", floor.config.application_name, source.source_id));
    }
    builder.client().map_err(|faults| problem(Kind::Configuration, faults.join(", ")))
}

async fn endpoints(
    client: &Client,
    endpoint_url: &str,
) -> Result<Vec<EndpointDescription>, SourceProblem> {
    let asked =
        tokio::time::timeout(DISCOVERY_TIMEOUT, client.get_server_endpoints_from_url(endpoint_url))
            .await;
    match asked {
        Ok(Ok(mut endpoints)) => {
            endpoints.truncate(ENDPOINTS_MAX);
            Ok(endpoints)
        }
        Ok(Err(error)) => Err(problem(
            Kind::Unreachable,
            format!("No OPC UA server answers at {endpoint_url}: {error}."),
        )),
        Err(_) => {
            Err(problem(Kind::Unreachable, format!("Nothing answers in time at {endpoint_url}.")))
        }
    }
}

async fn check_trust(
    floor: &Arc<Floor>,
    endpoint: &EndpointDescription,
) -> Result<(), SourceProblem> {
    let certificate = X509::from_byte_string(&endpoint.server_certificate).map_err(|_| {
        problem(
            Kind::ServerCertificateInvalid,
            "The server's certificate is missing or cannot be read.",
        )
    })?;
    let (subject, thumbprint) =
        (certificate.subject_name(), certificate.thumbprint().as_hex_string());
    let floor = Arc::clone(floor);
    match tokio::task::spawn_blocking(move || floor.certificates.is_trusted(&certificate)).await {
        Ok(Ok(true)) => Ok(()),
        Ok(Ok(false)) => Err(problem(
            Kind::ServerCertificateUntrusted,
            format!(
                "The server's certificate is not trusted yet: {subject}, thumbprint {thumbprint}."
            ),
        )),
        Ok(Err(error)) => Err(problem(Kind::Configuration, error.to_string())),
        Err(error) => Err(problem(
            Kind::Configuration,
            format!("The certificate could not be checked: {error}."),
        )),
    }
}

async fn identity_token(identity: Identity) -> Result<IdentityToken, SourceProblem> {
    match identity {
        Identity::Anonymous => Ok(IdentityToken::Anonymous),
        Identity::UserName { user_name, password } => {
            Ok(IdentityToken::new_user_name(user_name, password.expose().to_owned()))
        }
        Identity::Certificate { certificate_path, private_key_path } => {
            let read = move || IdentityToken::new_x509_path(certificate_path, private_key_path);
            match tokio::task::spawn_blocking(read).await {
                Ok(Ok(token)) => Ok(token),
                Ok(Err(error)) => {
                    Err(problem(Kind::Configuration, format!("The user's certificate: {error}.")))
                }
                Err(error) => Err(problem(Kind::Configuration, error.to_string())),
            }
        }
    }
}
