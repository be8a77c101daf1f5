//! Clocks that jump: programs run under libfaketime, which adds what a file says to the time of
//! day.

use std::path::{Path, PathBuf};

use anyhow::Context as _;

use super::plan::ClockOffset;
use crate::harness::Daemon;

/// The clock of one program.
#[derive(Debug)]
pub struct Clock {
    file: PathBuf,
    offset: ClockOffset,
}

impl Clock {
    /// Gives a program a clock of its own, from its next start on. Without the library the clock
    /// never jumps.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn of(daemon: &mut Daemon, folder: &Path) -> anyhow::Result<Option<Self>> {
        let Some(library) = library() else { return Ok(None) };
        let file = folder.join(format!("{}.clock", daemon.name()));
        let clock = Self { file, offset: ClockOffset(0) };
        clock.write(clock.offset)?;
        daemon.set_environment("LD_PRELOAD", &library.display().to_string());
        daemon.set_environment("FAKETIME_TIMESTAMP_FILE", &clock.file.display().to_string());
        daemon.set_environment("FAKETIME_CACHE_DURATION", "1");
        // What measures spans goes on evenly, as it does on a machine whose time of day is set.
        daemon.set_environment("FAKETIME_DONT_FAKE_MONOTONIC", "1");
        daemon.set_environment("FAKETIME_DONT_RESET", "1");
        Ok(Some(clock))
    }

    /// Lets it jump; the program sees it within a second. Returns by how many seconds.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn set(&mut self, offset: ClockOffset) -> anyhow::Result<i32> {
        self.write(offset)?;
        Ok(offset.0 - std::mem::replace(&mut self.offset, offset).0)
    }

    /// True for a program that was started with the library.
    pub fn is_followed_by(daemon: &Daemon) -> bool {
        // A program that has just been started is still the one that starts it.
        let has_library = |file: &str| {
            let text = std::fs::read(format!("/proc/{}/{file}", daemon.pid())).unwrap_or_default();
            String::from_utf8_lossy(&text).contains("libfaketime")
        };
        has_library("maps") || has_library("environ")
    }

    fn write(&self, offset: ClockOffset) -> anyhow::Result<()> {
        // Replaced in one go: a file read half written would be another time.
        let next = self.file.with_extension("next");
        std::fs::write(&next, format!("{:+}\n", offset.0))
            .with_context(|| format!("writing {}", next.display()))?;
        std::fs::rename(&next, &self.file)
            .with_context(|| format!("writing {}", self.file.display()))
    }
}

fn library() -> Option<PathBuf> {
    let folders = std::fs::read_dir("/usr/lib").ok()?;
    folders
        .flatten()
        .map(|folder| folder.path().join("faketime/libfaketime.so.1"))
        .find(|file| file.is_file())
}
