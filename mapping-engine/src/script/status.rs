//! Workers of scripts with the walls around each, for the page of the status.

use std::{collections::BTreeMap, sync::Arc};

use parking_lot::Mutex;
use script_protocol::{Landlock, Sandbox};
use serde::Serialize;
use utoipa::ToSchema;

use super::config::ScriptConfig;

/// Scripts that a worker runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub enum WorkerPurpose {
    /// Scripts of published mappings.
    Mappings,
    /// Scripts that are tried on recorded values.
    DryRuns,
}

/// Worker process of scripts, running or refused.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct ScriptWorkerStatus {
    pub purpose: WorkerPurpose,
    /// Number among the workers of one purpose.
    pub number: usize,
    /// Name and version of the engine.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub engine: Option<String>,
    /// Walls around the process, as it reported them; none where it does not run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub walls: Option<WorkerWalls>,
    /// Reason for which it does not run; a sentence for people.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fault: Option<String>,
}

/// Walls around a worker process.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct WorkerWalls {
    /// True where the kernel filters its system calls.
    pub is_filtered: bool,
    /// Rules of Landlock that deny files, network and other processes.
    pub landlock: LandlockState,
    /// True where it runs as another user than the connector.
    pub has_own_user: bool,
    /// User that it runs as.
    pub user_id: u32,
    /// True where memory, files and processes are bounded.
    pub has_limits: bool,
}

/// Extent to which the kernel enforces the rules of Landlock.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub enum LandlockState {
    /// The kernel enforces none of them.
    None,
    /// Rules that an older kernel knows.
    Partial,
    /// All rules that workers ask for.
    Full,
}

impl WorkerWalls {
    /// Returns the walls of a report, seen by a host that runs as `host_user_id`.
    pub(super) const fn of(sandbox: &Sandbox, host_user_id: u32) -> Self {
        Self {
            is_filtered: sandbox.is_filtered,
            landlock: match sandbox.landlock {
                Landlock::None => LandlockState::None,
                Landlock::Partial => LandlockState::Partial,
                Landlock::Full => LandlockState::Full,
            },
            has_own_user: sandbox.user_id != host_user_id,
            user_id: sandbox.user_id,
            has_limits: sandbox.has_limits,
        }
    }
}

/// Returns why a worker with these walls gets no script; none where it may run.
pub(super) fn refusal(config: &ScriptConfig, walls: &WorkerWalls) -> Option<&'static str> {
    if config.require_filter && !walls.is_filtered {
        return Some(
            "scripts are not run: this kernel does not filter the system calls of their worker (seccomp); run the connector \
             where it does, or set mapping.script.requireFilter = false and trust every script like the connector itself",
        );
    }
    if walls.user_id == 0 && config.user_id != 0 {
        return Some(
            "scripts are not run: their worker runs as root; give it a user by mapping.script.userId, or set that to 0 and \
             trust every script like root itself",
        );
    }
    (!walls.has_limits)
        .then_some("scripts are not run: the system does not keep the bounds of their worker")
}

/// Status of all workers. Clones share it.
#[derive(Debug, Clone, Default)]
pub(crate) struct ScriptWorkers(Arc<Mutex<BTreeMap<(WorkerPurpose, usize), ScriptWorkerStatus>>>);

impl ScriptWorkers {
    /// Returns the status of those that were started, or tried to.
    pub(crate) fn list(&self) -> Vec<ScriptWorkerStatus> {
        self.0.lock().values().cloned().collect()
    }

    /// Returns the place of one worker.
    pub(crate) fn place(&self, purpose: WorkerPurpose, number: usize) -> WorkerPlace {
        WorkerPlace { workers: self.clone(), purpose, number }
    }
}

/// Place of one worker among all.
#[derive(Debug)]
pub(crate) struct WorkerPlace {
    workers: ScriptWorkers,
    purpose: WorkerPurpose,
    number: usize,
}

impl WorkerPlace {
    /// Notes that the worker runs.
    pub(super) fn runs(&self, engine: &str, walls: WorkerWalls) {
        self.set(Some(engine.to_owned()), Some(walls), None);
    }

    /// Notes that the worker does not run, and why.
    pub(super) fn failed(&self, fault: &str) {
        self.set(None, None, Some(fault.to_owned()));
    }

    fn set(&self, engine: Option<String>, walls: Option<WorkerWalls>, fault: Option<String>) {
        let Self { purpose, number, .. } = *self;
        let status = ScriptWorkerStatus { purpose, number, engine, walls, fault };
        self.workers.0.lock().insert((purpose, number), status);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn walls(is_filtered: bool, has_limits: bool) -> WorkerWalls {
        let (landlock, user_id) = (Landlock::None, 1000);
        WorkerWalls::of(&Sandbox { is_filtered, landlock, user_id, has_limits }, 1000)
    }

    #[test]
    fn without_a_filter_no_script_runs_unless_a_setting_says_so() {
        let strict = ScriptConfig { require_filter: true, ..ScriptConfig::default() };
        let lax = ScriptConfig { require_filter: false, ..ScriptConfig::default() };
        assert_eq!(refusal(&strict, &walls(true, true)), None);
        assert_eq!(refusal(&lax, &walls(false, true)), None);
        let refused = refusal(&strict, &walls(false, true)).expect("refused");
        assert!(refused.contains("mapping.script.requireFilter = false"), "{refused}");
        for config in [&strict, &lax] {
            assert!(refusal(config, &walls(true, false)).is_some(), "bounds hold in any case");
        }
        assert_eq!(ScriptConfig::default().require_filter, cfg!(target_os = "linux"));
    }

    #[test]
    fn as_root_no_script_runs_unless_a_setting_says_so() {
        let sandbox =
            Sandbox { is_filtered: true, landlock: Landlock::Full, user_id: 0, has_limits: true };
        let as_root = WorkerWalls::of(&sandbox, 0);
        let refused = refusal(&ScriptConfig::default(), &as_root).expect("refused");
        assert!(refused.contains("mapping.script.userId"), "{refused}");
        let lax = ScriptConfig { user_id: 0, ..ScriptConfig::default() };
        assert_eq!(refusal(&lax, &as_root), None);
    }

    #[test]
    fn a_worker_of_another_user_has_a_user_of_its_own() {
        let sandbox = Sandbox {
            is_filtered: true,
            landlock: Landlock::Full,
            user_id: 65_534,
            has_limits: true,
        };
        assert!(WorkerWalls::of(&sandbox, 0).has_own_user);
        assert!(!WorkerWalls::of(&sandbox, 65_534).has_own_user);
    }
}
