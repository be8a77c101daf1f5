//! Programs that end by themselves, and are started again as a supervisor does.

use std::time::Duration;

use super::Stage;
use crate::{
    chaos::disturbances,
    frame_order::{HAMBURG, MUNICH},
    harness::say,
};

/// Time after a full disk in which its program may still give up.
const END_AFTER_FULL_DISK: Duration = Duration::from_secs(30);

impl Stage {
    /// Starts what has ended by itself. A program may give up where its disk is full, and a while after; its supervisor
    /// starts it again. Otherwise that is a fault.
    pub fn supervise(&mut self) -> anyhow::Result<()> {
        let since = std::mem::replace(&mut self.supervised_at, disturbances::now());
        for daemon in self.world.daemons() {
            let Some(status) = daemon.ended()? else { continue };
            let name = daemon.name().to_owned();
            say(&format!("    {name} ended by itself with {status}:\n{}", daemon.log_tail(6)));
            daemon.restart()?;
            self.ended += 1;
            let may_end = self.full_until.iter().any(|(whose, until)| {
                let is_its_disk = name == *whose || name == format!("connector-{whose}");
                is_its_disk && until.elapsed() < END_AFTER_FULL_DISK
            });
            if !may_end {
                self.faults.push(format!("{name} ended by itself with {status}"));
            }
            self.interruptions.go_on();
            for factory in [MUNICH, HAMBURG] {
                if name.ends_with(factory) {
                    self.disturbed.ended(factory, since);
                }
            }
        }
        Ok(())
    }
}
