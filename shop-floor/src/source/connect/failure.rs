//! Problems behind the status codes with which servers refuse a session.

use opcua_stack::opcua::types::StatusCode;

use crate::{SecurityPolicy, SourceProblem, SourceProblemKind as Kind};

/// Returns the problem behind the status of a refused session. `detail` may be empty.
pub(super) fn session_problem(
    status: StatusCode,
    detail: &str,
    policy: SecurityPolicy,
) -> SourceProblem {
    let secure = policy != SecurityPolicy::None;
    let detail = if detail.is_empty() { String::new() } else { format!(" ({detail})") };
    let (kind, message) = match status {
        StatusCode::BadUserAccessDenied
        | StatusCode::BadIdentityTokenRejected
        | StatusCode::BadIdentityTokenInvalid
        | StatusCode::BadUserSignatureInvalid => {
            (Kind::CredentialsRejected, "The server does not accept the sign-in")
        }
        StatusCode::BadTooManySessions
        | StatusCode::BadTcpNotEnoughResources
        | StatusCode::BadMaxConnectionsReached => {
            (Kind::ServerFull, "The server has no room for another session")
        }
        StatusCode::BadCertificateTimeInvalid
        | StatusCode::BadCertificateIssuerTimeInvalid
        | StatusCode::BadCertificateInvalid
        | StatusCode::BadCertificateUriInvalid
        | StatusCode::BadCertificateHostNameInvalid
        | StatusCode::BadCertificateUseNotAllowed
        | StatusCode::BadCertificateUntrusted
        | StatusCode::BadCertificateChainIncomplete
        | StatusCode::BadSecurityChecksFailed
        | StatusCode::BadCertificateRevoked => (
            Kind::ClientCertificateRejected,
            "The server does not accept this connector's certificate",
        ),
        // Many servers just close the connection when they do not trust a certificate.
        StatusCode::BadConnectionClosed | StatusCode::BadSecureChannelClosed if secure => (
            Kind::ClientCertificateRejected,
            "The server closed the connection while it was made secure; most often it does not trust \
             this connector's certificate",
        ),
        StatusCode::BadConnectionClosed
        | StatusCode::BadConnectionRejected
        | StatusCode::BadCommunicationError
        | StatusCode::BadTimeout
        | StatusCode::BadRequestTimeout
        | StatusCode::BadTcpEndpointUrlInvalid
        | StatusCode::BadServerHalted
        | StatusCode::BadShutdown => (Kind::Unreachable, "The server does not answer properly"),
        StatusCode::BadResponseTooLarge | StatusCode::BadEncodingLimitsExceeded => {
            (Kind::Refused, "The server sends more than this connector takes")
        }
        _ => (Kind::Refused, "The server refuses a session"),
    };
    SourceProblem::new(kind, format!("{message}: {status}{detail}."))
}
