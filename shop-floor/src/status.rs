//! Status of a source, with the evidence.

use asi_model::values::{DateTime, NodeId, StatusCode};
use serde::Serialize;
use utoipa::ToSchema;

use crate::{InputKey, MessageSecurity, SecurityPolicy, ServerProfile, SourceId};

/// Status of a source, with the evidence.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct SourceStatus {
    pub source_id: SourceId,
    pub state: SourceState,
    pub since: DateTime,
    /// Problem while there is one, with the person who must act.
    pub problem: Option<SourceProblem>,
    /// Number of inputs that are monitored on it.
    pub inputs: usize,
    /// Number of inputs that the server monitors and has sent a first value for.
    pub live: usize,
    /// Number of inputs with a known browse path. They are found again when the server changes its
    /// node ids.
    pub findable: usize,
    /// The inputs that are not live, each with the reason; the first 1000.
    pub not_live: Vec<InputProblem>,
    /// Time of the last received change.
    pub last_change_at: Option<DateTime>,
    /// Time of the server's last message of any kind.
    pub last_sign_of_life_at: Option<DateTime>,
    /// Changes received since the connector started.
    pub changes: u64,
    /// Sessions established since the connector started.
    pub sessions: u64,
    /// Milliseconds by which the server's clock is ahead of the connector's, measured when the
    /// session was established.
    pub clock_ahead_ms: Option<i64>,
    /// Product behind the server, as it says.
    pub product: Option<ServerProduct>,
    /// Family of the server, where it is one that is known.
    pub family: Option<String>,
    pub endpoint: Option<ChosenEndpoint>,
    /// The server's limits as it declares them.
    pub limits: Option<ServerLimits>,
    /// The intervals that the server granted the subscriptions of the session.
    pub granted: Option<GrantedIntervals>,
    /// Inputs of which single changes may not arrive, each with the reason; the first 1000.
    pub coarse: Vec<CoarseInput>,
    /// Inputs whose values since the connection before were read from the server's history; the first 1000.
    pub filled: Vec<FilledInput>,
}

/// Input of which a gap was filled from the server's history (OPC 10000-11), when the connection came back.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct FilledInput {
    pub input: InputKey,
    pub node_id: NodeId,
    /// Number of values that were read.
    pub values: u64,
    /// Time of the last value before the gap.
    pub since: DateTime,
    /// False where more values were missed than are read at once.
    pub is_complete: bool,
}

/// Intervals that a server granted (OPC 10000-4 §5.13.2.2, §5.14.2.2), in milliseconds. What it grants rules,
/// whatever was requested.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct GrantedIntervals {
    /// Time between two messages with changes; a change arrives this much later at most.
    pub publishing_ms: u64,
    /// Time between two signs of life while nothing changes.
    pub keep_alive_ms: u64,
    /// Silence after which the connection is given up.
    pub silence_ms_max: u64,
    /// Time between two samples of a variable, of the one that is looked at most rarely; absent without inputs.
    pub sampling_ms: Option<f64>,
    /// Number of changes that the server keeps between two messages, of the input with the shortest queue; absent
    /// without inputs.
    pub queue_size: Option<u32>,
}

/// Input of which single changes may not arrive: the newest value does.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct CoarseInput {
    pub input: InputKey,
    pub node_id: NodeId,
    /// Time between two samples that the server granted, in milliseconds; absent where its queue suffices.
    pub sampling_ms: Option<f64>,
    /// Number of changes that the server's queue holds between two messages; absent where it suffices.
    pub queue_size: Option<u32>,
    /// Number of times in this session that the server said that its queue overflowed.
    pub overflows: u64,
}

/// Progress of a session towards live values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub enum SourceState {
    /// A connection is being made.
    Connecting,
    /// Connected, inputs are being subscribed.
    Subscribing,
    /// Connected, all inputs are live or tried.
    Connected,
    /// Disconnected; tried again after a pause.
    Waiting,
}

/// Problem of a source, with its remedy.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct SourceProblem {
    pub kind: SourceProblemKind,
    pub message: String,
    /// Action that resolves the problem, and the person who takes it.
    pub remedy: String,
}

impl SourceProblem {
    /// Returns a problem with the remedy of its kind.
    pub(crate) fn new(kind: SourceProblemKind, message: impl Into<String>) -> Self {
        Self { kind, message: message.into(), remedy: kind.remedy().into() }
    }
}

/// Kinds of problems with a source.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub enum SourceProblemKind {
    /// No answer from the address.
    Unreachable,
    /// The host name in the address is known to no name service here.
    HostNameUnknown,
    /// The host answers, but nothing listens at the port.
    NothingListens,
    /// The server does not show its endpoints without protection (OPC 10000-4 §5.5.4 demands that).
    EndpointsHidden,
    /// The server offers no endpoint that fits the choice of security or identity.
    NoSuitableEndpoint,
    /// The server offers security policies that are outdated, and no others.
    SecurityOutdated,
    /// The server's certificate is not trusted (yet).
    ServerCertificateUntrusted,
    /// The server's certificate is trusted but not valid: expired, wrong name or key.
    ServerCertificateInvalid,
    /// The key of the server's certificate is too short for the security policy.
    ServerKeyTooShort,
    /// The server does not trust the connector's certificate (yet).
    ClientCertificateRejected,
    /// The server takes the connector's certificate for expired or not valid yet.
    ClientCertificateOutOfTime,
    /// User name, password or user certificate are wrong.
    CredentialsRejected,
    /// The server has no room for another session.
    ServerFull,
    /// The connection was lost.
    ConnectionLost,
    /// The connection looked alive but delivered nothing.
    Stalled,
    /// The server answered in a way that makes no sense, or refused for another reason.
    Refused,
    /// The connector's setup is wrong: certificate or key files, address.
    Configuration,
}

impl SourceProblemKind {
    /// Returns the action that resolves the problem, with the person who must take it.
    const fn remedy(self) -> &'static str {
        match self {
            Self::Unreachable => {
                "Check that the server runs, the address, and the network between. Tried again on its own."
            }
            Self::HostNameUnknown => {
                "Check the name, or use the server's IP address. Tried again on its own."
            }
            Self::NothingListens => {
                "Check the port, and that the OPC UA server of the machine is switched on. Tried again on its own."
            }
            Self::EndpointsHidden => {
                "Allow the security policy None for discovery in the server's settings; sessions stay protected."
            }
            Self::NoSuitableEndpoint => {
                "Choose a security setting and a sign-in that the server offers."
            }
            Self::SecurityOutdated => {
                "Switch on the security policy Basic256Sha256, signed and encrypted, in the server's settings."
            }
            Self::ServerCertificateUntrusted => {
                "Compare the fingerprint with that of the server's own certificate and approve it in the list of certificates."
            }
            Self::ServerCertificateInvalid => "Renew the server's certificate.",
            Self::ServerKeyTooShort => {
                "Have the server make a certificate with a key of 2048 bits or more."
            }
            Self::ClientCertificateRejected => {
                "Ask the server's administrator to trust this connector's certificate, then wait a moment."
            }
            Self::ClientCertificateOutOfTime => {
                "Set the clock of the server. If it is right, renew this connector's certificate."
            }
            Self::CredentialsRejected => {
                "Correct user name and password, or ask the server's administrator."
            }
            Self::ServerFull => {
                "Close another client of the server, or raise its limit of sessions."
            }
            Self::ConnectionLost => "Nothing to do: it is connected again on its own.",
            Self::Stalled => {
                "Nothing to do: a new session is made. If it happens often, look at the server."
            }
            Self::Refused => "Look at the server's log for the reason.",
            Self::Configuration => "Correct the configuration of the source.",
        }
    }
}

/// Reason why an input has no value.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct InputProblem {
    pub input: InputKey,
    pub node_id: NodeId,
    /// Status of the server, or of the connector when the server gave none.
    pub status: StatusCode,
    pub reason: String,
}

/// The endpoint in use.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct ChosenEndpoint {
    pub endpoint_url: String,
    pub security_policy: SecurityPolicy,
    pub message_security: MessageSecurity,
    /// Application name of the server.
    pub server_name: String,
    /// The server's application URI.
    pub application_uri: String,
}

/// Product behind a server, as it says (OPC 10000-5 §12.4, BuildInfo); empty where it says nothing.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct ServerProduct {
    pub product_uri: String,
    pub product_name: String,
    pub manufacturer_name: String,
    pub software_version: String,
}

impl ServerProduct {
    /// Returns the family of a server with this product, where it is one that is known.
    pub(crate) fn family(&self, endpoint: &ChosenEndpoint) -> Option<String> {
        let said = [&endpoint.application_uri, &self.product_uri, &self.product_name];
        ServerProfile::recognised(said.map(String::as_str)).map(|profile| profile.family.clone())
    }
}

/// A server's limits (OPC 10000-5 §6.3.2, §6.3.11); `None` where it declares none.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
#[allow(missing_docs)]
pub struct ServerLimits {
    pub nodes_per_read_max: Option<u32>,
    pub nodes_per_write_max: Option<u32>,
    pub nodes_per_browse_max: Option<u32>,
    pub paths_per_translate_max: Option<u32>,
    pub items_per_call_max: Option<u32>,
    pub items_per_subscription_max: Option<u32>,
    pub subscriptions_per_session_max: Option<u32>,
    pub browse_continuation_points_max: Option<u32>,
    pub sessions_max: Option<u32>,
    pub queue_size_max: Option<u32>,
}
