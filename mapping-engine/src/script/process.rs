//! One worker process from its start to its end.

use std::{io, process::Stdio, time::Duration};

use script_protocol::{
    HostMessage, PROTOCOL_VERSION, WorkerMessage,
    codec::DecodeError,
    frame::{self, HEADER_BYTES},
};
use tokio::{
    io::{AsyncReadExt as _, AsyncWriteExt as _},
    process::{Child, ChildStdin, ChildStdout, Command},
    time::timeout,
};

use super::config::ScriptConfig;

/// Time that a worker has to answer the greeting.
const GREETING_BUDGET: Duration = Duration::from_secs(10);

/// Failure to start a worker or to get its answer.
#[derive(Debug, thiserror::Error)]
pub(super) enum ProcessError {
    #[error("{0}")]
    NotFound(String),
    #[error("the script worker does not start")]
    Start(#[source] io::Error),
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
    /// Starts a worker and greets it.
    pub async fn start(config: &ScriptConfig) -> Result<Self, ProcessError> {
        let path = config.find_worker().map_err(ProcessError::NotFound)?;
        let mut child = Command::new(path)
            // The environment of a daemon may hold passwords.
            .env_clear()
            // Without a file to look up: dates are in UTC.
            .env("TZ", "UTC0")
            // Arenas reserve address space per thread.
            .env("MALLOC_ARENA_MAX", "1")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            // Nothing that a script causes gets into a log.
            .stderr(Stdio::null())
            .kill_on_drop(true)
            .spawn()
            .map_err(ProcessError::Start)?;
        let (Some(input), Some(output)) = (child.stdin.take(), child.stdout.take()) else {
            return Err(ProcessError::Start(io::Error::other("its streams are not there")));
        };
        let mut process = Self { child, input, output };
        let hello = HostMessage::Hello { version: PROTOCOL_VERSION, limits: config.limits() };
        match process.ask(&hello.encode(), GREETING_BUDGET).await? {
            WorkerMessage::Welcome { version: PROTOCOL_VERSION, engine, is_filtered } => {
                tracing::info!(
                    script.engine = &*engine,
                    process.id = process.child.id(),
                    is_filtered,
                    "A script worker has started."
                );
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

    /// Kills the worker and waits for its end.
    pub async fn kill(mut self) {
        // The only failure is that it has ended already.
        let _ = self.child.kill().await;
    }
}

async fn receive(output: &mut ChildStdout) -> Result<WorkerMessage, ProcessError> {
    let mut header = [0; HEADER_BYTES];
    output.read_exact(&mut header).await.map_err(ProcessError::Ended)?;
    let length = frame::body_length(header).map_err(ProcessError::TooLong)?;
    let mut body = vec![0; length];
    output.read_exact(&mut body).await.map_err(ProcessError::Ended)?;
    WorkerMessage::decode(&body).map_err(ProcessError::Nonsense)
}
