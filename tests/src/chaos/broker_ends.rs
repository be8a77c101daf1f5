//! Ends of the broker's process: the platform starts it, and starts it again.

use std::{
    fs::File,
    io::{self, Read as _, Seek as _, SeekFrom},
    path::Path,
};

/// Words of the platform's log at each end of its broker, but for those of the platform itself.
const ENDED: &str = "The broker has died";
/// Words of the platform's log where a broker ends before it listened for the first time.
const NOT_STARTED: &str = "The broker did not start";

/// Numbers of lines.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct BrokerCounts {
    ended: u32,
    not_started: u32,
}

/// Ends of the broker, as the platform's log has them.
#[derive(Debug, Default)]
pub(super) struct BrokerEnds {
    /// Bytes of the log that were read.
    read: u64,
    counts: BrokerCounts,
    /// Number of the ends that are accounted for.
    explained: u32,
}

impl BrokerEnds {
    /// Reads what the log says since it was read last.
    pub fn follow(&mut self, log: &Path) -> io::Result<()> {
        let mut file = File::open(log)?;
        file.seek(SeekFrom::Start(self.read))?;
        let mut text = Vec::new();
        file.read_to_end(&mut text)?;
        // The last line may be half written.
        let whole = text.iter().rposition(|byte| *byte == b'\n').map_or(0, |place| place + 1);
        text.truncate(whole);
        self.read += whole as u64;
        self.note(&String::from_utf8_lossy(&text));
        Ok(())
    }

    /// Returns what it has read so far.
    pub const fn counts(&self) -> BrokerCounts {
        self.counts
    }

    /// Accounts for one that was killed after `before`. One that had not listened yet counts as none that has died.
    pub fn explain(&mut self, before: BrokerCounts) {
        self.explained += u32::from(self.counts.not_started == before.not_started);
    }

    fn note(&mut self, text: &str) {
        for line in text.lines() {
            self.counts.ended += u32::from(line.contains(ENDED));
            self.counts.not_started += u32::from(line.contains(NOT_STARTED));
        }
    }

    /// Returns the fault where it ended more often than is accounted for; that is accounted for from now on.
    pub fn fault(&mut self) -> Option<String> {
        let more = self.counts.ended.saturating_sub(self.explained);
        self.explained += more;
        (more > 0).then(|| format!("the broker's process has ended by itself, {more} times"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DIED: &str = "{\"message\":\"The broker has died; it is started again.\"}\n";

    #[test]
    fn an_end_that_nobody_caused_is_a_fault_once() {
        let mut ends = BrokerEnds::default();
        ends.note("{\"message\":\"The link is up.\"}\n");
        assert_eq!(ends.fault(), None);
        let before = ends.counts();
        ends.note(DIED);
        ends.explain(before);
        assert_eq!(ends.fault(), None, "it was killed");
        ends.note(&DIED.repeat(2));
        assert!(ends.fault().is_some());
        assert_eq!(ends.fault(), None);
    }

    #[test]
    fn a_log_is_followed_by_whole_lines() {
        let folder = tempfile::tempdir().expect("a folder");
        let log = folder.path().join("platform.log");
        let mut ends = BrokerEnds::default();
        let (first, rest) = DIED.split_at(DIED.len() - 5);
        std::fs::write(&log, format!("{DIED}{first}")).expect("written");
        ends.follow(&log).expect("read");
        assert_eq!(ends.counts.ended, 1);
        std::fs::write(&log, format!("{DIED}{first}{rest}")).expect("written");
        ends.follow(&log).expect("read");
        ends.follow(&log).expect("read");
        assert_eq!(ends.counts.ended, 2);
    }
}
