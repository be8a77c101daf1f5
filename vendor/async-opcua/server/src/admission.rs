//! Hooks that decide who may connect, before and while a session is created.

use std::{any::Any, net::SocketAddr};

use opcua_crypto::{SecurityPolicy, X509};
use opcua_types::Error;

/// Decides about incoming connections, for limits per address or in total.
pub trait ConnectionFilter: Send + Sync + 'static {
    /// Called for each accepted socket. `None` closes it at once; a permit is kept until the connection ends, so that
    /// dropping it can count.
    fn admit(&self, peer: SocketAddr) -> Option<Box<dyn Any + Send>>;
}

/// Decides about the certificates of clients in place of the certificate store's exact file match, for example with
/// certificate chains and revocation lists.
pub trait CertificateValidator: Send + Sync + 'static {
    /// Called when a client creates a session on a secured channel.
    fn validate(&self, certificate: &X509, security_policy: SecurityPolicy) -> Result<(), Error>;
}
