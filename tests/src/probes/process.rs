//! Memory of a process, as Linux counts it.

use std::fs;

use anyhow::Context as _;

/// Memory of a process.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Memory(u32);

impl Memory {
    pub(super) const fn of(process: u32) -> Self {
        Self(process)
    }

    /// Returns that of the process which another one started first.
    pub(super) fn of_child(parent: u32) -> anyhow::Result<Self> {
        let child = Self::of(parent).children()?.into_iter().min_by_key(|child| child.0);
        child.context("the process has started none")
    }

    /// Returns those of the processes that it has started, as Linux lists them.
    pub(super) fn children(self) -> anyhow::Result<Vec<Self>> {
        let tasks = fs::read_dir(format!("/proc/{}/task", self.0))
            .context("listing the tasks of a process")?;
        let lists = tasks
            .flatten()
            .filter_map(|task| fs::read_to_string(task.path().join("children")).ok());
        let ids = |list: String| -> Vec<u32> {
            list.split_whitespace().filter_map(|id| id.parse().ok()).collect()
        };
        Ok(lists.flat_map(ids).map(Self).collect())
    }

    /// Returns the name of the program.
    pub(super) fn program(self) -> anyhow::Result<String> {
        let name = fs::read_to_string(format!("/proc/{}/comm", self.0)).context("a program")?;
        Ok(name.trim().to_owned())
    }

    /// Returns the most addresses that it had since it began, whether it used the memory or not: what is
    /// allocated and never written is not in [`Self::peak`].
    pub(super) fn addresses(self) -> anyhow::Result<u64> {
        self.line("VmPeak:")
    }

    /// Forgets the greatest amount so far.
    pub(super) fn reset_peak(self) -> anyhow::Result<()> {
        fs::write(format!("/proc/{}/clear_refs", self.0), "5")
            .context("forgetting the peak of a process")
    }

    /// Returns what is in memory now, in bytes.
    pub(super) fn resident(self) -> anyhow::Result<u64> {
        self.line("VmRSS:")
    }

    /// Returns the most that was in memory since [`Self::reset_peak`], in bytes.
    pub(super) fn peak(self) -> anyhow::Result<u64> {
        self.line("VmHWM:")
    }

    fn line(self, name: &str) -> anyhow::Result<u64> {
        let status = fs::read_to_string(format!("/proc/{}/status", self.0))
            .context("reading the memory of a process")?;
        let line = status.lines().find_map(|line| line.strip_prefix(name));
        let kilobytes = line.and_then(|line| line.split_whitespace().next()?.parse::<u64>().ok());
        Ok(kilobytes.context("a process has memory")? * 1024)
    }
}

/// Returns whole mebibytes.
pub(super) const fn mib(bytes: u64) -> u64 {
    bytes >> 20
}
