//! One running program: started, killed, restarted, never left behind.

use std::{
    fs::{File, OpenOptions},
    io,
    path::{Path, PathBuf},
    process::{Child, Command, ExitStatus, Stdio},
    time::{Duration, Instant},
};

use anyhow::Context as _;

/// Command line of a program, to start it again the same way.
#[derive(Debug, Clone)]
pub struct DaemonCommand {
    /// Name in messages and of its log file.
    pub name: String,
    pub program: PathBuf,
    pub arguments: Vec<String>,
    /// Further environment variables.
    pub environment: Vec<(String, String)>,
    /// File to which its output is appended.
    pub log: PathBuf,
}

/// A running program. Dropping it kills it; if this process dies first, the kernel does.
#[derive(Debug)]
pub struct Daemon {
    command: DaemonCommand,
    child: Child,
}

/// Finds a program of this workspace beside the running executable.
///
/// # Errors
/// When it was not built.
pub fn binary(name: &str) -> anyhow::Result<PathBuf> {
    let own = std::env::current_exe().context("finding the running executable")?;
    own.ancestors()
        .skip(1)
        .take(3)
        .map(|folder| folder.join(name))
        .find(|candidate| candidate.is_file())
        .with_context(|| {
            format!(
                "the program {name:?} was not built; run `cargo build --workspace --bins` first"
            )
        })
}

/// Kills the programs that run in a folder or below it, by whatever they were started.
///
/// # Errors
/// When Linux does not list its processes.
pub fn kill_started_in(folder: &Path) -> anyhow::Result<()> {
    for process in std::fs::read_dir("/proc").context("listing processes")?.flatten() {
        let is_there = std::fs::read_link(process.path().join("cwd"))
            .is_ok_and(|place| place.starts_with(folder));
        let id = process.file_name().to_str().and_then(|name| name.parse().ok());
        if let (true, Some(id)) = (is_there, id.and_then(rustix::process::Pid::from_raw)) {
            kill_child(id);
        }
    }
    Ok(())
}

impl Daemon {
    /// Starts the program.
    ///
    /// # Errors
    /// When the log cannot be opened or the program cannot be started.
    pub fn start(command: DaemonCommand) -> anyhow::Result<Self> {
        let child = spawn(&command).with_context(|| format!("starting {}", command.name))?;
        Ok(Self { command, child })
    }

    /// Name in messages.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.command.name
    }

    /// File to which its output is appended.
    #[must_use]
    pub fn log(&self) -> &Path {
        &self.command.log
    }

    /// Returns the process id.
    #[must_use]
    pub fn pid(&self) -> u32 {
        self.child.id()
    }

    /// Returns the exit status, if it has ended by itself.
    ///
    /// # Errors
    /// When the operating system does not say.
    pub fn ended(&mut self) -> io::Result<Option<ExitStatus>> {
        self.child.try_wait()
    }

    /// `kill -9` of it and of the programs that it has started, as the broker: no drain, no clean end.
    ///
    /// # Errors
    /// When the process cannot be killed or awaited.
    pub fn kill(&mut self) -> io::Result<()> {
        let family = self.children();
        self.child.kill()?;
        let ended = self.child.wait().map(|_| ());
        for child in family {
            kill_child(child);
        }
        ended
    }

    /// `kill -9` of the programs that it has started; it may start them again. Returns their number.
    pub fn kill_children(&self) -> usize {
        let family = self.children();
        family.iter().for_each(|child| kill_child(*child));
        family.len()
    }

    /// Returns the processes that it has started, as Linux lists them.
    fn children(&self) -> Vec<rustix::process::Pid> {
        let tasks = std::fs::read_dir(format!("/proc/{}/task", self.child.id()));
        let lists = tasks
            .into_iter()
            .flatten()
            .flatten()
            .filter_map(|task| std::fs::read_to_string(task.path().join("children")).ok());
        let ids = lists.flat_map(|list| {
            list.split_whitespace().filter_map(|id| id.parse().ok()).collect::<Vec<i32>>()
        });
        ids.filter_map(rustix::process::Pid::from_raw).collect()
    }

    /// Starts the same program again after it ended or was killed.
    ///
    /// # Errors
    /// As [`Self::start`].
    pub fn restart(&mut self) -> anyhow::Result<()> {
        self.kill().ok();
        self.child =
            spawn(&self.command).with_context(|| format!("restarting {}", self.command.name))?;
        Ok(())
    }

    /// Sets an environment variable from the next start on.
    pub fn set_environment(&mut self, name: &str, value: &str) {
        let environment = &mut self.command.environment;
        environment.retain(|(known, _)| known != name);
        environment.push((name.to_owned(), value.to_owned()));
    }

    /// Makes it stand still (SIGSTOP), or lets it go on (SIGCONT).
    ///
    /// # Errors
    /// When the process is gone.
    pub fn set_paused(&self, is_paused: bool) -> anyhow::Result<()> {
        let signal =
            if is_paused { rustix::process::Signal::STOP } else { rustix::process::Signal::CONT };
        Ok(rustix::process::kill_process(self.process()?, signal)?)
    }

    fn process(&self) -> anyhow::Result<rustix::process::Pid> {
        let id = i32::try_from(self.child.id()).ok().and_then(rustix::process::Pid::from_raw);
        id.context("a process id is never zero")
    }

    /// Asks it to stop (SIGTERM) and waits; kills it when the limit passes.
    ///
    /// # Errors
    /// When it had to be killed.
    pub fn stop(&mut self, limit: Duration) -> anyhow::Result<ExitStatus> {
        if let Some(status) = self.child.try_wait()? {
            return Ok(status);
        }
        rustix::process::kill_process(self.process()?, rustix::process::Signal::TERM)?;
        let deadline = Instant::now() + limit;
        while Instant::now() < deadline {
            if let Some(status) = self.child.try_wait()? {
                return Ok(status);
            }
            std::thread::sleep(Duration::from_millis(10));
        }
        self.kill()?;
        anyhow::bail!("{} did not stop within {limit:?} and was killed", self.command.name)
    }

    /// Returns the last lines of its log, for error messages.
    #[must_use]
    pub fn log_tail(&self, lines: usize) -> String {
        let text = std::fs::read_to_string(&self.command.log).unwrap_or_default();
        let all: Vec<&str> = text.lines().collect();
        all[all.len().saturating_sub(lines)..].join("\n")
    }
}

impl Drop for Daemon {
    fn drop(&mut self) {
        self.kill().ok();
    }
}

/// Kills a process of another one, and waits until it does nothing any more.
fn kill_child(child: rustix::process::Pid) {
    // Gone already, where this fails.
    rustix::process::kill_process(child, rustix::process::Signal::KILL).ok();
    let status = format!("/proc/{}/status", child.as_raw_nonzero());
    let runs = || {
        let text = std::fs::read_to_string(&status).unwrap_or_default();
        text.lines().any(|line| line.starts_with("State:") && !line.contains('Z'))
    };
    let deadline = Instant::now() + Duration::from_secs(5);
    while runs() && Instant::now() < deadline {
        std::thread::sleep(Duration::from_millis(1));
    }
}

fn spawn(command: &DaemonCommand) -> anyhow::Result<Child> {
    let log: File = OpenOptions::new()
        .create(true)
        .append(true)
        .open(&command.log)
        .with_context(|| format!("opening the log {}", command.log.display()))?;
    // The kernel kills the program when this process dies, however it dies.
    let child = Command::new("setpriv")
        .args(["--pdeathsig", "KILL", "--"])
        .arg(&command.program)
        .args(&command.arguments)
        .envs(command.environment.iter().cloned())
        .stdin(Stdio::null())
        .stdout(log.try_clone()?)
        .stderr(log)
        .spawn()?;
    Ok(child)
}
