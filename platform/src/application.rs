//! What the API's handlers share.

use std::{sync::Arc, time::Duration};

use asi_model::DateTime;
use daemon::{
    telemetry::Metrics,
    web::{health::Readiness, session::Sessions},
};
use messaging::BrokerProfile;
use tokio_util::sync::CancellationToken;

use crate::{
    accounts::StoredAccounts, clock::Clock, config::PlatformConfig, ingest::IngestHandle,
    live::LiveLog, reach::Reach, store::Store,
};

/// How connectors and tools reach the broker; told when they get their credentials.
#[derive(Debug, Clone)]
pub struct BrokerAccess {
    /// Its address.
    pub url: String,
    /// What logical addresses are called there.
    pub profile: BrokerProfile,
    /// The authority that vouches for it; absent where the system's roots do.
    pub root_certificate_pem: Option<String>,
}

/// The shared parts. Clones share them.
#[derive(Clone)]
pub struct Application(Arc<Parts>);

/// What [`Application`] is made of.
pub struct Parts {
    /// The configuration.
    pub config: PlatformConfig,
    /// The database.
    pub store: Store,
    /// Live news.
    pub live: LiveLog,
    /// Users, queues and the link.
    pub reach: Reach,
    /// To try dead letters again.
    pub ingest: IngestHandle,
    /// Who is signed in.
    pub sessions: Sessions<StoredAccounts>,
    /// The time.
    pub clock: Clock,
    /// How the broker is reached.
    pub broker_access: BrokerAccess,
    /// How browsers and connectors reach us.
    pub public_url: String,
    /// What the daemon waits for.
    pub readiness: Readiness,
    /// The process's metrics.
    pub metrics: Metrics,
    /// When the daemon started.
    pub started_at: DateTime,
    /// Cancelled at shutdown, so that live streams end.
    pub shutdown: CancellationToken,
}

impl Application {
    /// Joins the parts.
    #[must_use]
    pub fn new(parts: Parts) -> Self {
        Self(Arc::new(parts))
    }

    /// After how long an unanswered part is sent again.
    #[must_use]
    pub fn resend_after(&self) -> Duration {
        Duration::from_millis(self.config.parts.resend_after_ms)
    }
}

impl std::ops::Deref for Application {
    type Target = Parts;
    fn deref(&self) -> &Parts {
        &self.0
    }
}

impl std::fmt::Debug for Application {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Application")
    }
}
