//! State shared by the API's handlers.

use std::{sync::Arc, time::Duration};

use asi_model::DateTime;
use daemon::{
    plaintext::PlaintextWay,
    telemetry::Metrics,
    web::{health::Readiness, session::Sessions},
};
use messaging::BrokerProfile;
use tokio_util::sync::CancellationToken;

use crate::{
    accesses::AccessRecorder, accounts::StoredAccounts, audit::RecordingStore,
    broker_access::BrokerAccess, clock::Clock, config::PlatformConfig, enrolment::EnrolmentAddress,
    ingest::IngestHandle, live::LiveLog, witness::WitnessKey,
};

/// Endpoint of the broker for connectors and tools, handed out with their credentials.
#[derive(Debug, Clone)]
pub struct BrokerEndpoint {
    pub url: String,
    /// Names of logical addresses at this broker.
    pub profile: BrokerProfile,
    /// The authority that vouches for it; absent where the system's roots do.
    pub root_certificate_pem: Option<String>,
}

/// The shared parts. Clones share them.
#[derive(Clone)]
pub struct Application(Arc<ApplicationParts>);

/// Components of an [`Application`].
pub struct ApplicationParts {
    pub config: PlatformConfig,
    /// The database: what is changed by it is on record.
    pub store: RecordingStore,
    /// Hands values out, once it is on record who gets them.
    pub accesses: AccessRecorder,
    pub live: LiveLog,
    /// Users, queues and the link.
    pub broker_access: BrokerAccess,
    /// Handle to process dead letters again.
    pub ingest: IngestHandle,
    /// The key that countersigns checkpoints of ledgers.
    pub witness: Arc<WitnessKey>,
    /// The signed-in user and the token of its session.
    pub sessions: Sessions<StoredAccounts>,
    pub clock: Clock,
    /// Endpoint of the broker for connectors and tools.
    pub broker_endpoint: BrokerEndpoint,
    /// Base URL for browsers and connectors, with the certificate shown there.
    pub enrolment_address: EnrolmentAddress,
    /// Ways to other machines without TLS.
    pub plaintext_ways: Vec<PlaintextWay>,
    /// Conditions of readiness.
    pub readiness: Readiness,
    pub metrics: Metrics,
    /// Time of the daemon's start.
    pub started_at: DateTime,
    /// Cancelled at shutdown, so that live streams end.
    pub shutdown: CancellationToken,
}

impl Application {
    /// Joins the parts.
    #[must_use]
    pub fn new(parts: ApplicationParts) -> Self {
        Self(Arc::new(parts))
    }

    /// Time after which an unanswered part is sent again.
    #[must_use]
    pub fn resend_after(&self) -> Duration {
        Duration::from_millis(self.config.parts.resend_after_ms)
    }
}

impl std::ops::Deref for Application {
    type Target = ApplicationParts;
    fn deref(&self) -> &ApplicationParts {
        &self.0
    }
}

impl std::fmt::Debug for Application {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Application")
    }
}
