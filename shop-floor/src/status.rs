//! How a source is doing, with the evidence.

use asi_model::values::{DateTime, NodeId, StatusCode};
use serde::Serialize;
use utoipa::ToSchema;

use crate::{InputKey, MessageSecurity, SecurityPolicy, SourceId};

/// How a source is doing.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct SourceStatus {
    /// Which source.
    pub source_id: SourceId,
    /// Its state.
    pub state: SourceState,
    /// Since when.
    #[schema(value_type = String, format = DateTime)]
    pub since: DateTime,
    /// What is wrong and who must do what, where something is.
    pub problem: Option<SourceProblem>,
    /// How many inputs are wanted from it.
    pub inputs: usize,
    /// How many of them the server monitors and has given a first value for.
    pub live: usize,
    /// How many inputs would be found again if the server changed its node ids: those whose browse
    /// path is known.
    pub findable: usize,
    /// The inputs that are not live, each with the reason; the first 1000.
    pub not_live: Vec<InputProblem>,
    /// When a change last arrived.
    #[schema(value_type = Option<String>, format = DateTime)]
    pub last_change_at: Option<DateTime>,
    /// When the server last gave any sign of life.
    #[schema(value_type = Option<String>, format = DateTime)]
    pub last_sign_of_life_at: Option<DateTime>,
    /// Changes received since the connector started.
    pub changes: u64,
    /// How often a session was established since the connector started.
    pub sessions: u64,
    /// How far the server's clock is ahead of ours, in milliseconds, measured when the session was
    /// established.
    pub clock_ahead_ms: Option<i64>,
    /// The endpoint in use.
    pub endpoint: Option<ChosenEndpoint>,
    /// The server's limits as it declares them.
    pub limits: Option<ServerLimits>,
}

/// The state of a source.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub enum SourceState {
    /// A connection is being made.
    Connecting,
    /// Connected, inputs are being subscribed.
    Subscribing,
    /// Connected, all inputs are live or tried.
    Connected,
    /// Not connected; tried again after a pause.
    Waiting,
}

/// What is wrong with a source.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct SourceProblem {
    /// Of which kind.
    pub kind: SourceProblemKind,
    /// What happened.
    pub message: String,
    /// Who should do what.
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
    /// The server offers no endpoint that fits the choice of security or identity.
    NoSuitableEndpoint,
    /// We do not trust the server's certificate (yet).
    ServerCertificateUntrusted,
    /// We trust the server's certificate but it is not valid: expired, wrong name or key.
    ServerCertificateInvalid,
    /// The server does not trust our certificate (yet).
    ClientCertificateRejected,
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
    /// Our own setup is wrong: certificate or key files, address.
    Configuration,
}

impl SourceProblemKind {
    /// Returns the action that resolves the problem, with the person who must take it.
    const fn remedy(self) -> &'static str {
        match self {
            Self::Unreachable => {
                "Check that the server runs, the address, and the network between. Tried again on its own."
            }
            Self::NoSuitableEndpoint => {
                "Choose a security setting and a sign-in that the server offers."
            }
            Self::ServerCertificateUntrusted => {
                "Compare the thumbprint with the server's own certificate and approve it in the list of certificates."
            }
            Self::ServerCertificateInvalid => "Renew the server's certificate.",
            Self::ClientCertificateRejected => {
                "Ask the server's administrator to trust this connector's certificate, then wait a moment."
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

/// Why an input is not live.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct InputProblem {
    /// Which input.
    #[schema(value_type = u64)]
    pub input: InputKey,
    /// Its variable.
    #[schema(value_type = String)]
    pub node_id: NodeId,
    /// The server's status, or ours.
    #[schema(value_type = u32)]
    pub status: StatusCode,
    /// In words.
    pub reason: String,
}

/// The endpoint in use.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct ChosenEndpoint {
    /// The address that is used.
    pub endpoint_url: String,
    /// Its policy.
    pub security_policy: SecurityPolicy,
    /// How messages are protected.
    pub message_security: MessageSecurity,
    /// What the server calls itself.
    pub server_name: String,
    /// The server's application URI.
    pub application_uri: String,
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
}
