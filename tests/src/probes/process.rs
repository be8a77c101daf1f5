//! Memory of a process and its time on processors, as Linux counts them.

use std::{fs, time::Duration};

use anyhow::Context as _;

/// Unit in which Linux counts the time of processors for programs.
const TICK_MILLIS: u64 = 10;

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

    /// Returns the time of processors that it has used since it began.
    pub(super) fn processor_time(self) -> anyhow::Result<Duration> {
        let stat = fs::read_to_string(format!("/proc/{}/stat", self.0))
            .context("reading the times of a process")?;
        processor_time_of(&stat).context("a process has times")
    }

    fn line(self, name: &str) -> anyhow::Result<u64> {
        let status = fs::read_to_string(format!("/proc/{}/status", self.0))
            .context("reading the memory of a process")?;
        let line = status.lines().find_map(|line| line.strip_prefix(name));
        let kilobytes = line.and_then(|line| line.split_whitespace().next()?.parse::<u64>().ok());
        Ok(kilobytes.context("a process has memory")? * 1024)
    }
}

/// Returns the time of processors in a line of `/proc/*/stat`: of the program, and of the kernel on its behalf.
pub(super) fn processor_time_of(stat: &str) -> Option<Duration> {
    // The name may have spaces. Behind it the state is the third field; the times are the 14th and the 15th.
    let (_, rest) = stat.rsplit_once(')')?;
    let mut times = rest.split_whitespace().skip(11).map(str::parse::<u64>);
    let ticks = times.next()?.ok()? + times.next()?.ok()?;
    Some(Duration::from_millis(ticks * TICK_MILLIS))
}

/// Returns whole mebibytes.
pub(super) const fn mib(bytes: u64) -> u64 {
    bytes >> 20
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_of_processors_are_read_behind_a_name_with_spaces() {
        let stat = "7 (an (odd) name) S 1 7 7 0 -1 4194560 1 2 3 4 250 50 0 0 20 0 1 0 100";
        assert_eq!(processor_time_of(stat), Some(Duration::from_secs(3)));
    }
}
