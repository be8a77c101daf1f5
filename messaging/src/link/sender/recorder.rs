//! Recording of outcomes in the store, many in one transaction, while sending goes on.

use std::{sync::Arc, time::Duration};

use tokio::{sync::mpsc, task::JoinHandle};
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

/// Running recorder, as the sender of a connection has it.
pub(super) struct Recording {
    outcomes: mpsc::UnboundedSender<RowOutcome>,
    recorded: mpsc::UnboundedReceiver<Vec<RowId>>,
    task: JoinHandle<()>,
}

impl Recording {
    /// Starts the recorder's task.
    pub(super) fn start(store: Arc<dyn SpoolStore>, context: Arc<LinkContext>) -> Self {
        let (outcomes, received) = mpsc::unbounded_channel();
        let (sender, recorded) = mpsc::unbounded_channel();
        let recorder = Recorder { store, context, outcomes: received, recorded: sender };
        Self { outcomes, recorded, task: tokio::spawn(recorder.run()) }
    }

    /// Queues an outcome.
    pub(super) fn put(&self, outcome: RowOutcome) {
        // The recorder ends after this sender alone.
        let _ = self.outcomes.send(outcome);
    }

    /// Waits for the next group that was recorded, and returns its rows. May be cancelled.
    pub(super) async fn recorded(&mut self) -> Option<Vec<RowId>> {
        self.recorded.recv().await
    }

    /// Waits until everything is recorded.
    pub(super) async fn finish(self) {
        let Self { outcomes, task, .. } = self;
        // The recorder ends once it has recorded everything and no outcome can follow.
        drop(outcomes);
        let _ = task.await;
    }
}

/// Records outcomes. The channels need no bound of their own: the sender has at most twice its
/// window of rows open, and those that a broker has not stored yet.
struct Recorder {
    store: Arc<dyn SpoolStore>,
    context: Arc<LinkContext>,
    outcomes: mpsc::UnboundedReceiver<RowOutcome>,
    recorded: mpsc::UnboundedSender<Vec<RowId>>,
}

impl Recorder {
    /// Runs until the sender is dropped and everything is recorded.
    async fn run(mut self) {
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
