//! Why the twin could not start or go on.

use std::{net::SocketAddr, path::PathBuf};

use crate::security::trust::TrustFault;

/// Why the twin could not start or go on.
#[derive(Debug, thiserror::Error)]
pub enum TwinError {
    /// The address to listen on is taken or not ours.
    #[error(
        "cannot listen on {address}; choose another `listen` address or stop the program that uses it"
    )]
    Listen {
        /// The configured address.
        address: SocketAddr,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// A certificate, key or folder of the trust list could not be read or written.
    #[error("cannot access {} of the twin's certificates", path.display())]
    Pki {
        /// The file or folder.
        path: PathBuf,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// The own certificate could not be made or read.
    #[error("cannot use the twin's own certificate: {reason}")]
    Certificate {
        /// What is wrong with it.
        reason: String,
    },
    /// What was brought for the trust list, or as the own certificate, is not taken.
    #[error("it cannot be used: {}", faults.iter().map(|fault| fault.message.as_str()).collect::<Vec<_>>().join(" "))]
    Refused {
        /// Everything that is wrong with it.
        faults: Vec<TrustFault>,
    },
    /// The configuration contradicts itself.
    #[error("the twin's configuration is wrong: {}", faults.join("; "))]
    Faults {
        /// Everything that is wrong.
        faults: Vec<String>,
    },
    /// The server's settings contradict each other.
    #[error("the OPC UA server does not accept its configuration: {reason}")]
    Configuration {
        /// What it says.
        reason: String,
    },
    /// The server ended with an error.
    #[error("the OPC UA server failed: {reason}")]
    Server {
        /// What it says.
        reason: String,
    },
    /// The twin ended before it listened.
    #[error("the twin has stopped")]
    Stopped,
}

impl From<TrustFault> for TwinError {
    fn from(fault: TrustFault) -> Self {
        Self::Refused { faults: vec![fault] }
    }
}
