//! Attackers: on machines of their own wherever there is a real siege, here beside those that they attack.

use std::{fs, time::Duration};

use anyhow::Context as _;
use tokio::{
    runtime::{Builder, Handle, Runtime},
    task::JoinSet,
};

use crate::probes::process::processor_time_of;

/// Name of their threads.
const NAME: &str = "attacker";
/// Least priority that Linux knows. The processors that attackers of a real siege use are their own: so they take what
/// those leave that are under siege, and never what these need.
const LEAST_PRIORITY: i32 = 19;

/// All attackers. They have threads of their own: those that measure honest requests do nothing else, since one
/// that waits behind ten thousand attackers in the measuring program says nothing of those that are attacked.
pub(super) struct Attackers {
    /// Empty once they have left.
    runtime: Option<Runtime>,
    tasks: JoinSet<()>,
}

impl Attackers {
    /// Starts their threads, which have no attack yet.
    ///
    /// # Errors
    /// When the system gives no threads.
    pub fn gather() -> anyhow::Result<Self> {
        let runtime = Builder::new_multi_thread()
            .worker_threads(2)
            .thread_name(NAME)
            .on_thread_start(|| {
                // Of this thread alone, as Linux takes it.
                rustix::process::setpriority_process(None, LEAST_PRIORITY).ok();
            })
            .enable_all()
            .build()
            .context("threads of attackers")?;
        Ok(Self { runtime: Some(runtime), tasks: JoinSet::new() })
    }

    /// Lets one attack go on beside all others.
    pub fn spawn(&mut self, attack: impl Future<Output = ()> + Send + 'static) {
        if let Some(runtime) = &self.runtime {
            self.tasks.spawn_on(attack, runtime.handle());
        }
    }

    /// Runs what attackers need before they begin where they will go on.
    pub async fn prepare<T: Send + 'static>(
        &self,
        what: impl Future<Output = T> + Send + 'static,
    ) -> anyhow::Result<T> {
        let handle = self.runtime.as_ref().map_or_else(Handle::current, |all| all.handle().clone());
        handle.spawn(what).await.context("preparation of an attack")
    }

    /// Returns what an attack ended with that should go on.
    pub fn ended(&mut self) -> Option<String> {
        self.tasks.try_join_next().map(|ended| format!("a part of the siege ended: {ended:?}"))
    }

    /// Returns the time of processors that they have used so far.
    pub fn processor_time(&self) -> Duration {
        let threads = fs::read_dir("/proc/self/task").into_iter().flatten().flatten();
        let stats =
            threads.filter_map(|thread| fs::read_to_string(thread.path().join("stat")).ok());
        let name = format!("({NAME})");
        let of_attackers = stats.filter(|stat| stat.contains(&name));
        of_attackers.filter_map(|stat| processor_time_of(&stat)).sum()
    }

    /// Ends all attacks.
    pub async fn leave(mut self) {
        self.tasks.shutdown().await;
    }
}

impl Drop for Attackers {
    fn drop(&mut self) {
        // One that waits for its end must not do so in a task.
        if let Some(runtime) = self.runtime.take() {
            runtime.shutdown_background();
        }
    }
}
