//! One worker process from its start to its end.

use std::{
    io,
    os::unix::fs::PermissionsExt as _,
    path::{Path, PathBuf},
    process::Stdio,
    time::Duration,
};

use script_protocol::{
    HostMessage, PROTOCOL_VERSION, WorkerMessage,
    codec::DecodeError,
    frame::{self, HEADER_BYTES},
};
use tokio::{
    io::{AsyncReadExt as _, AsyncWriteExt as _},
    process::{Child, ChildStdin, ChildStdout, Command},
    time::{sleep, timeout},
};

use super::{
    config::ScriptConfig,
    status::{WorkerPlace, WorkerWalls, refusal},
};

/// Time that a worker has to answer the greeting.
const GREETING_BUDGET: Duration = Duration::from_secs(10);
/// Pauses before a program that is open for writing somewhere is started again, and their number.
const BUSY_PAUSE: Duration = Duration::from_millis(20);
const BUSY_PAUSES_MAX: u32 = 100;
/// Time in which the last words of a worker that has ended are read.
const LAST_WORDS_BUDGET: Duration = Duration::from_secs(1);
/// Longest last words that are read, in bytes.
const LAST_WORDS_BYTES_MAX: u64 = 64 << 10;
/// Longest part of them that is shown, in characters.
const SHOWN_MAX: usize = 500;

/// Failure to start a worker or to get its answer.
#[derive(Debug, thiserror::Error)]
pub(super) enum ProcessError {
    #[error("{0}")]
    NotFound(String),
    #[error("the script worker does not start")]
    Start(#[source] io::Error),
    /// Last words of a worker that ended before it got a script.
    #[error("the script worker does not start: {0}")]
    Unfit(String),
    /// The folder is closed to the user, or the kernel does not have it.
    #[error(
        "scripts are not run: user {user_id} may not run {}, and they do not run as root: let others read and run it and \
         its folders, or set mapping.script.userId to a user who may, or to 0 and trust every script like root itself",
        path.display()
    )]
    UserMayNot { user_id: u32, path: PathBuf, source: io::Error },
    #[error("the script worker speaks version {0} of the protocol, not {PROTOCOL_VERSION}")]
    Version(u16),
    #[error("the script worker ended")]
    Ended(#[source] io::Error),
    #[error("the script worker did not answer in time")]
    Silent,
    #[error("the script worker said something that is no message")]
    Nonsense(#[source] DecodeError),
    #[error("the script worker said something else than the answer")]
    Unexpected,
    #[error("{0}")]
    Refused(&'static str),
    #[error("a message to the script worker is too long")]
    TooLong(#[source] frame::FrameTooLong),
}

/// Worker process with the pipes to it.
#[derive(Debug)]
pub(super) struct Process {
    /// Killed when dropped.
    child: Child,
    input: ChildStdin,
    output: ChildStdout,
}

impl Process {
    /// Starts a worker, greets it and judges its walls.
    pub async fn start(config: &ScriptConfig, place: &WorkerPlace) -> Result<Self, ProcessError> {
        let path = config.find_worker().map_err(ProcessError::NotFound)?;
        let deno = config.find_deno().map_err(ProcessError::NotFound)?;
        // The worker starts in another folder.
        let path = std::path::absolute(path).map_err(ProcessError::Start)?;
        let deno = deno.map(std::path::absolute).transpose().map_err(ProcessError::Start)?;
        let deno = deno.as_deref();
        let host_user = rustix::process::geteuid();
        let own_user = (host_user.is_root() && config.user_id != 0).then_some(config.user_id);
        let spawned = match (spawn(&path, deno, own_user), own_user) {
            (Err(error), Some(_)) if error.kind() == io::ErrorKind::PermissionDenied => {
                spawn_copy(&path, deno, own_user).await
            }
            (spawned, _) => spawned,
        };
        let mut child = spawned.map_err(|source| match (own_user, source.kind()) {
            // Nothing runs as root instead.
            (Some(user_id), io::ErrorKind::PermissionDenied | io::ErrorKind::InvalidInput) => {
                ProcessError::UserMayNot { user_id, path, source }
            }
            _ => ProcessError::Start(source),
        })?;
        let (Some(input), Some(output)) = (child.stdin.take(), child.stdout.take()) else {
            return Err(ProcessError::Start(io::Error::other("its streams are not there")));
        };
        let mut process = Self { child, input, output };
        let hello = HostMessage::Hello { version: PROTOCOL_VERSION, limits: config.limits() };
        let greeted = match process.ask(&hello.encode(), GREETING_BUDGET).await {
            Ok(greeted) => greeted,
            Err(error) => return Err(process.unfit(error).await),
        };
        match greeted {
            WorkerMessage::Welcome { version: PROTOCOL_VERSION, engine, sandbox } => {
                let walls = WorkerWalls::of(&sandbox, host_user.as_raw());
                if let Some(refusal) = refusal(config, &walls) {
                    return Err(ProcessError::Refused(refusal));
                }
                tracing::info!(
                    script.engine = &*engine,
                    process.id = process.child.id(),
                    is_filtered = walls.is_filtered,
                    landlock = ?walls.landlock,
                    user.id = walls.user_id,
                    "A script worker has started."
                );
                if !walls.is_filtered {
                    tracing::warn!(
                        "Scripts run WITHOUT a filter of system calls, as mapping.script.requireFilter = false allows: a \
                         script that breaks its engine has the rights of its worker's user."
                    );
                }
                if walls.user_id == 0 {
                    tracing::warn!(
                        "Scripts run as ROOT, as mapping.script.userId = 0 allows: a script that breaks its engine has \
                         this machine."
                    );
                }
                place.runs(&engine, walls);
                Ok(process)
            }
            WorkerMessage::Welcome { version, .. } => Err(ProcessError::Version(version)),
            _ => Err(ProcessError::Unexpected),
        }
    }

    /// Sends a message that has no answer.
    pub async fn send(&mut self, message: &HostMessage) -> Result<(), ProcessError> {
        let bytes = frame::framed(&message.encode()).map_err(ProcessError::TooLong)?;
        self.input.write_all(&bytes).await.map_err(ProcessError::Ended)
    }

    /// Sends a message, as encoded, and waits for the answer.
    pub async fn ask(
        &mut self,
        message: &[u8],
        budget: Duration,
    ) -> Result<WorkerMessage, ProcessError> {
        let bytes = frame::framed(message).map_err(ProcessError::TooLong)?;
        let Self { input, output, .. } = self;
        let exchange = async {
            // A worker that overran still says so, though it no longer reads: so both at once, and
            // the answer counts.
            let (sent, answer) = tokio::join!(input.write_all(&bytes), receive(output));
            match answer {
                Err(ProcessError::Ended(error)) => {
                    Err(ProcessError::Ended(sent.err().unwrap_or(error)))
                }
                answer => answer,
            }
        };
        timeout(budget, exchange).await.unwrap_or(Err(ProcessError::Silent))
    }

    /// Kills the worker, waits for its end and returns its last words. Once it has run a script they may be that script's,
    /// so they get into no log.
    pub async fn kill(mut self) -> String {
        // The only failure is that it has ended already.
        let _ = self.child.kill().await;
        let mut words = Vec::new();
        if let Some(errors) = self.child.stderr.take() {
            let reading = async { errors.take(LAST_WORDS_BYTES_MAX).read_to_end(&mut words).await };
            // Where they do not end, another process holds their stream: what came counts.
            let _ = timeout(LAST_WORDS_BUDGET, reading).await;
        }
        String::from_utf8_lossy(&words).into_owned()
    }

    /// Ends a worker that did not answer the greeting. It got no script, so its last words are its own.
    async fn unfit(self, error: ProcessError) -> ProcessError {
        let words: String = self.kill().await.trim().chars().take(SHOWN_MAX).collect();
        if words.is_empty() { error } else { ProcessError::Unfit(words) }
    }
}

/// Starts the binary, as another user where one is given; that takes a root. `deno` is its parameter.
fn spawn(path: &Path, deno: Option<&Path>, user_id: Option<u32>) -> io::Result<Child> {
    let mut command = Command::new(path);
    command
        .args(deno)
        // The environment of a daemon may hold passwords.
        .env_clear()
        // Without a file to look up: dates are in UTC.
        .env("TZ", "UTC0")
        // Arenas reserve address space per thread.
        .env("MALLOC_ARENA_MAX", "1")
        // The connector's own may be closed to another user.
        .current_dir("/")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        // Read once it has ended, and logged only where no script has run.
        .stderr(Stdio::piped())
        .kill_on_drop(true);
    if let Some(id) = user_id {
        // Without supplementary groups, too: the library drops them where it changes the user.
        command.uid(id).gid(id);
    }
    command.spawn()
}

/// Starts a copy of the binary that every user may run: its own folders may be closed, as root's are. The copy is gone as
/// soon as it runs.
async fn spawn_copy(path: &Path, deno: Option<&Path>, user_id: Option<u32>) -> io::Result<Child> {
    let folder = tempfile::Builder::new().prefix("verbund-script-").tempdir()?;
    let copy = folder.path().join("worker");
    std::fs::copy(path, &copy)?;
    // Whatever the umask is.
    for open in [folder.path(), &copy] {
        std::fs::set_permissions(open, std::fs::Permissions::from_mode(0o755))?;
    }
    spawn_when_written(&copy, deno, user_id).await
}

/// Starts a binary that was written a moment ago. A process that another thread starts meanwhile has the file open, too,
/// until its own program runs; before that, the kernel refuses this one.
async fn spawn_when_written(
    path: &Path,
    deno: Option<&Path>,
    user_id: Option<u32>,
) -> io::Result<Child> {
    for _ in 0..BUSY_PAUSES_MAX {
        match spawn(path, deno, user_id) {
            Err(error) if error.kind() == io::ErrorKind::ExecutableFileBusy => {
                sleep(BUSY_PAUSE).await;
            }
            spawned => return spawned,
        }
    }
    spawn(path, deno, user_id)
}

async fn receive(output: &mut ChildStdout) -> Result<WorkerMessage, ProcessError> {
    let mut header = [0; HEADER_BYTES];
    output.read_exact(&mut header).await.map_err(ProcessError::Ended)?;
    let length = frame::body_length(header).map_err(ProcessError::TooLong)?;
    let mut body = vec![0; length];
    output.read_exact(&mut body).await.map_err(ProcessError::Ended)?;
    WorkerMessage::decode(&body).map_err(ProcessError::Nonsense)
}

#[cfg(test)]
mod tests {
    use std::{fs::File, io::Write as _};

    use super::*;

    #[tokio::test]
    async fn a_copy_that_is_open_for_writing_is_started_once_it_is_closed() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("worker");
        let mut file = File::create(&path).expect("made");
        file.write_all(b"#!/bin/sh\nexit 7\n").expect("written");
        file.set_permissions(std::fs::Permissions::from_mode(0o755)).expect("may be run");
        let started = spawn_when_written(&path, None, None);
        let written = async {
            sleep(BUSY_PAUSE * 3).await;
            drop(file);
        };
        let (started, ()) = tokio::join!(started, written);
        let status = started.expect("it starts").wait().await.expect("it ends");
        assert_eq!(status.code(), Some(7));
    }
}
