//! Context of all operations: handles of the connector's parts, sessions and accounts.

use std::{path::PathBuf, sync::Arc};

use asi_model::{DateTime, FactoryId, pubsub::json::Encoding};
use daemon::{
    configuration::Setting,
    plaintext::PlaintextWay,
    sealing::Sealer,
    telemetry::Metrics,
    web::{
        Problem,
        client_address::TrustedProxies,
        health::Readiness,
        session::{PasswordHashing, SessionConfig, Sessions},
        shares::PersonShare,
    },
};
use mapping_engine::MappingEngineHandle;
use messaging::LinkHandle;
use shop_floor::ShopFloorHandle;
use tokio::sync::{Notify, Semaphore, watch};
use tokio_util::sync::CancellationToken;
use twin::TwinHandle;

use super::{accounts::StoredAccounts, machine_turns::MachineTurns, previews::ShownPreviews};
use crate::{
    catalog::CatalogHandle,
    coordinator::CoordinatorHandle,
    lease::LeaseStatus,
    live_events::LiveEvents,
    store::{ReaderUse, Readers, StoreSession},
};

/// First part of the name of the session's cookie.
pub(super) const COOKIE: &str = "verbund_connector";

/// Parts of the connector that operations use.
pub struct ApiParts {
    pub coordinator: CoordinatorHandle,
    /// Reading connections of the store.
    pub readers: Readers,
    pub shop_floor: ShopFloorHandle,
    pub engine: MappingEngineHandle,
    /// Lists of the variables of local servers.
    pub catalog: CatalogHandle,
    pub twin: TwinHandle,
    /// Link to the platform; none before the enrolment.
    pub link: Option<LinkHandle>,
    pub lease: watch::Receiver<LeaseStatus>,
    /// Events for pages.
    pub events: LiveEvents,
    /// Wakes the twin after a change of users.
    pub users_changed: Arc<Notify>,
    pub instance: RunningConnector,
    pub server: ServerParts,
}

/// Facts about the running connector.
pub struct RunningConnector {
    /// Factory that the connector speaks for.
    pub factory_id: FactoryId,
    pub started_at: DateTime,
    /// Directory of the store and of keys.
    pub data_directory: PathBuf,
    /// Seals the passwords of machines.
    pub sealer: Sealer,
    pub encoding: Encoding,
    pub settings: Vec<Setting>,
    /// Ways to other machines without TLS.
    pub plaintext_ways: Vec<PlaintextWay>,
}

/// Parts of the web server.
pub struct ServerParts {
    pub readiness: Readiness,
    pub metrics: Metrics,
    pub shutdown: CancellationToken,
    /// True if cookies are for TLS only.
    pub is_secure: bool,
    /// Port of the pages, part of the cookie's name.
    pub port: u16,
    /// Base URL of the pages for browsers, to which passkeys are bound.
    pub public_url: String,
    pub trusted_proxies: TrustedProxies,
    /// Share of a person in requests, downloads and live streams.
    pub share_per_person: PersonShare,
    /// Work of hashing.
    pub hashing: PasswordHashing,
}

/// Context of the operations; clones share it.
#[derive(Clone)]
pub struct Api {
    parts: Arc<ApiParts>,
    pub(super) sessions: Sessions<StoredAccounts>,
    pub(super) accounts: StoredAccounts,
    pub(super) previews: Arc<ShownPreviews>,
    /// Turn of the export that reads its next block: exports together take one reader.
    pub(super) export_turn: Arc<Semaphore>,
    /// Right to verify the ledger, which reads all of it.
    pub(super) verification: Arc<Semaphore>,
    pub(super) machine_turns: MachineTurns,
}

impl Api {
    /// Returns the context of these parts, without any session.
    #[must_use]
    pub fn new(parts: ApiParts) -> Self {
        let accounts = StoredAccounts::new(
            parts.readers.reserved_for(ReaderUse::SignIn),
            parts.instance.data_directory.clone(),
            Arc::clone(&parts.users_changed),
        );
        let issuer = format!("Verbund {}", parts.instance.factory_id);
        let (is_secure, port) = (parts.server.is_secure, parts.server.port);
        let public_url = &parts.server.public_url;
        let mut config = SessionConfig::new(COOKIE, issuer, is_secure, port, public_url);
        // The plant is one organisation: its people are kept apart, and nobody else is here.
        config.shares.person = parts.server.share_per_person.clone();
        let sessions = Sessions::new(
            config,
            accounts.clone(),
            parts.server.hashing.clone(),
            parts.instance.sealer.clone(),
        );
        Self {
            parts: Arc::new(parts),
            sessions,
            accounts,
            previews: Arc::default(),
            export_turn: Arc::new(Semaphore::new(1)),
            verification: Arc::new(Semaphore::new(1)),
            machine_turns: MachineTurns::default(),
        }
    }

    /// Returns the sign-in of the pages, whose attempts those at the OPC UA server count with.
    #[must_use]
    pub fn sign_in(&self) -> Sessions<StoredAccounts> {
        self.sessions.clone()
    }

    /// Takes a reading connection for what has to answer whatever else is read.
    pub(super) async fn reserved_store(&self) -> Result<StoreSession, Problem> {
        Ok(self.parts.readers.reserved_for(ReaderUse::SignIn).session().await?)
    }

    /// Takes a reading connection to the store, for what is read within some seconds.
    pub(super) async fn store(&self) -> Result<StoreSession, Problem> {
        Ok(self.parts.readers.page_session().await?)
    }
}

impl std::ops::Deref for Api {
    type Target = ApiParts;
    fn deref(&self) -> &ApiParts {
        &self.parts
    }
}
