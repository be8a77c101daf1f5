//! The life of a daemon: named tasks, one orderly end.
//!
//! The first SIGINT or SIGTERM asks every task to finish (the *soft* token) and gives them one
//! deadline together; a second signal, or the deadline, ends the process without waiting. A task
//! that ends before it was asked to says by its [`Importance`] whether the daemon can live without
//! it.

use std::{fmt, future::Future, process::ExitCode, sync::Arc, time::Duration};

use parking_lot::Mutex;
use tokio::signal::unix::{SignalKind, signal};
use tokio_util::{sync::CancellationToken, task::TaskTracker};
use tracing::{Instrument, error, info, info_span, warn};

/// Meaning of a task's end before the shutdown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Importance {
    /// The daemon is of no use without it: everything stops and the exit status is a failure.
    Essential,
    /// The daemon goes on without it; a failure is logged and counted.
    Optional,
}

/// Reason of an end that was not requested.
#[derive(Debug, thiserror::Error)]
pub enum LifecycleError {
    /// The operating system refused to deliver signals.
    #[error("cannot listen for signals")]
    ListenForSignals(#[source] std::io::Error),
    /// An essential task ended early.
    #[error("the task {task} ended: {reason}")]
    TaskEnded {
        task: &'static str,
        /// Error of the task with its chain of causes.
        reason: String,
    },
    /// Some tasks did not finish within the deadline, or a second signal came.
    #[error("stopped without waiting for {count} tasks")]
    Unfinished {
        /// Number of tasks that were still running.
        count: usize,
    },
}

impl LifecycleError {
    /// The exit status for service managers: 1 for a failed task, 2 for a forced stop.
    #[must_use]
    pub fn exit_code(&self) -> ExitCode {
        match self {
            Self::Unfinished { .. } => ExitCode::from(2),
            Self::ListenForSignals(_) | Self::TaskEnded { .. } => ExitCode::FAILURE,
        }
    }
}

/// Spawns the daemon's tasks and waits for its end. Clones share one life.
#[derive(Clone, Default)]
pub struct Lifecycle {
    tracker: TaskTracker,
    shutdown: CancellationToken,
    failure: Arc<Mutex<Option<LifecycleError>>>,
}

impl Lifecycle {
    /// A life in which nothing runs yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Cancelled once shutdown begins. Components take it as the argument of `run`.
    #[must_use]
    pub fn shutdown(&self) -> CancellationToken {
        self.shutdown.clone()
    }

    /// Starts a task under its name. Its panic counts as a failure and is contained.
    pub fn spawn<F, E>(&self, name: &'static str, importance: Importance, task: F)
    where
        F: Future<Output = Result<(), E>> + Send + 'static,
        E: Into<anyhow::Error> + Send + 'static,
    {
        let life = self.clone();
        self.tracker.spawn(
            async move {
                let result = tokio::spawn(task.in_current_span()).await;
                let outcome = match result {
                    Ok(Ok(())) => Ok(()),
                    Ok(Err(error)) => Err(format!("{:#}", error.into())),
                    Err(_) => Err("it panicked".to_owned()),
                };
                life.ended(name, importance, outcome);
            }
            .instrument(info_span!("task", task.name = name)),
        );
    }

    fn ended(&self, task: &'static str, importance: Importance, outcome: Result<(), String>) {
        if let Err(reason) = &outcome {
            metrics::counter!("verbund_task_failures_total", "task" => task).increment(1);
            error!(task.name = task, reason, "A task failed.");
        }
        if self.shutdown.is_cancelled() || importance == Importance::Optional {
            return;
        }
        let reason =
            outcome.err().unwrap_or_else(|| "it returned before it was asked to".to_owned());
        self.failure.lock().get_or_insert(LifecycleError::TaskEnded { task, reason });
        self.shutdown.cancel();
    }

    /// Asks all tasks to finish, as a signal would.
    pub fn stop(&self) {
        self.shutdown.cancel();
    }

    /// Waits for a signal or the failure of an essential task, then for the tasks, at most
    /// `drain_timeout`.
    ///
    /// # Errors
    /// [`LifecycleError`] when the daemon did not end as asked.
    pub async fn run(self, drain_timeout: Duration) -> Result<(), LifecycleError> {
        let mut signals = Signals::new().map_err(LifecycleError::ListenForSignals)?;
        tokio::select! {
            name = signals.next() => info!(signal = name, "Shutdown begins; a second signal stops at once."),
            () = self.shutdown.cancelled() => info!("Shutdown begins."),
        }
        self.shutdown.cancel();
        self.tracker.close();
        let is_forced = tokio::select! {
            () = self.tracker.wait() => false,
            name = signals.next() => { warn!(signal = name, "Stopping at once."); true }
            () = tokio::time::sleep(drain_timeout) => { warn!("The tasks did not finish in time."); true }
        };
        if let Some(failure) = self.failure.lock().take() {
            return Err(failure);
        }
        if is_forced {
            Err(LifecycleError::Unfinished { count: self.tracker.len() })
        } else {
            Ok(())
        }
    }

    /// Waits until every task has ended after [`Self::stop`]; for tests and commands that run a
    /// daemon inside.
    pub async fn finished(&self) {
        self.tracker.close();
        self.tracker.wait().await;
    }
}

impl fmt::Debug for Lifecycle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Lifecycle").field("tasks", &self.tracker.len()).finish_non_exhaustive()
    }
}

struct Signals {
    interrupt: tokio::signal::unix::Signal,
    terminate: tokio::signal::unix::Signal,
}

impl Signals {
    fn new() -> std::io::Result<Self> {
        Ok(Self {
            interrupt: signal(SignalKind::interrupt())?,
            terminate: signal(SignalKind::terminate())?,
        })
    }

    async fn next(&mut self) -> &'static str {
        tokio::select! {
            _ = self.interrupt.recv() => "SIGINT",
            _ = self.terminate.recv() => "SIGTERM",
        }
    }
}

#[cfg(test)]
mod tests {
    use std::convert::Infallible;

    use super::*;

    const SOON: Duration = Duration::from_secs(10);

    #[tokio::test]
    async fn tasks_are_awaited_after_stop() {
        let life = Lifecycle::new();
        let token = life.shutdown();
        let done = Arc::new(Mutex::new(false));
        let flag = Arc::clone(&done);
        life.spawn("worker", Importance::Essential, async move {
            token.cancelled().await;
            *flag.lock() = true;
            Ok::<(), Infallible>(())
        });
        life.stop();
        life.run(SOON).await.expect("an orderly end");
        assert!(*done.lock());
    }

    #[tokio::test]
    async fn an_essential_task_takes_the_daemon_with_it() {
        let life = Lifecycle::new();
        life.spawn("broker", Importance::Essential, async {
            Err::<(), _>(anyhow::anyhow!("the port is taken"))
        });
        let error = life.run(SOON).await.expect_err("the task failed");
        assert_eq!(error.to_string(), "the task broker ended: the port is taken");
    }

    #[tokio::test]
    async fn an_optional_task_does_not_and_panics_are_contained() {
        let life = Lifecycle::new();
        life.spawn("preview", Importance::Optional, async {
            assert!(std::hint::black_box(false), "a bug");
            Ok::<(), Infallible>(())
        });
        life.finished().await;
        assert!(!life.shutdown().is_cancelled());
        life.stop();
        life.run(SOON).await.expect("an orderly end");
    }

    #[tokio::test]
    async fn the_deadline_is_kept() {
        let life = Lifecycle::new();
        life.spawn("stuck", Importance::Essential, async {
            std::future::pending::<()>().await;
            Ok::<(), Infallible>(())
        });
        life.stop();
        let error = life.run(Duration::from_millis(20)).await.expect_err("the task never ends");
        assert!(matches!(error, LifecycleError::Unfinished { count: 1 }), "{error}");
    }
}
