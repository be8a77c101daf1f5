//! Problems behind the errors and status codes with which servers are not reached, or refuse a session.

use opcua_stack::opcua::types::{Error, StatusCode};

use crate::{SecurityPolicy, SourceProblem, SourceProblemKind as Kind};

/// Returns the problem behind the error of a server that does not list its endpoints. Its text is the stack's, for those
/// who wrote it, so that people get it only where nothing better is known.
pub(super) fn discovery_problem(endpoint_url: &str, error: &Error) -> SourceProblem {
    let text = error.to_string();
    let (kind, message) = if text.contains("Invalid address") {
        (Kind::HostNameUnknown, format!("No name service here knows the host in {endpoint_url}."))
    } else if text.contains("ConnectionRefused") {
        (Kind::NothingListens, format!("Nothing listens at {endpoint_url}."))
    } else if text.contains("Could not connect") {
        (Kind::Unreachable, format!("There is no way to {endpoint_url}."))
    } else if error.status() == StatusCode::BadSecurityPolicyRejected {
        let message =
            format!("The server at {endpoint_url} does not show its endpoints without protection.");
        (Kind::EndpointsHidden, message)
    } else {
        (Kind::Unreachable, format!("No OPC UA server answers at {endpoint_url}: {text}."))
    };
    SourceProblem::new(kind, message)
}

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
        StatusCode::BadCertificateTimeInvalid | StatusCode::BadCertificateIssuerTimeInvalid => (
            Kind::ClientCertificateOutOfTime,
            "By the server's clock this connector's certificate is not valid",
        ),
        StatusCode::BadCertificateInvalid
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_problem_names_who_must_act_and_no_text_of_the_stack() {
        let url = "opc.tcp://plc-1:4840";
        let refused =
            r#"Could not connect to host 10.0.0.7:4840, Os { code: 111, kind: ConnectionRefused }"#;
        let unknown = r#"Invalid address opc.tcp://plc-1:4840, cannot be parsed Custom { kind: Uncategorized }"#;
        let away =
            r#"Could not connect to host 10.0.0.7:4840, Os { code: 113, kind: HostUnreachable }"#;
        for (status, text, expected) in [
            (StatusCode::BadTcpEndpointUrlInvalid, unknown, Kind::HostNameUnknown),
            (StatusCode::BadCommunicationError, refused, Kind::NothingListens),
            (StatusCode::BadCommunicationError, away, Kind::Unreachable),
            (StatusCode::BadSecurityPolicyRejected, "", Kind::EndpointsHidden),
        ] {
            let problem = discovery_problem(url, &Error::new(status, text));
            assert_eq!(problem.kind, expected);
            assert!(problem.message.contains(url) && !problem.message.contains("kind:"));
        }
    }

    #[test]
    fn a_certificate_that_is_out_of_time_by_the_servers_clock_is_no_question_of_trust() {
        let kind = |status| session_problem(status, "", SecurityPolicy::Basic256Sha256).kind;
        assert_eq!(kind(StatusCode::BadCertificateTimeInvalid), Kind::ClientCertificateOutOfTime);
        assert_eq!(kind(StatusCode::BadSecurityChecksFailed), Kind::ClientCertificateRejected);
    }
}
