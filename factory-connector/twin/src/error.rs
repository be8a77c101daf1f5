//! Errors of the twin.

use std::{net::SocketAddr, path::PathBuf};

use crate::trust_fault::TrustFault;

/// Error for which the twin cannot start, continue or accept a certificate.
#[derive(Debug, thiserror::Error)]
pub enum TwinError {
    /// The address to listen on is in use or does not belong to this machine.
    #[error(
        "cannot listen on {address}; choose another `listen` address or stop the program that uses it"
    )]
    Listen { address: SocketAddr, source: std::io::Error },
    /// A certificate, key or folder of the trust list could not be read or written.
    #[error("cannot access {} of the twin's certificates", path.display())]
    Pki { path: PathBuf, source: std::io::Error },
    /// The application certificate could not be made or read.
    #[error("cannot use the twin's own certificate: {reason}")]
    Certificate { reason: String },
    /// A file for the trust list, or a certificate to install, has faults.
    #[error("it cannot be used: {}", faults.iter().map(|fault| fault.message.as_str()).collect::<Vec<_>>().join(" "))]
    Refused { faults: Vec<TrustFault> },
    /// The configuration contradicts itself.
    #[error("the twin's configuration is wrong: {}", faults.join("; "))]
    Faults { faults: Vec<String> },
    /// The server's settings contradict each other.
    #[error("the OPC UA server does not accept its configuration: {reason}")]
    Configuration { reason: String },
    /// The server ended with an error.
    #[error("the OPC UA server failed: {reason}")]
    Server { reason: String },
    /// The twin ended before it listened.
    #[error("the twin has stopped")]
    Stopped,
}

impl From<TrustFault> for TwinError {
    fn from(fault: TrustFault) -> Self {
        Self::Refused { faults: vec![fault] }
    }
}
