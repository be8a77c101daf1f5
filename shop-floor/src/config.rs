//! Configuration of the client and of its sources.

use std::{fmt, path::PathBuf, time::Duration};

use opcua_stack::limits;
use serde::{Deserialize, Serialize, Serializer, ser::Error as _};
use shop_floor_model::SourceId;
use utoipa::ToSchema;
use zeroize::Zeroizing;

/// Configuration of the client.
#[derive(Debug, Clone)]
pub struct Config {
    /// Directory of the client certificate and of trusted and rejected server certificates. Created
    /// on first use.
    pub pki_directory: PathBuf,
    /// The application's name as servers see it.
    pub application_name: String,
    /// The application's URI, also in its certificate. Globally unique.
    pub application_uri: String,
    /// Most batches of changes that wait for the consumer before changes are coalesced.
    pub waiting_batches_max: usize,
    /// Most sources that are accepted.
    pub sources_max: usize,
    /// Most inputs that are monitored, over all sources.
    pub inputs_max: usize,
    /// Most bytes of messages that are not complete or not delivered yet, over all sources.
    pub incoming_bytes_max: usize,
}

impl Config {
    /// Returns a configuration with the usual limits.
    #[must_use]
    pub fn new(
        pki_directory: impl Into<PathBuf>,
        application_name: &str,
        application_uri: &str,
    ) -> Self {
        Self {
            pki_directory: pki_directory.into(),
            application_name: application_name.to_owned(),
            application_uri: application_uri.to_owned(),
            waiting_batches_max: 256,
            sources_max: 1000,
            inputs_max: 1_000_000,
            incoming_bytes_max: limits::INCOMING_BYTES_MAX,
        }
    }
}

/// One OPC UA server to read from. The password is accepted but never serialised; who persists a
/// source stores [`Password::expose`] apart.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct SourceConfig {
    /// The source's name, unique in a connector.
    pub source_id: SourceId,
    /// Name for people.
    #[serde(default)]
    pub name: String,
    /// The server's address, `opc.tcp://host:port/path`.
    pub endpoint_url: String,
    /// Choice among the server's endpoints.
    #[serde(default)]
    pub security: SecurityChoice,
    /// Sign-in of the client on the server.
    #[serde(default)]
    pub identity: Identity,
    /// Sends a user's password over an unprotected connection, too, where everybody on the network can read
    /// it. For servers that offer nothing else.
    #[serde(default)]
    pub sends_password_unprotected: bool,
    /// Publishing interval of the subscriptions, in milliseconds (1 to 60 000).
    #[serde(default = "default_publishing_interval_ms")]
    pub publishing_interval_ms: u32,
    /// Sampling interval of the variables, in milliseconds (0 to 86 400 000; 0: on every change). Absent: the publishing
    /// interval. A mapping may ask for another one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sampling_interval_ms: Option<u32>,
    /// Milliseconds without any sign of life after which a connection is given up (500 to 600
    /// 000).
    #[serde(default = "default_silence_ms_max")]
    pub silence_ms_max: u32,
}

const fn default_publishing_interval_ms() -> u32 {
    20
}

const fn default_silence_ms_max() -> u32 {
    5000
}

impl SourceConfig {
    /// Returns a source with the usual settings: the strongest security that the server offers, anonymous.
    #[must_use]
    pub fn new(source_id: SourceId, endpoint_url: &str) -> Self {
        Self {
            name: source_id.to_string(),
            source_id,
            endpoint_url: endpoint_url.to_owned(),
            security: SecurityChoice::default(),
            identity: Identity::default(),
            sends_password_unprotected: false,
            publishing_interval_ms: default_publishing_interval_ms(),
            sampling_interval_ms: None,
            silence_ms_max: default_silence_ms_max(),
        }
    }

    pub(crate) fn publishing_interval(&self) -> Duration {
        Duration::from_millis(u64::from(self.publishing_interval_ms.clamp(1, 60_000)))
    }

    pub(crate) fn sampling_interval(&self) -> Duration {
        let sampling = |ms: u32| Duration::from_millis(u64::from(ms.min(86_400_000)));
        self.sampling_interval_ms.map_or_else(|| self.publishing_interval(), sampling)
    }

    pub(crate) fn silence_max(&self) -> Duration {
        Duration::from_millis(u64::from(self.silence_ms_max.clamp(500, 600_000)))
    }
}

/// Choice among a server's endpoints.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, ToSchema)]
#[serde(
    rename_all = "camelCase",
    rename_all_fields = "camelCase",
    tag = "choice",
    deny_unknown_fields
)]
pub enum SecurityChoice {
    /// The strongest that the server offers; never an unprotected one, which would
    /// let an attacker on the network downgrade the protection.
    #[default]
    Strongest,
    /// No protection. For servers that offer nothing else, on a network that is trusted.
    None,
    /// Exactly this policy and mode.
    Exactly {
        policy: SecurityPolicy,
        /// Signed only, or encrypted too.
        mode: MessageSecurity,
    },
}

/// Security policies (OPC 10000-7) that are not deprecated.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize, ToSchema,
)]
pub enum SecurityPolicy {
    None,
    /// RSA 2048 to 4096, AES-128.
    Aes128Sha256RsaOaep,
    /// RSA 2048 to 4096, AES-256, the most widespread.
    Basic256Sha256,
    /// RSA 2048 to 4096 with PSS, AES-256.
    Aes256Sha256RsaPss,
}

/// Protection of messages.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize, ToSchema,
)]
#[serde(rename_all = "camelCase")]
pub enum MessageSecurity {
    None,
    Sign,
    /// Signed and encrypted.
    SignAndEncrypt,
}

/// Sign-in of the client on a server.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize, ToSchema)]
#[serde(
    rename_all = "camelCase",
    rename_all_fields = "camelCase",
    tag = "kind",
    deny_unknown_fields
)]
pub enum Identity {
    #[default]
    Anonymous,
    /// A user with a password.
    #[schema(rename_all = "camelCase")]
    UserName {
        user_name: String,
        #[serde(default, skip_serializing_if = "Password::is_write_only")]
        #[schema(write_only)]
        password: Password,
    },
    /// A user with a certificate and its private key, as files.
    #[schema(rename_all = "camelCase")]
    Certificate {
        /// The certificate, DER or PEM.
        #[schema(value_type = String)]
        certificate_path: PathBuf,
        /// Its private key, PEM.
        #[schema(value_type = String)]
        private_key_path: PathBuf,
    },
}

/// A password: not printed, not serialised, wiped from memory.
#[derive(Clone, Default, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(from = "String")]
#[schema(value_type = String, format = Password)]
pub struct Password(Zeroizing<String>);

impl Password {
    /// Returns true: a password is left out of every document. Its schema has it all the same.
    const fn is_write_only(&self) -> bool {
        true
    }

    /// Returns the plain password, to sign in or to store it.
    #[must_use]
    pub fn expose(&self) -> &str {
        &self.0
    }
}

impl From<String> for Password {
    fn from(text: String) -> Self {
        Self(Zeroizing::new(text))
    }
}

impl From<&str> for Password {
    fn from(text: &str) -> Self {
        text.to_owned().into()
    }
}

impl Serialize for Password {
    /// Fails: a document that would contain a password is never made.
    fn serialize<S: Serializer>(&self, _: S) -> Result<S::Ok, S::Error> {
        Err(S::Error::custom("a password is not serialised"))
    }
}

impl fmt::Debug for Password {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Password(redacted)")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_source_reads_from_little_and_never_shows_its_password() {
        let source: SourceConfig = serde_json::from_str(
            r#"{"sourceId":"press-1","endpointUrl":"opc.tcp://press:4840",
                "identity":{"kind":"userName","userName":"eng","password":"s3cret"}}"#,
        )
        .expect("valid");
        assert_eq!(source.security, SecurityChoice::Strongest);
        assert_eq!(source.publishing_interval(), Duration::from_millis(20));
        assert_eq!(source.sampling_interval(), Duration::from_millis(20));
        let Identity::UserName { password, .. } = &source.identity else { panic!("a user") };
        assert_eq!(password.expose(), "s3cret");
        assert!(!serde_json::to_string(&source).expect("serialises").contains("s3cret"));
        assert!(!format!("{source:?}").contains("s3cret"));
    }
}
