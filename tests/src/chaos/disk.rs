//! A disk of its own for a connector's data, which can be full.

use std::{
    path::{Path, PathBuf},
    process::Command,
    time::{Duration, Instant},
};

use anyhow::Context as _;

use crate::harness::Deadline;

/// Size of the file system; memory is only taken for what is written.
const SIZE: &str = "2g";

/// Time after which a disk is given free though its program did not notice that it was full.
const FELT_WITHIN: Duration = Duration::from_secs(10);

/// A mounted file system in memory; unmounted when dropped. Mounting needs root.
#[derive(Debug)]
pub struct Disk {
    folder: PathBuf,
}

/// Disk that was full, and is free again.
#[derive(Debug, Clone, Copy)]
pub(super) struct FilledDisk {
    /// Time at which it was given free.
    pub until: Instant,
    /// Number of complaints in its program's log before it was full.
    pub complaints: usize,
}

impl Disk {
    /// Mounts one on a folder.
    ///
    /// # Errors
    /// When this user may not mount.
    pub fn mount(folder: &Path) -> anyhow::Result<Self> {
        std::fs::create_dir_all(folder)?;
        let options = format!("size={SIZE},mode=0700");
        run(Command::new("mount")
            .args(["-t", "tmpfs", "-o", &options, "verbund-chaos"])
            .arg(folder))?;
        Ok(Self { folder: folder.to_owned() })
    }

    /// Leaves no room beyond what is written.
    ///
    /// # Errors
    /// When the file system cannot be changed.
    pub fn fill(&self) -> anyhow::Result<()> {
        // Blocks are taken while this looks: a size below what is used is refused, so a little more
        // is left each time.
        let mut failed = None;
        for spare in [0, 16, 64, 256] {
            let blocks = used_blocks(&self.folder)? + spare;
            match run(Command::new("mount")
                .arg("-o")
                .arg(format!("remount,nr_blocks={blocks}"))
                .arg(&self.folder))
            {
                Ok(()) => return Ok(()),
                Err(error) => failed = Some(error),
            }
        }
        failed.map_or(Ok(()), Err)
    }

    /// Leaves no room for a while, and on until the program says so that has this log. A store that has room in its own
    /// files notices late. Returns whether it noticed.
    ///
    /// # Errors
    /// When the file system cannot be changed.
    pub async fn fill_until_felt(&self, log: &Path, span: Duration) -> anyhow::Result<bool> {
        let before = complaints(log);
        self.fill()?;
        tokio::time::sleep(span).await;
        let deadline = Deadline::after(FELT_WITHIN.saturating_sub(span));
        while complaints(log) == before && !deadline.has_passed() {
            // What was given back meanwhile is taken again.
            self.fill().ok();
            tokio::time::sleep(Duration::from_millis(100)).await;
        }
        Ok(complaints(log) > before)
    }

    /// Gives the room back.
    ///
    /// # Errors
    /// When the file system cannot be changed.
    pub fn free(&self) -> anyhow::Result<()> {
        run(Command::new("mount").arg("-o").arg(format!("remount,size={SIZE}")).arg(&self.folder))
    }
}

impl Drop for Disk {
    fn drop(&mut self) {
        // Lazily: a killed program's files may still be open for a moment.
        run(Command::new("umount").arg("-l").arg(&self.folder)).ok();
    }
}

/// Words by which programs say that their disk is full.
const COMPLAINTS: [&str; 3] = ["disk is full", "disk I/O error", "No space left"];

/// Returns the number of lines of a log that complain about a full disk.
pub(super) fn complaints(log: &Path) -> usize {
    let text = std::fs::read(log).unwrap_or_default();
    String::from_utf8_lossy(&text).lines().filter(|line| complains(line)).count()
}

/// True for a line of a log that complains about a full disk.
pub(super) fn complains(line: &str) -> bool {
    COMPLAINTS.iter().any(|words| line.contains(words))
}

fn used_blocks(folder: &Path) -> anyhow::Result<u64> {
    let now = rustix::fs::statvfs(folder).context("looking at the file system")?;
    Ok(now.f_blocks - now.f_bfree)
}

fn run(command: &mut Command) -> anyhow::Result<()> {
    let output = command.output().with_context(|| format!("running {command:?}"))?;
    anyhow::ensure!(
        output.status.success(),
        "{command:?}: {}",
        String::from_utf8_lossy(&output.stderr).trim()
    );
    Ok(())
}
