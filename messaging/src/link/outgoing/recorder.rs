//! Records outcomes in the store, many in one transaction, while sending goes on.

use std::{sync::Arc, time::Duration};

use tokio::sync::mpsc;
use tracing::error;

use crate::{
    link::shared::Shared,
    spool::{RowId, RowOutcome, SpoolStore},
};

/// Outcomes in one transaction.
const GROUP_MAX: usize = 500;
/// Attempts to record a group while the link goes on; what is not recorded is sent again later.
const ATTEMPTS_MAX: u32 = 10;
const RETRY: Duration = Duration::from_millis(500);

/// Records outcomes. The channels are not bounded by themselves: the pump keeps no more rows open
/// than twice its window.
pub(super) struct Recorder {
    store: Arc<dyn SpoolStore>,
    shared: Arc<Shared>,
    outcomes: mpsc::UnboundedReceiver<RowOutcome>,
    recorded: mpsc::UnboundedSender<Vec<RowId>>,
}

impl Recorder {
    pub(super) fn new(
        store: Arc<dyn SpoolStore>,
        shared: Arc<Shared>,
    ) -> (Self, mpsc::UnboundedSender<RowOutcome>, mpsc::UnboundedReceiver<Vec<RowId>>) {
        let (sender, outcomes) = mpsc::unbounded_channel();
        let (recorded, ids) = mpsc::unbounded_channel();
        (Self { store, shared, outcomes, recorded }, sender, ids)
    }

    /// Records until the pump is gone and everything is recorded.
    pub(super) async fn run(mut self) {
        let mut group = Vec::with_capacity(GROUP_MAX);
        while self.outcomes.recv_many(&mut group, GROUP_MAX).await > 0 {
            let ids = group.iter().map(|outcome| outcome.id).collect();
            self.record(std::mem::take(&mut group)).await;
            let _ = self.recorded.send(ids);
        }
    }

    async fn record(&self, group: Vec<RowOutcome>) {
        for attempt in 1..=ATTEMPTS_MAX {
            match self.store.record(group.clone()).await {
                Ok(()) => {
                    if attempt > 1 {
                        self.shared.hinder("recording outcomes", None);
                    }
                    return;
                }
                Err(problem) => {
                    error!(error = %problem, rows = group.len(), attempt, "outcomes cannot be recorded");
                    self.shared.hinder("recording outcomes", Some(problem.to_string()));
                }
            }
            if self.outcomes.is_closed() {
                return;
            }
            tokio::time::sleep(RETRY).await;
        }
    }
}
