//! Recording of outcomes in the store, many in one transaction, while sending goes on.

use std::{sync::Arc, time::Duration};

use tokio::sync::mpsc;
use tracing::error;

use crate::{
    link::context::LinkContext,
    spool::{RowId, RowOutcome, SpoolStore},
};

/// Most outcomes in one transaction.
const GROUP_MAX: usize = 500;
/// Attempts to record a group. Rows of a group that was never recorded are sent again later.
const ATTEMPTS_MAX: u32 = 10;
/// Pause between two attempts.
const RETRY: Duration = Duration::from_millis(500);

/// Records outcomes. The channels need no bound of their own: the sender has at most twice its
/// window of rows open.
pub(super) struct Recorder {
    store: Arc<dyn SpoolStore>,
    context: Arc<LinkContext>,
    outcomes: mpsc::UnboundedReceiver<RowOutcome>,
    recorded: mpsc::UnboundedSender<Vec<RowId>>,
}

impl Recorder {
    pub(super) fn new(
        store: Arc<dyn SpoolStore>,
        context: Arc<LinkContext>,
    ) -> (Self, mpsc::UnboundedSender<RowOutcome>, mpsc::UnboundedReceiver<Vec<RowId>>) {
        let (sender, outcomes) = mpsc::unbounded_channel();
        let (recorded, ids) = mpsc::unbounded_channel();
        (Self { store, context, outcomes, recorded }, sender, ids)
    }

    /// Runs until the sender is dropped and everything is recorded.
    pub(super) async fn run(mut self) {
        let mut group = Vec::with_capacity(GROUP_MAX);
        while self.outcomes.recv_many(&mut group, GROUP_MAX).await > 0 {
            let ids = group.iter().map(|outcome| outcome.id).collect();
            self.record(std::mem::take(&mut group)).await;
            // Even where it failed: the rows are closed, read again and sent again.
            let _ = self.recorded.send(ids);
        }
    }

    async fn record(&self, group: Vec<RowOutcome>) {
        for attempt in 1..=ATTEMPTS_MAX {
            match self.store.record(group.clone()).await {
                Ok(()) => {
                    if attempt > 1 {
                        self.context.clear_obstacle("recording outcomes");
                    }
                    return;
                }
                Err(problem) => {
                    error!(error = %problem, rows = group.len(), attempt, "Outcomes cannot be recorded.");
                    self.context.report_obstacle("recording outcomes", problem.to_string());
                }
            }
            // The link stops: the rows are sent again later, and the receiver recognises them by
            // their ids.
            if self.outcomes.is_closed() {
                return;
            }
            tokio::time::sleep(RETRY).await;
        }
    }
}
