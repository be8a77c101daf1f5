//! Programs that end by themselves and are started again, as a supervisor does; how all of them end in the end.

use std::{path::Path, process::ExitStatus, time::Duration};

use super::Stage;
use crate::{
    chaos::{disk, disturbances},
    frame_order::{HAMBURG, MUNICH},
    harness::say,
};

/// Time after a full disk in which its program may still give up.
const END_AFTER_FULL_DISK: Duration = Duration::from_secs(30);
/// Exit codes of a program that gives up and says why: an error, or tasks that did not end in time.
const CODES: [i32; 2] = [1, 2];
/// Time in which a program stops that was asked to.
const STOPS_WITHIN: Duration = Duration::from_secs(15);
/// Lines at the end of a log among which a program that gave up says why.
const LAST_LINES: usize = 40;
/// Words of a panic in a log.
const PANICKED: &str = "panicked at";
/// Words of a connector's log where a worker of scripts is gone before it has answered.
const WORKER_LOST: &str = "A script worker was lost";
/// Words of such a line where the worker was killed for its silence, as on a machine with too much to do.
const WORKER_SILENT: &str = "did not answer in time";

impl Stage {
    /// Starts what has ended by itself. A program may give up where its disk is full, and a while after, where it says
    /// that this is why; its supervisor starts it again. Otherwise that is a fault.
    pub fn supervise(&mut self) -> anyhow::Result<()> {
        let since = std::mem::replace(&mut self.supervised_at, disturbances::now());
        let mut ends = Vec::new();
        for daemon in self.world.daemons() {
            let Some(status) = daemon.ended()? else { continue };
            let name = daemon.name().to_owned();
            say(&format!("    {name} ended by itself with {status}:\n{}", daemon.log_tail(6)));
            ends.push((name, status, daemon.log().to_owned(), daemon.log_tail(LAST_LINES)));
            daemon.restart()?;
        }
        for (name, status, log, last_lines) in ends {
            self.ended += 1;
            let whose = name.strip_prefix("connector-").unwrap_or(&name);
            let is_for_its_disk =
                self.is_disk_felt(whose, &log) && last_lines.lines().any(disk::complains);
            self.faults.extend(ended_by_itself(&name, status, is_for_its_disk));
            self.interruptions.go_on();
            for factory in [MUNICH, HAMBURG] {
                if name.ends_with(factory) {
                    self.disturbed.ended(factory, since);
                }
            }
        }
        self.supervise_broker()
    }

    /// True where a disk was full a moment ago, and its program has complained of it since, in this log.
    pub(super) fn is_disk_felt(&self, whose: &str, log: &Path) -> bool {
        self.filled.get(whose).is_some_and(|filled| {
            filled.until.elapsed() < END_AFTER_FULL_DISK
                && disk::complaints(log) > filled.complaints
        })
    }

    /// Stops everything in good order, and notes what did not run until then, did not end well, or panicked on the way.
    ///
    /// # Errors
    /// When a program had to be killed; the others are stopped all the same.
    pub fn stop(&mut self) -> anyhow::Result<()> {
        let are_machines_stopped = self.machines_stopped.is_some();
        let mut failed = Vec::new();
        self.supervise_broker()?;
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
            let log = String::from_utf8_lossy(&log);
            self.faults.extend(panics(&name, &log));
            self.faults.extend(lost_workers(&name, &log));
        }
        anyhow::ensure!(failed.is_empty(), "{}", failed.join("; "));
        Ok(())
    }
}

/// True for a program that runs until everything stops: the machines stop before.
fn is_checked(name: &str) -> bool {
    name == "platform" || name.starts_with("connector-")
}

fn ended_by_itself(name: &str, status: ExitStatus, is_for_its_disk: bool) -> Option<String> {
    let gave_up = status.code().is_some_and(|code| CODES.contains(&code));
    (!is_for_its_disk || !gave_up).then(|| format!("{name} ended by itself with {status}"))
}

fn stopped(name: &str, status: ExitStatus) -> Option<String> {
    (!status.success()).then(|| format!("{name} ended with {status} when it was asked to stop"))
}

/// Returns the panics in a log. A task that panics may be made again as if nothing had been.
fn panics(name: &str, log: &str) -> Vec<String> {
    let lines = log.lines().filter(|line| line.contains(PANICKED));
    lines.map(|line| format!("the log of {name} says that it panicked: {line}")).collect()
}

/// Returns where a log says that a worker of scripts ended by itself: chaos kills workers with their connector alone.
fn lost_workers(name: &str, log: &str) -> Vec<String> {
    let lines =
        log.lines().filter(|line| line.contains(WORKER_LOST) && !line.contains(WORKER_SILENT));
    lines.map(|line| format!("the log of {name} says that scripts lost a worker: {line}")).collect()
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
        let is_fault = |wait_status, is_for_its_disk| {
            let status = ExitStatus::from_raw(wait_status);
            ended_by_itself("platform", status, is_for_its_disk).is_some()
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

    #[test]
    fn a_worker_that_ends_is_a_fault_and_one_that_is_slow_is_none() {
        let lost = |error: &str| format!("WARN A script worker was lost. error={error}\n");
        assert_eq!(lost_workers("a", &lost("the script worker ended")).len(), 1);
        let slow = lost("the script worker did not answer in time");
        assert_eq!(lost_workers("a", &slow), [""; 0]);
        assert_eq!(lost_workers("a", "INFO A script worker has started.\n"), [""; 0]);
    }
}
