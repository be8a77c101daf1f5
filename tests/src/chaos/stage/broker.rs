//! Ends of the broker's process that chaos causes, and its store.

use std::time::Duration;

use super::Stage;
use crate::{
    chaos::{
        comments,
        plan::{Fault, PLATFORM},
        set_back, stores,
    },
    harness::Deadline,
};

/// Time in which a platform that was just started has its broker.
const BROKER_STARTS: Duration = Duration::from_secs(10);
/// Time in which the platform's log says that its broker has ended.
const LOGGED_WITHIN: Duration = Duration::from_secs(10);

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
        let before = self.broker_ends.counts();
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
            if self.broker_ends.counts() != before || deadline.has_passed() {
                self.broker_ends.explain(before);
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
                let lost = set_back::with_the_store(&folder).await?;
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
