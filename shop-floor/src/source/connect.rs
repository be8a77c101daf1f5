//! From an address to a session: discovery, choice of the endpoint, trust, sign-in.

use std::{sync::Arc, time::Duration};

use futures::StreamExt as _;
use opcua_stack::{
    limits,
    opcua::{
        client::{Client, ClientBuilder, IdentityToken, Session, SessionPollResult},
        crypto::{self, X509},
        types::{EndpointDescription, Error, MessageSecurityMode, StatusCode, UserTokenType},
    },
};
use tokio::{sync::watch, task::AbortHandle};

use super::problem;
use crate::{
    ChosenEndpoint, EndpointOffer, Identity, MessageSecurity, SecurityChoice, SecurityPolicy, ShopFloorError,
    SourceConfig, SourceProblem, SourceProblemKind as Kind, service::Floor,
};

/// Longest wait for a server's list of endpoints.
const DISCOVERY_TIMEOUT: Duration = Duration::from_secs(5);
/// Longest wait for channel, session and sign-in together.
const SESSION_TIMEOUT: Duration = Duration::from_secs(15);
/// Longest wait for a single answer inside the stack.
const REQUEST_TIMEOUT: Duration = Duration::from_secs(8);
/// How long a server keeps a session that it does not hear from. Short: after a lost connection we make a new session,
/// and small devices have room for few.
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
        match state.wait_for(|state| matches!(state, LinkState::Down(_))).await.map(|state| *state) {
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
    // Servers behind address translation or with a wrong name of themselves say addresses that we cannot reach.
    endpoint.endpoint_url = reachable_url(&source.endpoint_url, endpoint.endpoint_url.as_ref()).into();
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
                Some(Ok(SessionPollResult::ConnectionLost(status) | SessionPollResult::ReconnectFailed(status))) => {
                    LinkState::Down(status)
                }
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
    let link = Link { session, endpoint: chosen, state: state.clone(), event_loop: task.abort_handle() };
    let settled = tokio::time::timeout(SESSION_TIMEOUT, state.wait_for(|state| *state != LinkState::Connecting)).await;
    match settled.map(|state| state.map(|state| *state)) {
        Ok(Ok(LinkState::Up)) => Ok(link),
        Ok(Ok(LinkState::Down(status))) => Err(explain(status, "", policy)),
        Ok(Ok(LinkState::Connecting) | Err(_)) => Err(explain(StatusCode::BadConnectionClosed, "", policy)),
        Err(_) => Err(explain(StatusCode::BadTimeout, "", policy)),
    }
}

/// What a server offers.
pub(crate) async fn discover(floor: &Arc<Floor>, endpoint_url: &str) -> Result<Vec<EndpointOffer>, ShopFloorError> {
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
        Err(error) => Err(problem(Kind::Configuration, format!("The certificate could not be made: {error}."))),
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
        // Trust is exactly the approved certificates; what stands inside them is the approving person's concern.
        .trust_server_certs(false)
        .verify_server_certs(false)
        .session_retry_limit(0)
        .recreate_subscriptions(false)
        .keep_alive_interval(STACK_KEEP_ALIVE)
        .session_timeout(session_life)
        .request_timeout(REQUEST_TIMEOUT);
    if let Some(source) = source {
        builder = builder.session_name(format!("{} {}", floor.config.application_name, source.source_id));
    }
    builder.client().map_err(|faults| problem(Kind::Configuration, faults.join(", ")))
}

async fn endpoints(client: &Client, endpoint_url: &str) -> Result<Vec<EndpointDescription>, SourceProblem> {
    let asked = tokio::time::timeout(DISCOVERY_TIMEOUT, client.get_server_endpoints_from_url(endpoint_url)).await;
    match asked {
        Ok(Ok(mut endpoints)) => {
            endpoints.truncate(ENDPOINTS_MAX);
            Ok(endpoints)
        }
        Ok(Err(error)) => {
            Err(problem(Kind::Unreachable, format!("No OPC UA server answers at {endpoint_url}: {error}.")))
        }
        Err(_) => Err(problem(Kind::Unreachable, format!("Nothing answers in time at {endpoint_url}."))),
    }
}

/// The endpoint that fits the choice of security and the identity.
fn choose<'a>(
    offered: &'a [EndpointDescription],
    choice: SecurityChoice,
    identity: &Identity,
) -> Result<&'a EndpointDescription, SourceProblem> {
    let unsuitable = |message: String| Err(problem(Kind::NoSuitableEndpoint, message));
    let fits = |endpoint: &&EndpointDescription| {
        let Some(policy) = policy_of(endpoint) else { return false };
        let mode = mode_of(endpoint.security_mode);
        match choice {
            SecurityChoice::Strongest => policy != SecurityPolicy::None && mode != MessageSecurity::None,
            SecurityChoice::None => policy == SecurityPolicy::None,
            SecurityChoice::Exactly { policy: wanted_policy, mode: wanted_mode } => {
                (policy, mode) == (wanted_policy, wanted_mode)
            }
        }
    };
    let secure_enough: Vec<_> = offered.iter().filter(fits).collect();
    if secure_enough.is_empty() {
        let names: Vec<_> = offered.iter().map(offer_name).collect();
        let hint = match choice {
            SecurityChoice::Strongest => "only unprotected or outdated endpoints; choose \"none\" to accept that",
            SecurityChoice::None => "no unprotected endpoint",
            SecurityChoice::Exactly { .. } => "no endpoint with the wanted policy and mode",
        };
        return unsuitable(format!("The server offers {hint}. It offers: {}.", names.join(", ")));
    }
    let wanted = match identity {
        Identity::Anonymous => UserTokenType::Anonymous,
        Identity::UserName { .. } => UserTokenType::UserName,
        Identity::Certificate { .. } => UserTokenType::Certificate,
    };
    let strongest = secure_enough
        .into_iter()
        .filter(|endpoint| allows(endpoint, wanted))
        .max_by_key(|endpoint| (mode_of(endpoint.security_mode), policy_of(endpoint), endpoint.security_level));
    match strongest {
        Some(endpoint) => Ok(endpoint),
        None => unsuitable(format!("The server does not accept sign-in by {wanted:?} there.")),
    }
}

fn allows(endpoint: &EndpointDescription, wanted: UserTokenType) -> bool {
    endpoint.user_identity_tokens.iter().flatten().any(|policy| policy.token_type == wanted)
}

fn policy_of(endpoint: &EndpointDescription) -> Option<SecurityPolicy> {
    match crypto::SecurityPolicy::from_uri(endpoint.security_policy_uri.as_ref()) {
        crypto::SecurityPolicy::None => Some(SecurityPolicy::None),
        crypto::SecurityPolicy::Aes128Sha256RsaOaep => Some(SecurityPolicy::Aes128Sha256RsaOaep),
        crypto::SecurityPolicy::Basic256Sha256 => Some(SecurityPolicy::Basic256Sha256),
        crypto::SecurityPolicy::Aes256Sha256RsaPss => Some(SecurityPolicy::Aes256Sha256RsaPss),
        _ => None,
    }
}

const fn mode_of(mode: MessageSecurityMode) -> MessageSecurity {
    match mode {
        MessageSecurityMode::Sign => MessageSecurity::Sign,
        MessageSecurityMode::SignAndEncrypt => MessageSecurity::SignAndEncrypt,
        _ => MessageSecurity::None,
    }
}

fn text(text: &opcua_stack::opcua::types::UAString) -> String {
    text.value().clone().unwrap_or_default()
}

fn offer_name(endpoint: &EndpointDescription) -> String {
    let uri = endpoint.security_policy_uri.as_ref();
    let policy = uri.rsplit_once('#').map_or(uri, |(_, name)| name);
    format!("{policy} {:?}", mode_of(endpoint.security_mode))
}

fn offer(endpoint: &EndpointDescription) -> EndpointOffer {
    let uri = endpoint.security_policy_uri.as_ref();
    let certificate = X509::from_byte_string(&endpoint.server_certificate).ok();
    EndpointOffer {
        endpoint_url: text(&endpoint.endpoint_url),
        security_policy: uri.rsplit_once('#').map_or(uri, |(_, name)| name).to_owned(),
        message_security: mode_of(endpoint.security_mode),
        is_supported: policy_of(endpoint).is_some(),
        allows_anonymous: allows(endpoint, UserTokenType::Anonymous),
        allows_user_name: allows(endpoint, UserTokenType::UserName),
        allows_certificate: allows(endpoint, UserTokenType::Certificate),
        server_name: text(&endpoint.server.application_name.text),
        application_uri: text(&endpoint.server.application_uri),
        certificate_thumbprint: certificate.map(|certificate| certificate.thumbprint().as_hex_string()),
    }
}

async fn check_trust(floor: &Arc<Floor>, endpoint: &EndpointDescription) -> Result<(), SourceProblem> {
    let certificate = X509::from_byte_string(&endpoint.server_certificate).map_err(|_| {
        problem(Kind::ServerCertificateInvalid, "The server's certificate is missing or cannot be read.")
    })?;
    let (subject, thumbprint) = (certificate.subject_name(), certificate.thumbprint().as_hex_string());
    let floor = Arc::clone(floor);
    match tokio::task::spawn_blocking(move || floor.certificates.is_trusted(&certificate)).await {
        Ok(Ok(true)) => Ok(()),
        Ok(Ok(false)) => Err(problem(
            Kind::ServerCertificateUntrusted,
            format!("The server's certificate is not trusted yet: {subject}, thumbprint {thumbprint}."),
        )),
        Ok(Err(error)) => Err(problem(Kind::Configuration, error.to_string())),
        Err(error) => Err(problem(Kind::Configuration, format!("The certificate could not be checked: {error}."))),
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
                Ok(Err(error)) => Err(problem(Kind::Configuration, format!("The user's certificate: {error}."))),
                Err(error) => Err(problem(Kind::Configuration, error.to_string())),
            }
        }
    }
}

/// The path that the server says, at the host and port that we were given.
fn reachable_url(given: &str, said: &str) -> String {
    let split = |url: &str| {
        let rest = url.strip_prefix("opc.tcp://").unwrap_or(url);
        let at = rest.find('/').unwrap_or(rest.len());
        (rest[..at].to_owned(), rest[at..].to_owned())
    };
    format!("opc.tcp://{}{}", split(given).0, split(said).1)
}

/// Why a session could not be made.
fn explain(status: StatusCode, detail: &str, policy: SecurityPolicy) -> SourceProblem {
    let secure = policy != SecurityPolicy::None;
    let detail = if detail.is_empty() { String::new() } else { format!(" ({detail})") };
    let (kind, message) = match status {
        StatusCode::BadUserAccessDenied
        | StatusCode::BadIdentityTokenRejected
        | StatusCode::BadIdentityTokenInvalid
        | StatusCode::BadUserSignatureInvalid => (Kind::CredentialsRejected, "The server does not accept the sign-in"),
        StatusCode::BadTooManySessions
        | StatusCode::BadTcpNotEnoughResources
        | StatusCode::BadMaxConnectionsReached => (Kind::ServerFull, "The server has no room for another session"),
        StatusCode::BadCertificateTimeInvalid
        | StatusCode::BadCertificateIssuerTimeInvalid
        | StatusCode::BadCertificateInvalid
        | StatusCode::BadCertificateUriInvalid
        | StatusCode::BadCertificateHostNameInvalid
        | StatusCode::BadCertificateUseNotAllowed
        | StatusCode::BadCertificateUntrusted
        | StatusCode::BadCertificateChainIncomplete
        | StatusCode::BadSecurityChecksFailed
        | StatusCode::BadCertificateRevoked => {
            (Kind::ClientCertificateRejected, "The server does not accept this connector's certificate")
        }
        // Many servers just close the connection when they do not trust a certificate.
        StatusCode::BadConnectionClosed | StatusCode::BadSecureChannelClosed if secure => (
            Kind::ClientCertificateRejected,
            "The server closed the connection while it was made secure; most often it does not trust this connector's \
             certificate",
        ),
        StatusCode::BadConnectionClosed
        | StatusCode::BadConnectionRejected
        | StatusCode::BadCommunicationError
        | StatusCode::BadTimeout
        | StatusCode::BadRequestTimeout
        | StatusCode::BadTcpEndpointUrlInvalid
        | StatusCode::BadServerHalted
        | StatusCode::BadShutdown => (Kind::Unreachable, "The server does not answer properly"),
        _ => (Kind::Refused, "The server refuses a session"),
    };
    problem(kind, format!("{message}: {status}{detail}."))
}

#[cfg(test)]
mod tests {
    use opcua_stack::opcua::types::UserTokenPolicy;

    use super::*;

    fn endpoint(policy: &str, mode: MessageSecurityMode, tokens: &[UserTokenType]) -> EndpointDescription {
        EndpointDescription {
            security_policy_uri: format!("http://opcfoundation.org/UA/SecurityPolicy#{policy}").into(),
            security_mode: mode,
            user_identity_tokens: Some(
                tokens
                    .iter()
                    .map(|token_type| UserTokenPolicy { token_type: *token_type, ..UserTokenPolicy::default() })
                    .collect(),
            ),
            ..EndpointDescription::default()
        }
    }

    #[test]
    fn the_strongest_suitable_endpoint_is_chosen_and_never_an_unprotected_one_by_itself() {
        use MessageSecurityMode::{None, Sign, SignAndEncrypt};
        let both = [UserTokenType::Anonymous, UserTokenType::UserName];
        let offered = [
            endpoint("None", None, &both),
            endpoint("Basic256", SignAndEncrypt, &both),
            endpoint("Basic256Sha256", Sign, &both),
            endpoint("Basic256Sha256", SignAndEncrypt, &both),
            endpoint("Aes256_Sha256_RsaPss", SignAndEncrypt, &[UserTokenType::Certificate]),
        ];
        let user = Identity::UserName { user_name: "a".into(), password: "b".into() };
        let check = |offered: &[EndpointDescription], choice, identity: &Identity, expected: Option<&str>| {
            let chosen = choose(offered, choice, identity).ok().map(offer_name);
            assert_eq!(chosen.as_deref(), expected, "{choice:?}");
        };
        let exactly = |mode| SecurityChoice::Exactly { policy: SecurityPolicy::Basic256Sha256, mode };
        check(&offered, SecurityChoice::Strongest, &user, Some("Basic256Sha256 SignAndEncrypt"));
        check(&offered, SecurityChoice::None, &Identity::Anonymous, Some("None None"));
        check(&offered, exactly(MessageSecurity::Sign), &user, Some("Basic256Sha256 Sign"));
        check(&offered[..2], SecurityChoice::Strongest, &user, Option::None);
        check(&offered[4..], SecurityChoice::Strongest, &user, Option::None);
    }

    #[test]
    fn a_server_is_reached_where_we_were_told() {
        for (given, said, expected) in [
            ("opc.tcp://10.0.0.7:4840", "opc.tcp://plc:4841/UA/Server", "opc.tcp://10.0.0.7:4840/UA/Server"),
            ("opc.tcp://10.0.0.7:4840/x", "opc.tcp://plc", "opc.tcp://10.0.0.7:4840"),
        ] {
            assert_eq!(reachable_url(given, said), expected);
        }
    }
}
