//! A connector that starts again: from its durable file to everything shown.

use std::{
    path::Path,
    sync::Arc,
    time::{Duration, Instant},
};

use anyhow::Context as _;
use asi_model::{FactoryId, pubsub::json::Encoding};
use connector_state::{EngineCommand, StateConfig};
use factory_connector::{
    config::{RetentionLimits, SpoolLimits},
    coordinator::{self, Coordinator, CoordinatorConfig, CoordinatorHandle, Outputs},
    live_events::LiveEvents,
    store::Store,
};
use messaging::{Delivery, Envelope, Settlement};
use serde_json::Value;
use time::OffsetDateTime;
use tokio::{sync::mpsc, task::JoinHandle};
use tokio_util::sync::CancellationToken;

use super::server::{FACTORY, new, now, text};
use crate::bench::figures::figure;

const NETWORKS: usize = 10_000;
const FIELDS_PER_NETWORK: usize = 10;
/// Messages in one delivery.
const BATCH: usize = 500;

/// Stores 10 000 networks with 100 000 fields, then measures a start.
pub(in crate::bench) async fn measure() -> anyhow::Result<Vec<Value>> {
    let folder = tempfile::tempdir()?;
    let connector = Connector::start(folder.path()).await?;
    for first in (0..NETWORKS).step_by(BATCH) {
        let batch = (first..first + BATCH).map(delivery).collect::<anyhow::Result<Vec<_>>>()?;
        let settled = connector.coordinator.deliver(batch).await;
        let accepted =
            settled.iter().filter(|settlement| matches!(settlement, Settlement::Accept)).count();
        anyhow::ensure!(
            accepted == BATCH,
            "{accepted} of {BATCH} networks were stored: {:?}",
            settled.first()
        );
    }
    connector.stop().await?;
    let start = Instant::now();
    let connector = Connector::start(folder.path()).await?;
    let took = start.elapsed();
    let shown = connector.shown;
    connector.stop().await?;
    anyhow::ensure!(shown == NETWORKS, "{shown} of {NETWORKS} networks are shown again");
    Ok(vec![figure(
        "connector: start with 100 000 fields in 10 000 networks, until all are shown",
        took.as_secs_f64(),
        "s",
    )])
}

struct Connector {
    coordinator: CoordinatorHandle,
    shown: usize,
    shutdown: CancellationToken,
    running: JoinHandle<anyhow::Result<()>>,
    /// Receivers that the coordinator would find gone otherwise.
    _ends: (mpsc::Receiver<Vec<EngineCommand>>, Box<dyn Send>),
}

impl Connector {
    async fn start(folder: &Path) -> anyhow::Result<Self> {
        let factory_id = FactoryId::new(FACTORY)?;
        let store = Store::open(folder, &factory_id, now()).await?;
        let (twin, handle) = new(folder)?;
        let (coordinator, commands) = coordinator::channel();
        let (mappings, mapping_work) = mpsc::channel(8);
        let (candidates, batches) = mpsc::channel(8);
        let it = Coordinator::new(
            CoordinatorConfig {
                state: StateConfig { factory_id, encoding: Encoding::default() },
                publishing_interval: Duration::from_millis(20),
                spool: SpoolLimits::default(),
                retention: RetentionLimits::default(),
                witness_wait: Duration::ZERO,
            },
            store,
            Outputs {
                twin: handle.clone(),
                mappings,
                link: None,
                keep_alives: Arc::default(),
                in_flight: Arc::default(),
                events: LiveEvents::new(1000, 1),
            },
            factory_connector::ledger_key::open(&folder.join("ledger-key.pem"))?,
            commands,
            batches,
        )
        .await?;
        let shutdown = CancellationToken::new();
        let token = shutdown.clone();
        let running = tokio::spawn(async move { it.run(token).await.map_err(anyhow::Error::from) });
        // The coordinator answers after it has published what it read.
        coordinator.read(|_| ()).await.context("asking the coordinator")?;
        let shown = handle.interfaces();
        Ok(Self {
            coordinator,
            shown,
            shutdown,
            running,
            _ends: (mapping_work, Box::new((candidates, twin))),
        })
    }

    async fn stop(self) -> anyhow::Result<()> {
        self.shutdown.cancel();
        self.running.await?
    }
}

fn delivery(network: usize) -> anyhow::Result<Delivery> {
    let id = uuid::Uuid::from_u128(network as u128).to_string().parse()?;
    Ok(Delivery {
        envelope: Envelope::new(id, "operation-network", text(network, FIELDS_PER_NETWORK)),
        is_redelivered: false,
        delivery_count: 0,
        received_at: OffsetDateTime::now_utc(),
    })
}
