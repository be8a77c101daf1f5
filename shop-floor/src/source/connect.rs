//! Establishment of a session: discovery, choice of the endpoint, trust and sign-in.

pub(super) mod endpoint_choice;
mod failure;

use std::{sync::Arc, time::Duration};

use futures::{Stream, StreamExt as _};
use opcua_stack::{
    limits,
    opcua::{
        client::{Client, ClientBuilder, IdentityToken, Session, SessionPollResult},
        crypto::{self, X509},
        types::{EndpointDescription, Error, StatusCode},
    },
};
use tokio::{sync::watch, task::AbortHandle};

use crate::{
    ChosenEndpoint, Identity, MessageSecurity, SecurityPolicy, SourceConfig, SourceProblem,
    SourceProblemKind as Kind,
    certificates::{PkiDirectory, TrustFinding, fingerprint},
    clock,
    context::SourceContext,
};

use endpoint_choice::{choose, exposes_password, mode_of, policy_of, reachable_url, text};
use failure::{discovery_problem, session_problem};

/// Longest wait for a server's list of endpoints.
const DISCOVERY_TIMEOUT: Duration = Duration::from_secs(5);
/// Longest wait for channel, session and sign-in together.
const SESSION_TIMEOUT: Duration = Duration::from_secs(15);
/// Longest wait for a single response inside the stack.
const REQUEST_TIMEOUT: Duration = Duration::from_secs(8);
/// Time after which a server drops a silent session. Short: a lost connection is replaced by a new
/// session, and small devices have room for few.
const SESSION_LIFETIME: Duration = Duration::from_secs(30);
/// Interval of the stack's own keep-alive. Long: this crate measures the silence of a server
/// itself, within the limit that its source allows.
const STACK_KEEP_ALIVE: Duration = Duration::from_secs(600);
/// Longest time for which a certificate is taken as it was found: it ends by itself, and lists of revoked ones are
/// files that others write.
const TRUST_CHECK_INTERVAL: Duration = Duration::from_secs(60);
/// Most endpoints of a server that are considered.
const ENDPOINTS_MAX: usize = 200;

/// Established session with its running event loop. Cuts the connection when dropped.
pub(super) struct OpenSession {
    pub(super) session: Arc<Session>,
    pub(super) endpoint: ChosenEndpoint,
    /// The server as it was trusted; none where the connection is not protected.
    trusted: Option<EndpointDescription>,
    state: watch::Receiver<ChannelState>,
    event_loop: AbortHandle,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ChannelState {
    Connecting,
    Up,
    Down(StatusCode),
}

impl OpenSession {
    /// Waits until the server's certificate is no longer trusted: an engineer took that back, its time is over, or
    /// its issuer revoked it. Looked at as soon as people change what is trusted, and now and then.
    pub(super) async fn trust_lost(&self, context: &SourceContext) -> SourceProblem {
        let Some(endpoint) = &self.trusted else { return std::future::pending().await };
        let mut changed = context.watch_trust();
        loop {
            if let Err(problem) = check_trust(context, endpoint).await {
                return problem;
            }
            // Past the end of the context nothing changes any more.
            let change = async {
                if changed.changed().await.is_err() {
                    std::future::pending().await
                }
            };
            tokio::time::timeout(TRUST_CHECK_INTERVAL, change).await.ok();
        }
    }

    /// Waits until the connection is lost, and returns the status of its end.
    pub(super) async fn lost(&self) -> StatusCode {
        let mut state = self.state.clone();
        match state
            .wait_for(|state| matches!(state, ChannelState::Down(_)))
            .await
            .map(|state| *state)
        {
            Ok(ChannelState::Down(status)) => status,
            _ => StatusCode::BadConnectionClosed,
        }
    }

    /// Closes the session on the server, where nothing was subscribed. It takes a place there else until its timeout.
    pub(super) async fn close(&self, timeout: Duration) {
        let _ = tokio::time::timeout(timeout, self.session.disconnect()).await;
    }
}

impl Drop for OpenSession {
    fn drop(&mut self) {
        self.event_loop.abort();
    }
}

/// Establishes a session: activated, signed in, with a running event loop.
pub(super) async fn open_session(
    context: &SourceContext,
    source: &SourceConfig,
) -> Result<OpenSession, SourceProblem> {
    ensure_own_certificate(context).await?;
    let offered = endpoints(&discovery_client(context)?, &source.endpoint_url).await?;
    let mut endpoint = choose(&offered, source.security, &source.identity)?.clone();
    let policy = policy_of(&endpoint).unwrap_or(SecurityPolicy::None);
    if exposes_password(&endpoint, &source.identity) {
        allow_exposure(source)?;
    }
    if policy != SecurityPolicy::None {
        check_trust(context, &endpoint).await?;
    }
    let trusted = (policy != SecurityPolicy::None).then(|| endpoint.clone());
    let is_signed = mode_of(endpoint.security_mode) != MessageSecurity::None;
    let client = client(context, source, trusted.is_some() && is_signed)?;
    // Servers behind address translation, or with a wrong host name, return addresses that cannot
    // be reached from here.
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
    let refused = |error: Error| session_problem(error.status(), &error.to_string(), policy);
    let (session, event_loop) = client
        .session_builder()
        .connect_to_endpoint_directly(endpoint)
        .map_err(refused)?
        .user_identity_token(token)
        .build(Arc::clone(client.certificate_store()))
        .map_err(refused)?;
    let (sender, mut state) = watch::channel(ChannelState::Connecting);
    let task = tokio::spawn(run_event_loop(event_loop.enter(), sender));
    // Made before the wait: dropped on a timeout, it ends the event loop.
    let session = OpenSession {
        session,
        endpoint: chosen,
        trusted,
        state: state.clone(),
        event_loop: task.abort_handle(),
    };
    let is_settled = |state: &ChannelState| *state != ChannelState::Connecting;
    let settled = tokio::time::timeout(SESSION_TIMEOUT, state.wait_for(is_settled)).await;
    match settled.map(|state| state.map(|state| *state)) {
        Ok(Ok(ChannelState::Up)) => Ok(session),
        Ok(Ok(ChannelState::Down(status))) => Err(session_problem(status, "", policy)),
        Ok(Ok(ChannelState::Connecting) | Err(_)) => {
            Err(session_problem(StatusCode::BadConnectionClosed, "", policy))
        }
        Err(_) => Err(session_problem(StatusCode::BadTimeout, "", policy)),
    }
}

/// Drives a session until its connection is lost, and publishes the state of the connection.
async fn run_event_loop(
    events: impl Stream<Item = Result<SessionPollResult, StatusCode>>,
    sender: watch::Sender<ChannelState>,
) {
    tokio::pin!(events);
    loop {
        let state = match events.next().await {
            Some(Ok(SessionPollResult::Reconnected(_))) => ChannelState::Up,
            Some(Ok(
                SessionPollResult::ConnectionLost(status)
                | SessionPollResult::ReconnectFailed(status),
            )) => ChannelState::Down(status),
            Some(Ok(_)) => continue,
            Some(Err(status)) => ChannelState::Down(status),
            None => ChannelState::Down(StatusCode::BadConnectionClosed),
        };
        sender.send_replace(state);
        if matches!(state, ChannelState::Down(_)) {
            return;
        }
    }
}

/// Returns the endpoints that a server offers.
pub(super) async fn offered(
    context: &SourceContext,
    endpoint_url: &str,
) -> Result<Vec<EndpointDescription>, SourceProblem> {
    ensure_own_certificate(context).await?;
    endpoints(&discovery_client(context)?, endpoint_url).await
}

/// Creates the client certificate if it is missing: the stack only reads it.
async fn ensure_own_certificate(context: &SourceContext) -> Result<(), SourceProblem> {
    match context.with_certificates(PkiDirectory::own).await {
        Ok(Ok(_)) => Ok(()),
        Ok(Err(error)) => Err(SourceProblem::new(Kind::Configuration, error.to_string())),
        Err(error) => Err(SourceProblem::new(
            Kind::Configuration,
            format!("The certificate could not be made: {error}."),
        )),
    }
}

/// Refuses to show a password to the network, unless the source says so by name; then that is said aloud.
fn allow_exposure(source: &SourceConfig) -> Result<(), SourceProblem> {
    if !source.sends_password_unprotected {
        return Err(SourceProblem::new(
            Kind::Configuration,
            "The connection is not protected, so that everybody on the network could read the password. It was not \
             sent. Choose a protected endpoint, or allow it for this source by \"sendsPasswordUnprotected\".",
        ));
    }
    tracing::warn!(source.id = %source.source_id,
        "The password of a source is sent over an unprotected connection, because \"sendsPasswordUnprotected\" is set.");
    Ok(())
}

/// A client that asks a server for its endpoints. Nothing is known of the server yet, so its answer has the limits that
/// the stack has for a client, which hold hundreds of endpoints, and not those of a trusted server.
fn discovery_client(context: &SourceContext) -> Result<Client, SourceProblem> {
    built(common(ClientBuilder::new(), context))
}

/// A client for the session. A server whose certificate is trusted has signed each chunk before it is kept; any other one
/// may be anybody, before the sign-in and after.
fn client(
    context: &SourceContext,
    source: &SourceConfig,
    is_trusted: bool,
) -> Result<Client, SourceProblem> {
    let name = format!("{} {}", context.config.application_name, source.source_id);
    let raise = if is_trusted { limits::raise_client } else { limits::raise_client_of_stranger };
    built(common(raise(ClientBuilder::new()), context).session_name(name))
}

fn common(builder: ClientBuilder, context: &SourceContext) -> ClientBuilder {
    let session_timeout = u32::try_from(SESSION_LIFETIME.as_millis()).expect("half a minute fits");
    builder
        .application_name(&context.config.application_name)
        .application_uri(&context.config.application_uri)
        .product_uri("urn:verbund:factory-connector")
        .pki_dir(context.certificates().directory())
        .certificate_path("own/cert.der")
        .private_key_path("private/private.pem")
        .create_sample_keypair(false)
        // Trust is checked before, against the approved certificates only. Their contents are
        // checked by the person who approves them.
        .trust_server_certs(false)
        .verify_server_certs(false)
        .session_retry_limit(0)
        .recreate_subscriptions(false)
        .keep_alive_interval(STACK_KEEP_ALIVE)
        .session_timeout(session_timeout)
        .request_timeout(REQUEST_TIMEOUT)
        .incoming_budget(Arc::clone(&context.incoming))
}

fn built(builder: ClientBuilder) -> Result<Client, SourceProblem> {
    builder.client().map_err(|faults| SourceProblem::new(Kind::Configuration, faults.join(", ")))
}

async fn endpoints(
    client: &Client,
    endpoint_url: &str,
) -> Result<Vec<EndpointDescription>, SourceProblem> {
    match listed(client, endpoint_url).await {
        // Some servers, as Ignition, answer without protection at this path alone.
        Err(problem) if problem.kind == Kind::EndpointsHidden => {
            let url = format!("{}/discovery", endpoint_url.trim_end_matches('/'));
            listed(client, &url).await.map_err(|_| problem)
        }
        answer => answer,
    }
}

async fn listed(
    client: &Client,
    endpoint_url: &str,
) -> Result<Vec<EndpointDescription>, SourceProblem> {
    let offered =
        tokio::time::timeout(DISCOVERY_TIMEOUT, client.get_server_endpoints_from_url(endpoint_url))
            .await;
    match offered {
        Ok(Ok(mut endpoints)) => {
            endpoints.truncate(ENDPOINTS_MAX);
            Ok(endpoints)
        }
        Ok(Err(error)) => Err(discovery_problem(endpoint_url, &error)),
        Err(_) => Err(SourceProblem::new(
            Kind::Unreachable,
            format!("Nothing answers in time at {endpoint_url}."),
        )),
    }
}

async fn check_trust(
    context: &SourceContext,
    endpoint: &EndpointDescription,
) -> Result<(), SourceProblem> {
    let certificate = X509::from_byte_string(&endpoint.server_certificate).map_err(|_| {
        SourceProblem::new(
            Kind::ServerCertificateInvalid,
            "The server's certificate is missing or cannot be read.",
        )
    })?;
    let (subject, fingerprint) = (certificate.subject_name(), fingerprint(&certificate));
    // Said before a person is asked to approve what cannot be used; the stack would refuse it later.
    let policy = crypto::SecurityPolicy::from_uri(endpoint.security_policy_uri.as_ref());
    if let Ok(bits) = certificate.key_length()
        && !policy.is_valid_keylength(bits)
    {
        return Err(SourceProblem::new(
            Kind::ServerKeyTooShort,
            format!(
                "The key of the server's certificate has {bits} bits, which {policy} does not allow: {subject}."
            ),
        ));
    }
    let invalid = |why: &str| {
        Err(SourceProblem::new(
            Kind::ServerCertificateInvalid,
            format!(
                "The server's certificate {why}: {subject}, SHA-256 fingerprint {fingerprint}."
            ),
        ))
    };
    match context.with_certificates(move |pki| pki.examine(&certificate, clock::now())).await {
        Ok(Ok(TrustFinding::Trusted)) => Ok(()),
        Ok(Ok(TrustFinding::NotApproved)) => Err(SourceProblem::new(
            Kind::ServerCertificateUntrusted,
            format!(
                "The server's certificate is not trusted yet: {subject}, SHA-256 fingerprint {fingerprint}."
            ),
        )),
        Ok(Ok(TrustFinding::OutOfTime)) => invalid("was approved but is not valid at this time"),
        Ok(Ok(TrustFinding::Revoked)) => invalid("was approved but its issuer revoked it"),
        Ok(Err(error)) => Err(SourceProblem::new(Kind::Configuration, error.to_string())),
        Err(error) => Err(SourceProblem::new(
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
                Ok(Err(error)) => Err(SourceProblem::new(
                    Kind::Configuration,
                    format!("The user's certificate: {error}."),
                )),
                Err(error) => Err(SourceProblem::new(Kind::Configuration, error.to_string())),
            }
        }
    }
}

#[cfg(test)]
mod tests;
