//! Memory and processor time of processes, as Linux counts them.

use std::fs;

use anyhow::Context as _;

/// Memory and processor time of processes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Usage {
    /// User and system time.
    pub cpu_seconds: f64,
    pub resident_bytes: u64,
}

impl Usage {
    /// Reads the usage of a process and those it started.
    pub fn of(process: u32) -> anyhow::Result<Self> {
        let own = Self::of_one(process)?;
        let mut sum = own;
        let tasks = fs::read_dir(format!("/proc/{process}/task"))
            .context("listing the tasks of a process")?;
        for task in tasks.flatten() {
            let children = fs::read_to_string(task.path().join("children")).unwrap_or_default();
            for child in children.split_whitespace().filter_map(|child| child.parse().ok()) {
                let Ok(child) = Self::of_one(child) else { continue };
                sum.cpu_seconds += child.cpu_seconds;
                sum.resident_bytes += child.resident_bytes;
            }
        }
        Ok(sum)
    }

    /// Reads the usage of a process alone.
    pub fn of_one(process: u32) -> anyhow::Result<Self> {
        let stat = fs::read_to_string(format!("/proc/{process}/stat"))
            .context("reading the times of a process")?;
        // The name may contain anything; what follows its closing parenthesis is numbers.
        let (_, rest) = stat.rsplit_once(')').context("a process has a name")?;
        let numbers: Vec<&str> = rest.split_whitespace().collect();
        let number = |index: usize| {
            numbers.get(index).and_then(|text| text.parse::<u64>().ok()).unwrap_or_default()
        };
        // Linux counts user and system time in hundredths of seconds, and memory in pages of 4096
        // bytes.
        let ticks = number(11) + number(12);
        Ok(Self { cpu_seconds: ticks as f64 / 100.0, resident_bytes: number(21) * 4096 })
    }
}
