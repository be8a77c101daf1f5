//! Programs that end by themselves and are started again, as a supervisor does; how all of them end in the end.

use std::{process::ExitStatus, time::Duration};

use super::Stage;
use crate::{
    chaos::disturbances,
    frame_order::{HAMBURG, MUNICH},
    harness::say,
};

/// Time after a full disk in which its program may still give up.
const END_AFTER_FULL_DISK: Duration = Duration::from_secs(30);
/// Exit codes of a program that gives up and says why: an error, or tasks that did not end in time.
const CODES: [i32; 2] = [1, 2];
/// Time in which a program stops that was asked to.
const STOPS_WITHIN: Duration = Duration::from_secs(15);
/// Words of a panic in a log.
const PANICKED: &str = "panicked at";

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
            let is_its_disk_full = self.full_until.iter().any(|(whose, until)| {
                let is_its_disk = name == *whose || name == format!("connector-{whose}");
                is_its_disk && until.elapsed() < END_AFTER_FULL_DISK
            });
            self.faults.extend(ended_by_itself(&name, status, is_its_disk_full));
            self.interruptions.go_on();
            for factory in [MUNICH, HAMBURG] {
                if name.ends_with(factory) {
                    self.disturbed.ended(factory, since);
                }
            }
        }
        Ok(())
    }

    /// Stops everything in good order, and notes what did not run until then, did not end well, or panicked on the way.
    ///
    /// # Errors
    /// When a program had to be killed; the others are stopped all the same.
    pub fn stop(&mut self) -> anyhow::Result<()> {
        let are_machines_stopped = self.machines_stopped.is_some();
        let mut failed = Vec::new();
        for daemon in self.world.daemons() {
            let name = daemon.name().to_owned();
            let is_stopped = are_machines_stopped && !is_checked(&name);
            let ended = daemon.ended()?.filter(|_| !is_stopped);
            self.faults.extend(ended.and_then(|status| ended_by_itself(&name, status, false)));
            match daemon.stop(STOPS_WITHIN) {
                Ok(status) if ended.is_none() => self.faults.extend(stopped(&name, status)),
                Ok(_) => {}
                Err(error) => failed.push(error.to_string()),
            }
            let log = std::fs::read(daemon.log())?;
            self.faults.extend(panics(&name, &String::from_utf8_lossy(&log)));
        }
        anyhow::ensure!(failed.is_empty(), "{}", failed.join("; "));
        Ok(())
    }
}

/// True for a program that runs until everything stops: the machines stop before.
fn is_checked(name: &str) -> bool {
    name == "platform" || name.starts_with("connector-")
}

fn ended_by_itself(name: &str, status: ExitStatus, is_its_disk_full: bool) -> Option<String> {
    let gave_up = status.code().is_some_and(|code| CODES.contains(&code));
    (!is_its_disk_full || !gave_up).then(|| format!("{name} ended by itself with {status}"))
}

fn stopped(name: &str, status: ExitStatus) -> Option<String> {
    (!status.success()).then(|| format!("{name} ended with {status} when it was asked to stop"))
}

/// Returns the panics in a log. A task that panics may be made again as if nothing had been.
fn panics(name: &str, log: &str) -> Vec<String> {
    let lines = log.lines().filter(|line| line.contains(PANICKED));
    lines.map(|line| format!("the log of {name} says that it panicked: {line}")).collect()
}

#[cfg(test)]
mod tests {
    use std::os::unix::process::ExitStatusExt as _;

    use super::*;

    const SUCCESS: i32 = 0;
    const ERROR: i32 = 1 << 8;
    const PANIC: i32 = 101 << 8;
    const SEGMENTATION_FAULT: i32 = 11;

    #[test]
    fn a_program_gives_up_with_an_error_and_for_a_full_disk_alone() {
        let is_fault = |wait_status, is_its_disk_full| {
            let status = ExitStatus::from_raw(wait_status);
            ended_by_itself("platform", status, is_its_disk_full).is_some()
        };
        assert!(!is_fault(ERROR, true));
        assert!(is_fault(ERROR, false));
        for wait_status in [SUCCESS, PANIC, SEGMENTATION_FAULT] {
            assert!(is_fault(wait_status, true), "{wait_status}");
        }
    }

    #[test]
    fn a_program_that_is_asked_to_stop_ends_without_an_error() {
        let fault = |wait_status| stopped("platform", ExitStatus::from_raw(wait_status));
        assert_eq!(fault(SUCCESS), None);
        for wait_status in [ERROR, PANIC, SEGMENTATION_FAULT] {
            assert!(fault(wait_status).is_some(), "{wait_status}");
        }
    }

    #[test]
    fn machines_alone_stop_before_everything_does() {
        assert!(is_checked("platform"));
        assert!(is_checked(&format!("connector-{MUNICH}")));
        assert!(!is_checked(&format!("machines-{MUNICH}")));
    }

    #[test]
    fn each_panic_of_a_log_is_a_fault() {
        let log = "{\"level\":\"INFO\"}\nthread 'a' (7) panicked at src/a.rs:1:2:\nno\n";
        assert_eq!(panics("platform", log).len(), 1);
        assert_eq!(panics("platform", "all is well\n"), [""; 0]);
    }
}
