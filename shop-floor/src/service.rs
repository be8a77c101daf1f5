//! Service that runs one task per configured source.

use std::{collections::HashMap, sync::Arc, time::Duration};

use tokio::{sync::mpsc, task::JoinHandle};
use tokio_util::sync::CancellationToken;

use crate::{
    Config, InputChange, ShopFloorHandle, SourceConfig, SourceId, context::SourceContext,
    registry::SourceRegistry, source,
};

/// Interval at which configured and running sources are compared even without a notification.
const RECONCILE_INTERVAL: Duration = Duration::from_secs(2);

/// OPC UA client of a factory: keeps every configured source connected while it runs.
pub struct ShopFloor {
    context: Arc<SourceContext>,
    registry: Arc<SourceRegistry>,
}

/// Running task of a source, with the configuration it was started with.
struct SourceTask {
    config: SourceConfig,
    stop: CancellationToken,
    task: JoinHandle<()>,
}

impl ShopFloor {
    /// Returns the service, a handle to it, and the receiver of the changes of all monitored
    /// inputs.
    #[must_use]
    pub fn new(config: Config) -> (Self, ShopFloorHandle, mpsc::Receiver<Vec<InputChange>>) {
        let (context, changes) = SourceContext::new(config);
        let registry = Arc::new(SourceRegistry::new(Arc::clone(&context)));
        let handle = ShopFloorHandle::new(Arc::clone(&context), Arc::clone(&registry));
        (Self { context, registry }, handle, changes)
    }

    /// Runs until `shutdown` is cancelled; then closes all sessions.
    pub async fn run(self, shutdown: CancellationToken) {
        let queue = tokio::spawn({
            let (changes, shutdown) = (self.context.changes.clone(), shutdown.clone());
            async move { changes.run(shutdown).await }
        });
        let mut tasks = HashMap::new();
        loop {
            self.reconcile(&mut tasks).await;
            let held = u32::try_from(self.context.incoming.held_bytes()).unwrap_or(u32::MAX);
            metrics::gauge!("shop_floor_incoming_bytes").set(f64::from(held));
            tokio::select! {
                () = shutdown.cancelled() => break,
                () = self.registry.sources_changed() => {}
                // A task that ended in a panic is started again.
                () = tokio::time::sleep(RECONCILE_INTERVAL) => {}
            }
        }
        self.registry.stop();
        for source in tasks.values() {
            source.stop.cancel();
        }
        for (id, source) in tasks {
            join(&id, source.task).await;
        }
        // The queue returns no error; a panic in it is already on standard error.
        let _ = queue.await;
    }

    /// Stops tasks whose source was changed or removed, and starts those that are missing.
    async fn reconcile(&self, tasks: &mut HashMap<SourceId, SourceTask>) {
        let configured = self.registry.configured();
        let outdated: Vec<SourceId> = tasks
            .iter()
            .filter(|(id, running)| {
                running.task.is_finished()
                    || configured.get(*id).is_none_or(|(config, _)| *config != running.config)
            })
            .map(|(id, _)| id.clone())
            .collect();
        for id in outdated {
            if let Some(running) = tasks.remove(&id) {
                running.stop.cancel();
                join(&id, running.task).await;
            }
        }
        for (id, (config, record)) in configured {
            tasks.entry(id).or_insert_with(|| {
                let stop = CancellationToken::new();
                let context = Arc::clone(&self.context);
                let run = source::run(context, record, config.clone(), stop.clone());
                SourceTask { config, stop, task: tokio::spawn(run) }
            });
        }
    }
}

async fn join(id: &SourceId, task: JoinHandle<()>) {
    if let Err(error) = task.await {
        metrics::counter!("shop_floor_source_panics_total").increment(1);
        tracing::error!(source.id = %id, error = %error, "The task of a source ended in a panic.");
    }
}
