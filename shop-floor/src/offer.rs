//! Offer of a server that is no source yet, and the findings of a test of it.

use asi_model::values::DateTime;
use serde::Serialize;
use utoipa::ToSchema;

use crate::{ChosenEndpoint, MessageSecurity, SecurityChoice, ServerLimits, ServerProduct};

/// Answer of a server that was asked what it offers. Nothing of it is kept.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct ServerOffer {
    /// Endpoints of the server, the strongest that can be used first.
    pub endpoints: Vec<EndpointOffer>,
    /// Certificates of these endpoints, each once.
    pub certificates: Vec<OfferedCertificate>,
    /// Findings that a person should know before relying on the server.
    pub findings: Vec<ServerFinding>,
}

/// An endpoint that a server offers.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct EndpointOffer {
    /// Address of the server as the server returns it.
    pub endpoint_url: String,
    /// Address that is used instead: with the host and port that were asked.
    pub used_url: String,
    /// Name of the policy, also of one that the client does not use.
    pub security_policy: String,
    pub message_security: MessageSecurity,
    /// Choice of security that takes this endpoint; absent where the client does not use it.
    pub choice: Option<SecurityChoice>,
    /// Accepts anonymous users.
    pub allows_anonymous: bool,
    /// Accepts user name and password.
    pub allows_user_name: bool,
    /// Accepts user certificates.
    pub allows_certificate: bool,
    pub server_name: String,
    /// The server's application URI.
    pub application_uri: String,
    /// SHA-256 fingerprint of the server's certificate, hex.
    pub certificate_fingerprint: Option<String>,
}

/// Certificate that a server offers, to be compared with the one at the machine.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct OfferedCertificate {
    /// SHA-1 thumbprint, hex: the certificate's name in OPC UA.
    pub thumbprint: String,
    /// SHA-256 fingerprint, hex, for people to compare.
    pub fingerprint: String,
    /// Distinguished name of the subject.
    pub subject: String,
    /// The application it is for.
    pub application_uri: Option<String>,
    /// The names and addresses of the machine it is for.
    pub host_names: Vec<String>,
    pub valid_from: Option<DateTime>,
    pub valid_to: Option<DateTime>,
    /// The length of its RSA key in bits.
    pub key_bits: Option<usize>,
    /// True where it is signed over SHA-1, of which two certificates with the same can be made.
    pub is_signed_with_sha1: bool,
    /// True where a person approved it already.
    pub is_trusted: bool,
}

/// Finding about a server that does not keep it from being used.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase", rename_all_fields = "camelCase", tag = "code")]
pub enum ServerFinding {
    /// The server calls itself by a host name that nothing here knows.
    #[schema(rename_all = "camelCase")]
    HostNameUnknown {
        host: String,
        used_url: String,
    },
    /// The server calls itself by another host than the one that was asked.
    #[schema(rename_all = "camelCase")]
    HostNameDiffers {
        host: String,
        used_url: String,
    },
    /// The server offers no endpoint with encryption that is not outdated.
    NothingEncrypted {
        offered: Vec<String>,
    },
    #[schema(rename_all = "camelCase")]
    CertificateExpired {
        fingerprint: String,
        valid_to: DateTime,
    },
    #[schema(rename_all = "camelCase")]
    CertificateNotYetValid {
        fingerprint: String,
        valid_from: DateTime,
    },
    /// The certificate is for other hosts than the one that was asked.
    #[schema(rename_all = "camelCase")]
    CertificateOfOtherHost {
        fingerprint: String,
        host: String,
        host_names: Vec<String>,
    },
    /// The certificate is for another application than the server says it is.
    #[schema(rename_all = "camelCase")]
    CertificateOfOtherApplication {
        fingerprint: String,
        application_uri: String,
    },
    /// The key is too short for the policies that are not outdated.
    #[schema(rename_all = "camelCase")]
    KeyTooShort {
        fingerprint: String,
        key_bits: usize,
    },
    SignedWithSha1 {
        fingerprint: String,
    },
    /// The clocks differ. Negative where the server's is behind.
    #[schema(rename_all = "camelCase")]
    ClockDiffers {
        ahead_ms: i64,
    },
}

/// Findings of a session that was opened as a source would, and closed again.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct TestedServer {
    pub endpoint: ChosenEndpoint,
    pub product: ServerProduct,
    /// Family of the server, where it is one that is known.
    pub family: Option<String>,
    /// The server's limits as it declares them.
    pub limits: ServerLimits,
    /// Publishing interval that the server grants where that of the source is requested, in milliseconds; absent where it
    /// refuses a subscription.
    pub publishing_interval_ms: Option<u64>,
    /// Milliseconds by which the server's clock is ahead of the connector's.
    pub clock_ahead_ms: Option<i64>,
    /// Findings that a person should know before relying on the server.
    pub findings: Vec<ServerFinding>,
}
