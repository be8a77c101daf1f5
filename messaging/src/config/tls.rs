//! Trust and identity on TLS.

use std::fmt;

use bytes::Bytes;
use zeroize::Zeroizing;

/// Settings of TLS connections to the broker.
#[derive(Debug, Clone, Default)]
pub struct TlsConfig {
    /// Certificate authorities that may issue the broker's certificate.
    pub roots: Roots,
    /// The client certificate, if the broker asks for one.
    pub identity: Option<ClientIdentity>,
    /// The name expected in the broker's certificate, if it differs from the URL's host.
    pub server_name: Option<String>,
}

/// Certificate authorities whose signatures on the broker's certificate are trusted.
#[derive(Debug, Clone, Default)]
pub enum Roots {
    /// Authorities of the operating system.
    #[default]
    System,
    /// Authorities of this text, as PEM.
    Pem(Bytes),
}

/// A client certificate with its key.
#[derive(Clone)]
pub struct ClientIdentity {
    /// The chain, leaf first, as PEM.
    pub certificates_pem: Bytes,
    /// The private key, as PEM; wiped from memory when dropped.
    pub key_pem: Zeroizing<Vec<u8>>,
}

impl fmt::Debug for ClientIdentity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ClientIdentity").finish_non_exhaustive()
    }
}
