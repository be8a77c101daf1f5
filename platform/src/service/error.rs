//! Errors of the platform's start.

use std::path::PathBuf;

use broker::BrokerError;
use daemon::{
    client_certificate::ClientCertificateError,
    data_directory::DataDirectoryError,
    telemetry::TelemetryError,
    web::{server::ServerError, session::PasswordError},
};
use messaging::LinkError;

use crate::{
    access_log_key::AccessLogKeyError, administrator::AdministratorError,
    broker_access::BrokerAccessError, broker_process::BrokerProcessError,
    certificates::CertificateError, config::BrokerPasswordError, enrolment::CertificateUnreadable,
    store::StoreError, witness::WitnessError,
};

/// Failure to start the platform.
#[derive(Debug, thiserror::Error)]
pub enum StartError {
    /// The data directory cannot be used.
    #[error(transparent)]
    DataDirectory(#[from] DataDirectoryError),
    /// The root certificates of an external broker cannot be read.
    #[error("cannot read broker.external.root_certificates {}", path.display())]
    RootCertificates { path: PathBuf, source: std::io::Error },
    /// The platform's password at an external broker cannot be read.
    #[error("the password at the broker cannot be read")]
    BrokerPassword(#[from] BrokerPasswordError),
    /// The platform's certificate at an external broker cannot be used.
    #[error("broker.external.client_certificate cannot be used")]
    ClientCertificate(#[from] ClientCertificateError),
    /// The database cannot be used.
    #[error("the database cannot be used")]
    Store(#[from] StoreError),
    /// Secrets in the database cannot be sealed, or a key is missing.
    #[error("secrets in the database cannot be sealed")]
    Sealing(#[source] anyhow::Error),
    /// The embedded broker cannot start.
    #[error("the embedded broker cannot start")]
    Broker(#[from] BrokerError),
    /// The embedded broker's process cannot start.
    #[error("the embedded broker's process cannot start")]
    BrokerProcess(#[from] BrokerProcessError),
    /// The certificate authority cannot be used.
    #[error("the certificate authority cannot be used")]
    Certificates(#[from] CertificateError),
    /// The key of the witness cannot be used.
    #[error("the key of the witness cannot be used")]
    Witness(#[from] WitnessError),
    /// The key that signs checkpoints of access logs cannot be used.
    #[error("the key of the access logs cannot be used")]
    AccessLogKey(#[from] AccessLogKeyError),
    /// The certificate for enrolment tokens cannot be read.
    #[error("enrolment tokens cannot be made")]
    EnrolmentCertificate(#[from] CertificateUnreadable),
    /// The link cannot be made.
    #[error("the link to the broker cannot be made")]
    Link(#[from] LinkError),
    /// Users and queues cannot be set up.
    #[error("users and queues cannot be set up")]
    BrokerAccess(#[from] BrokerAccessError),
    /// The pages cannot be served.
    #[error("pages and API cannot be served")]
    Web(#[from] ServerError),
    /// The first administrator cannot be made.
    #[error("the first administrator cannot be made")]
    Administrator(#[from] AdministratorError),
    /// A password is refused.
    #[error("admin.password is refused")]
    Password(#[from] PasswordError),
    /// Metrics cannot be set up.
    #[error("metrics cannot be set up")]
    Telemetry(#[from] TelemetryError),
}
