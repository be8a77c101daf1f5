//! Supervision of the demo's programs: one that ends is started again.

use std::{
    collections::HashMap,
    process::ExitStatus,
    time::{Duration, Instant},
};

use crate::harness::Daemon;

/// A program that lives no longer has not really started.
const SHORT_LIFE: Duration = Duration::from_secs(5);
/// Short lives in a row after which a program is given up.
const SHORT_LIVES_MAX: u32 = 3;
/// Lines of the log that say why.
const LOG_LINES: usize = 20;

/// Lives of all programs.
#[derive(Debug)]
pub(super) struct Supervision {
    away: Duration,
    lives: HashMap<String, Life>,
}

#[derive(Debug)]
struct Life {
    started_at: Instant,
    ended_at: Option<Instant>,
    short_lives: u32,
}

/// Turn in the life of a program, by its name.
#[derive(Debug)]
pub(super) enum Turn {
    Ended { name: String, status: ExitStatus },
    Started { name: String, pid: u32 },
}

impl Supervision {
    /// Supervises programs; one that ends stays away for this long, so that the pages show it.
    pub(super) fn new(away: Duration) -> Self {
        Self { away, lives: HashMap::new() }
    }

    /// Looks at the programs and starts those again that have been away long enough.
    ///
    /// # Errors
    /// When a program cannot be started, or ends soon after each start.
    pub(super) fn look<'a>(
        &mut self,
        daemons: impl Iterator<Item = &'a mut Daemon>,
        now: Instant,
    ) -> anyhow::Result<Vec<Turn>> {
        let mut turns = Vec::new();
        for daemon in daemons {
            let name = daemon.name().to_owned();
            let life = self.lives.entry(name.clone()).or_insert(Life {
                started_at: now,
                ended_at: None,
                short_lives: 0,
            });
            let Some(status) = daemon.ended()? else { continue };
            match life.ended_at {
                None => {
                    let is_short = now - life.started_at < SHORT_LIFE;
                    life.short_lives = if is_short { life.short_lives + 1 } else { 0 };
                    if life.short_lives >= SHORT_LIVES_MAX {
                        let log = daemon.log_tail(LOG_LINES);
                        anyhow::bail!("{name} ends soon after each start, with {status}:\n{log}");
                    }
                    life.ended_at = Some(now);
                    turns.push(Turn::Ended { name, status });
                }
                Some(ended_at) if now - ended_at >= self.away => {
                    daemon.restart()?;
                    (life.started_at, life.ended_at) = (now, None);
                    turns.push(Turn::Started { name, pid: daemon.pid() });
                }
                Some(_) => {}
            }
        }
        Ok(turns)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::harness::{DaemonCommand, until};

    const AWAY: Duration = Duration::from_secs(15);

    fn daemon(folder: &tempfile::TempDir, program: &str, arguments: &[&str]) -> Daemon {
        Daemon::start(DaemonCommand {
            name: program.to_owned(),
            program: program.into(),
            arguments: arguments.iter().map(|&argument| argument.to_owned()).collect(),
            environment: Vec::new(),
            log: folder.path().join("log"),
        })
        .expect("it starts")
    }

    #[tokio::test]
    async fn a_program_that_was_killed_starts_again_after_a_while() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut sleeper = daemon(&folder, "sleep", &["60"]);
        let mut supervision = Supervision::new(AWAY);
        let start = Instant::now();
        let mut look = |sleeper: &mut Daemon, after: Duration| {
            supervision.look(std::iter::once(sleeper), start + after).expect("it is kept running")
        };
        assert!(look(&mut sleeper, Duration::ZERO).is_empty());
        let killed = sleeper.pid();
        sleeper.kill().expect("killed");
        let ended_at = Duration::from_secs(60);
        assert!(matches!(look(&mut sleeper, ended_at)[..], [Turn::Ended { .. }]));
        assert!(look(&mut sleeper, ended_at + AWAY / 2).is_empty());
        let turns = look(&mut sleeper, ended_at + AWAY);
        let [Turn::Started { pid, .. }] = turns[..] else { panic!("{turns:?}") };
        assert_ne!(pid, killed);
        assert!(look(&mut sleeper, ended_at + AWAY * 2).is_empty());
    }

    #[tokio::test]
    async fn a_program_that_never_comes_up_is_given_up_with_its_log() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut shell = daemon(&folder, "sh", &["-c", "echo the port is taken; exit 3"]);
        let mut supervision = Supervision::new(Duration::ZERO);
        let mut error = None;
        let gives_up = || {
            let looked = supervision.look(std::iter::once(&mut shell), Instant::now());
            error = looked.err();
            error.is_some()
        };
        until("it is given up", Duration::from_secs(20), gives_up)
            .await
            .expect("it ends each time");
        assert!(format!("{error:?}").contains("the port is taken"), "{error:?}");
    }
}
