//! Limits of scripts, and location of their workers.

use std::{path::PathBuf, time::Duration};

use script_protocol::ScriptLimits;
use serde::{Deserialize, Serialize};

/// User without rights on any system.
const NOBODY: u32 = 65_534;

/// JavaScript engine. Each is a worker binary of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ScriptRuntime {
    /// `script-quickjs`: small, starts in milliseconds.
    #[default]
    QuickJs,
    /// `script-deno`: V8, in the Deno executable of `denoPath`; or `script-deno-core`, where `workerPath` names it.
    Deno,
}

impl ScriptRuntime {
    /// The file name of the worker.
    #[must_use]
    pub const fn file_name(self) -> &'static str {
        match self {
            Self::QuickJs => "script-quickjs",
            Self::Deno => "script-deno",
        }
    }

    /// Memory that the engine reserves for its code and its threads and hardly uses.
    const fn reserved_bytes(self) -> u64 {
        match self {
            Self::QuickJs => 0,
            Self::Deno => 2 << 30,
        }
    }

    /// True where the engine survives none of its limits: the end of its process is then what a limit is, not a crash.
    pub(crate) const fn ends_at_limits(self) -> bool {
        match self {
            Self::QuickJs => false,
            Self::Deno => true,
        }
    }
}

/// Version that the worker is tested with, and pinned to in `script-deno/package.json`.
const DENO_VERSION: &str = "2.9.6";
/// Place of the Deno executable among the packages of npm.
const DENO_PACKAGE: &str = if cfg!(target_arch = "aarch64") {
    "node_modules/@deno/linux-arm64-glibc/deno"
} else {
    "node_modules/@deno/linux-x64-glibc/deno"
};

/// Limits of scripts and of their workers.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", default, deny_unknown_fields)]
pub struct ScriptConfig {
    pub engine: ScriptRuntime,
    /// The worker's binary; beside the running program where absent.
    pub worker_path: Option<PathBuf>,
    /// The Deno executable; the one of the npm package beside the running program where absent.
    pub deno_path: Option<PathBuf>,
    /// Run no script where the kernel does not filter the system calls of its worker.
    pub require_filter: bool,
    /// User that workers run as where the connector runs as root, `nobody` by default; without it no script runs. 0 for
    /// root itself.
    pub user_id: u32,
    /// Number of worker processes that share the scripts.
    pub workers: usize,
    /// Most scripts per worker.
    pub scripts_per_worker_max: usize,
    /// Computing time of one call, in milliseconds. What cannot be stopped is taken down at one and
    /// a half times that, with `deno` at once.
    pub call_budget_ms: u64,
    /// Memory of one script, in bytes.
    pub script_memory_bytes: u64,
    /// Address space of a worker, in bytes; with `deno` the memory that it may write to beside 2 GiB for V8, an eighth of
    /// both for the heap that its scripts share.
    pub address_space_bytes: u64,
    /// Number of calls in a row that used up time or memory after which a script's circuit opens.
    /// It opens at once for one that took its worker down.
    pub exhausted_in_a_row_max: u32,
    /// Time for which a script's circuit opens first, in seconds; each further time is twice as long,
    /// up to an hour.
    pub rest_s: u64,
}

impl Default for ScriptConfig {
    fn default() -> Self {
        Self {
            engine: ScriptRuntime::default(),
            worker_path: None,
            deno_path: None,
            require_filter: cfg!(target_os = "linux"),
            user_id: NOBODY,
            workers: 1,
            scripts_per_worker_max: 2000,
            call_budget_ms: 100,
            script_memory_bytes: 8 << 20,
            address_space_bytes: 2 << 30,
            exhausted_in_a_row_max: 5,
            rest_s: 30,
        }
    }
}

impl ScriptConfig {
    /// Stack of one script.
    const STACK_BYTES: u64 = 256 << 10;

    pub(crate) fn limits(&self) -> ScriptLimits {
        let call_budget = Duration::from_millis(self.call_budget_ms.max(1));
        ScriptLimits {
            script_memory_bytes: self.script_memory_bytes,
            script_stack_bytes: Self::STACK_BYTES,
            call_budget,
            overrun_budget: call_budget + call_budget / 2,
            batch_budget: call_budget,
            address_space_bytes: self
                .address_space_bytes
                .saturating_add(self.engine.reserved_bytes()),
        }
    }

    /// After so much time by the wall clock a worker that has not answered a batch is taken down.
    pub(crate) fn answer_budget(&self) -> Duration {
        Duration::from_millis(self.call_budget_ms.max(1)) * 32 + Duration::from_secs(1)
    }

    pub(crate) fn first_backoff(&self) -> Duration {
        Duration::from_secs(self.rest_s.max(1))
    }

    /// Finds the Deno executable; none for a worker that has its engine inside.
    ///
    /// # Errors
    /// A sentence with the places where it is not, and with the line that installs it.
    pub(crate) fn find_deno(&self) -> Result<Option<PathBuf>, String> {
        if self.engine != ScriptRuntime::Deno {
            return Ok(None);
        }
        if let Some(path) = &self.deno_path {
            let found = path.is_file().then(|| Some(path.clone()));
            return found.ok_or_else(|| format!("there is no Deno at {}", path.display()));
        }
        let program = std::env::current_exe()
            .map_err(|error| format!("this program's place is unknown: {error}"))?;
        let folder = program.parent().unwrap_or(&program);
        match folder.join(DENO_PACKAGE) {
            path if path.is_file() => Ok(Some(path)),
            _ if self.worker_path.is_some() => Ok(None),
            path => Err(format!(
                "there is no Deno at {}: run npm install --prefix {} --no-save --ignore-scripts deno@{DENO_VERSION}, or set \
                 mapping.script.denoPath",
                path.display(),
                folder.display()
            )),
        }
    }

    /// Finds the worker's binary.
    ///
    /// # Errors
    /// A sentence naming the places where it is not.
    pub(crate) fn find_worker(&self) -> Result<PathBuf, String> {
        let name = self.engine.file_name();
        if let Some(path) = &self.worker_path {
            let found = path.is_file().then(|| path.clone());
            return found.ok_or_else(|| format!("there is no script worker at {}", path.display()));
        }
        let program = std::env::current_exe()
            .map_err(|error| format!("this program's place is unknown: {error}"))?;
        let name = format!("{name}{}", std::env::consts::EXE_SUFFIX);
        // Beside the program; one level up for programs that cargo builds into a folder of their
        // own (tests, examples).
        let places = program.ancestors().skip(1).take(2).map(|folder| folder.join(&name));
        places.into_iter().find(|path| path.is_file()).ok_or_else(|| {
            format!("there is no {name} beside {}: set script.workerPath", program.display())
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_deno_to_install_is_the_one_that_is_tested() {
        let pinned = include_str!("../../script-deno/package.json");
        assert!(pinned.contains(&format!("\"deno\": \"{DENO_VERSION}\"")), "{pinned}");
    }

    #[test]
    fn a_deno_that_is_not_there_is_said_with_the_line_that_installs_it() {
        let deno = ScriptConfig { engine: ScriptRuntime::Deno, ..ScriptConfig::default() };
        let said = deno.find_deno().expect_err("tests have none beside them");
        assert!(said.contains("npm install --prefix") && said.contains("denoPath"), "{said}");
        let named = ScriptConfig { deno_path: Some("/nowhere/deno".into()), ..deno.clone() };
        let said = named.find_deno().expect_err("there is none");
        assert!(said.contains("/nowhere/deno"), "{said}");
        // A worker of one's own may have its engine inside, as the one with deno_core has.
        let own = ScriptConfig { worker_path: Some("/opt/script-deno-core".into()), ..deno };
        assert_eq!(own.find_deno(), Ok(None));
        assert_eq!(ScriptConfig::default().find_deno(), Ok(None));
    }
}
