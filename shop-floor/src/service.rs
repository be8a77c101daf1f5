//! The component: it keeps one task per configured source, and the registry that callers talk to.

use std::{collections::HashMap, sync::Arc, time::Duration};

use indexmap::IndexMap;
use parking_lot::RwLock;
use tokio::{
    sync::{Notify, mpsc, watch},
    task::JoinHandle,
};
use tokio_util::sync::CancellationToken;

use crate::{
    Config, InputChange, InputKey, ShopFloorHandle, SourceConfig, SourceId,
    certificates::CertificateShelf,
    outbox::Outbox,
    source::{self, Entry},
};

/// How often wanted and running sources are compared even when nobody says that something changed.
const RECONCILE_INTERVAL: Duration = Duration::from_secs(2);

/// The shop floor. See the crate's documentation.
pub struct ShopFloor {
    floor: Arc<Floor>,
}

/// What the handle, the component and the sources share.
pub(crate) struct Floor {
    pub(crate) config: Config,
    pub(crate) certificates: CertificateShelf,
    pub(crate) registry: RwLock<Registry>,
    /// Woken when a source was added, changed or removed.
    pub(crate) sources_changed: Notify,
    pub(crate) outbox: Outbox,
    /// Counts changes of any source's status.
    pub(crate) status_version: watch::Sender<u64>,
}

/// Who wants what from whom.
#[derive(Default)]
pub(crate) struct Registry {
    /// Every source that is configured or asked for.
    pub(crate) sources: IndexMap<SourceId, Arc<Entry>>,
    /// Where each input is monitored.
    pub(crate) inputs: HashMap<InputKey, SourceId>,
    pub(crate) is_stopped: bool,
}

impl Floor {
    pub(crate) fn status_has_changed(&self) {
        self.status_version.send_modify(|version| *version = version.wrapping_add(1));
    }
}

/// A source's task and the configuration it runs with.
struct Running {
    config: SourceConfig,
    stop: CancellationToken,
    task: JoinHandle<()>,
}

impl ShopFloor {
    /// The component, a handle to it, and the changes of all monitored inputs.
    #[must_use]
    pub fn new(config: Config) -> (Self, ShopFloorHandle, mpsc::Receiver<Vec<InputChange>>) {
        let (outbox, changes) = Outbox::new(config.waiting_batches_max);
        let floor = Arc::new(Floor {
            certificates: CertificateShelf::new(&config),
            config,
            registry: RwLock::default(),
            sources_changed: Notify::new(),
            outbox,
            status_version: watch::Sender::new(0),
        });
        (Self { floor: Arc::clone(&floor) }, ShopFloorHandle::new(floor), changes)
    }

    /// Runs until told to stop; then closes all sessions.
    pub async fn run(self, shutdown: CancellationToken) {
        let floor = self.floor;
        let outbox = tokio::spawn({
            let (outbox, shutdown) = (floor.outbox.clone(), shutdown.clone());
            async move { outbox.run(shutdown).await }
        });
        let mut running = HashMap::new();
        loop {
            reconcile(&floor, &mut running).await;
            tokio::select! {
                () = shutdown.cancelled() => break,
                () = floor.sources_changed.notified() => {}
                // A task that ended in a panic is started again.
                () = tokio::time::sleep(RECONCILE_INTERVAL) => {}
            }
        }
        floor.registry.write().is_stopped = true;
        for source in running.values() {
            source.stop.cancel();
        }
        for (id, source) in running {
            join(&id, source.task).await;
        }
        join_quietly(outbox).await;
    }
}

/// Starts, restarts and stops sources' tasks until they are as configured.
async fn reconcile(floor: &Arc<Floor>, running: &mut HashMap<SourceId, Running>) {
    let wanted: HashMap<SourceId, (SourceConfig, Arc<Entry>)> = floor
        .registry
        .read()
        .sources
        .iter()
        .filter_map(|(id, entry)| Some((id.clone(), (entry.config()?, Arc::clone(entry)))))
        .collect();
    let outdated: Vec<SourceId> = running
        .iter()
        .filter(|(id, source)| {
            source.task.is_finished()
                || wanted.get(*id).is_none_or(|(config, _)| *config != source.config)
        })
        .map(|(id, _)| id.clone())
        .collect();
    for id in outdated {
        if let Some(source) = running.remove(&id) {
            source.stop.cancel();
            join(&id, source.task).await;
        }
    }
    for (id, (config, entry)) in wanted {
        running.entry(id).or_insert_with(|| {
            let stop = CancellationToken::new();
            let task =
                tokio::spawn(source::run(Arc::clone(floor), entry, config.clone(), stop.clone()));
            Running { config, stop, task }
        });
    }
}

async fn join(id: &SourceId, task: JoinHandle<()>) {
    if let Err(error) = task.await {
        metrics::counter!("shop_floor_source_panics_total").increment(1);
        tracing::error!(source.id = %id, error = %error, "The task of a source ended in a panic.");
    }
}

async fn join_quietly(task: JoinHandle<()>) {
    // The outbox has nothing that may fail; a panic there is already on standard error.
    let _ = task.await;
}
