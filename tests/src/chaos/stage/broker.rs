//! The broker's process: its ends, of which chaos causes some, and its store.

use std::{
    fs::File,
    io::{self, Read as _, Seek as _, SeekFrom},
    path::Path,
    time::Duration,
};

use super::Stage;
use crate::{
    chaos::{
        comments,
        plan::{Fault, PLATFORM},
        stores,
    },
    harness::Deadline,
};

/// Time in which a platform that was just started has its broker.
const BROKER_STARTS: Duration = Duration::from_secs(10);
/// Time in which the platform's log says that its broker has ended.
const LOGGED_WITHIN: Duration = Duration::from_secs(10);
/// Words of the platform's log at each end of its broker, but for those of the platform itself.
const ENDED: &str = "The broker has died";
/// Words of the platform's log where a broker ends before it listened for the first time.
const NOT_STARTED: &str = "The broker did not start";

/// Ends of the broker, as the platform's log has them.
#[derive(Debug, Default)]
pub(super) struct BrokerEnds {
    /// Bytes of the log that were read.
    read: u64,
    ended: u32,
    not_started: u32,
    /// Number of the ends that are accounted for.
    explained: u32,
}

impl BrokerEnds {
    /// Reads what the log says since it was read last.
    fn follow(&mut self, log: &Path) -> io::Result<()> {
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

    fn note(&mut self, text: &str) {
        for line in text.lines() {
            self.ended += u32::from(line.contains(ENDED));
            self.not_started += u32::from(line.contains(NOT_STARTED));
        }
    }

    /// Returns the fault where it ended more often than is accounted for; that is accounted for from now on.
    fn fault(&mut self) -> Option<String> {
        let more = self.ended.saturating_sub(self.explained);
        self.explained += more;
        (more > 0).then(|| format!("the broker's process has ended by itself, {more} times"))
    }
}

impl Stage {
    /// Notes where the broker has ended by itself. It may where its disk, the platform's, is full.
    pub(super) fn supervise_broker(&mut self) -> anyhow::Result<()> {
        self.broker_ends.follow(self.world.platform.log())?;
        if let Some(fault) = self.broker_ends.fault()
            && !self.is_disk_felt(PLATFORM, self.world.platform.log())
        {
            self.faults.push(fault);
        }
        Ok(())
    }

    /// Kills the broker alone, as soon as the platform has started it.
    pub(super) async fn kill_broker(&mut self) -> anyhow::Result<bool> {
        self.supervise_broker()?;
        let before = (self.broker_ends.ended, self.broker_ends.not_started);
        let deadline = Deadline::after(BROKER_STARTS);
        while self.world.platform.kill_children() == 0 {
            if deadline.has_passed() {
                return Ok(false);
            }
            tokio::time::sleep(Duration::from_millis(20)).await;
        }
        // A platform that is killed before it says so would leave room for an end that nobody caused.
        let deadline = Deadline::after(LOGGED_WITHIN);
        loop {
            self.broker_ends.follow(self.world.platform.log())?;
            let BrokerEnds { ended, not_started, .. } = self.broker_ends;
            if (ended, not_started) != before || deadline.has_passed() {
                // One that had not listened yet counts as none that has died.
                self.broker_ends.explained += u32::from(not_started == before.1);
                return Ok(true);
            }
            tokio::time::sleep(Duration::from_millis(20)).await;
        }
    }

    /// Lets the broker come back with another store.
    pub(super) async fn broker_store(&mut self, fault: Fault) -> anyhow::Result<()> {
        let folder = self.world.places.folder.clone();
        self.world.platform.kill()?;
        match fault {
            Fault::DoubleQueued => stores::double_queued(&folder).await?,
            _ => {
                let lost = self.unreceipted().await?;
                self.set_back.extend(lost);
                self.lost_controls.add(&folder).await?;
                self.lost_comments.extend(comments::on_the_way(&folder).await?);
                if fault == Fault::OldBrokerStore {
                    stores::exchange_broker_store(&folder)?;
                } else {
                    stores::remove_broker_store(&folder)?;
                }
            }
        }
        self.world.platform.restart()
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
        ends.note(DIED);
        ends.explained += 1;
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
        assert_eq!(ends.ended, 1);
        std::fs::write(&log, format!("{DIED}{first}{rest}")).expect("written");
        ends.follow(&log).expect("read");
        ends.follow(&log).expect("read");
        assert_eq!(ends.ended, 2);
    }
}
