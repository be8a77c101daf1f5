//! The process: a broker that does what the platform says over standard input.

use std::{io, sync::Arc};

use broker::{Broker, BrokerError, BrokerHandle, CredentialTable};
use daemon::telemetry::{self, Metrics, TelemetryError};
use tokio::{
    io::{AsyncWriteExt, BufReader, Stdout},
    signal::unix::{SignalKind, signal},
};
use tokio_util::sync::CancellationToken;

use super::lines::{BoundedLines, LINE_BYTES_MAX};
use super::wire::{self, Answer, BrokerRequest, Line, Order, Setup};

/// File of what is added to this process' score by which the kernel chooses.
const OOM_SCORE: &str = "/proc/self/oom_score_adj";
/// Half of all that can be added.
const OOM_SCORE_ADDED: i32 = 500;

/// The process of the broker ends without having been told to.
#[derive(Debug, thiserror::Error)]
pub enum SupervisedError {
    /// Standard input or output failed, or signals cannot be received.
    #[error("talking with the platform failed")]
    Talk(#[from] io::Error),
    /// A line is not one of the platform's.
    #[error(
        "a line of the platform is not understood; the command is meant for the platform itself"
    )]
    NotUnderstood(#[from] serde_json::Error),
    #[error("the platform has ended")]
    Orphaned,
    #[error("the platform named no address to listen on")]
    NoListener,
    #[error("the broker failed")]
    Broker(#[from] BrokerError),
    #[error("telemetry cannot be set up")]
    Telemetry(#[from] TelemetryError),
}

/// Serves until the platform says stop, or ends.
///
/// # Errors
/// [`SupervisedError`].
pub async fn run_supervised() -> Result<(), SupervisedError> {
    let offered = offer_to_the_kernel();
    ignore_signals()?;
    let mut lines = BoundedLines::new(BufReader::new(tokio::io::stdin()));
    let first = lines.next_line().await?.ok_or(SupervisedError::Orphaned)?;
    let setup: Setup = serde_json::from_str(&first)?;
    telemetry::install_logs(&setup.log)?;
    if let Err(error) = offered {
        tracing::warn!(%error, "The kernel may take the platform before its broker when memory is short.");
    }
    let metrics = Metrics::install()?;
    let config = setup.broker_config().ok_or(SupervisedError::NoListener)?;
    let users = Arc::new(CredentialTable::new());
    users.replace(wire::from_wire(setup.users));
    let credentials: Arc<CredentialTable> = Arc::clone(&users);
    let (broker, handle) = Broker::new(config, credentials).await?;
    let stop = CancellationToken::new();
    let mut running = tokio::spawn(broker.run(stop.clone()));
    tokio::spawn(metrics.clone().run(stop.clone()));
    let mut out = tokio::io::stdout();
    write(&mut out, &Line::Listening(handle.local_addresses().to_vec())).await?;
    loop {
        let line = tokio::select! {
            ended = &mut running => {
                ended.map_err(|_| BrokerError::Stopped)??;
                return Err(BrokerError::Stopped.into());
            }
            line = lines.next_line() => line?,
        };
        // At once: what was accepted is committed, and nobody is left to do anything for.
        let line = line.ok_or(SupervisedError::Orphaned)?;
        let Order { id, request } = serde_json::from_str(&line)?;
        if matches!(request, BrokerRequest::Stop) {
            stop.cancel();
            return Ok(running.await.map_err(|_| BrokerError::Stopped)??);
        }
        let answer = carry_out(&handle, &users, &metrics, request).await;
        write(&mut out, &Line::Answer { id, answer }).await?;
    }
}

async fn carry_out(
    handle: &BrokerHandle,
    users: &CredentialTable,
    metrics: &Metrics,
    request: BrokerRequest,
) -> Answer {
    let failed = |error: BrokerError| Answer::Failed(error.to_string());
    match request {
        BrokerRequest::SetUsers(all) => {
            users.replace(wire::from_wire(all));
            Answer::Done
        }
        BrokerRequest::DeclareQueue { queue, options } => {
            handle.declare_queue(&queue, options).await.map_or_else(failed, |()| Answer::Done)
        }
        BrokerRequest::DeleteQueue { queue } => match handle.delete_queue(&queue).await {
            Ok(messages) => Answer::Count(messages),
            Err(BrokerError::UnknownQueue { .. }) => Answer::Count(0),
            Err(error) => failed(error),
        },
        BrokerRequest::Disconnect { user_name } => {
            Answer::Count(handle.disconnect_user(&user_name) as u64)
        }
        BrokerRequest::Queues => Answer::Queues(handle.queues()),
        BrokerRequest::Connections => Answer::Connections(handle.connections()),
        BrokerRequest::Disk => Answer::Disk(handle.disk()),
        BrokerRequest::DeadLetters { after, limit } => {
            handle.dead_letters(after, limit).await.map_or_else(failed, Answer::DeadLetters)
        }
        BrokerRequest::ReplayDeadLetters { ids } => {
            handle.replay_dead_letters(&ids).await.map_or_else(failed, Answer::Count)
        }
        BrokerRequest::Metrics => Answer::Metrics(metrics.render()),
        BrokerRequest::Stop => Answer::Done,
    }
}

async fn write(out: &mut Stdout, line: &Line) -> Result<(), SupervisedError> {
    let mut text = serde_json::to_vec(line)?;
    if let Line::Answer { id, .. } = line
        && text.len() > LINE_BYTES_MAX
    {
        // The platform would take it for the end of this process.
        let answer = Answer::Failed("the answer is too long".to_owned());
        text = serde_json::to_vec(&Line::Answer { id: *id, answer })?;
    }
    text.push(b'\n');
    out.write_all(&text).await?;
    Ok(out.flush().await?)
}

/// Makes this process the one that the kernel ends first when memory is short: the pages outlive it, and
/// it is started again. Raising the score needs no right.
fn offer_to_the_kernel() -> io::Result<()> {
    let score = std::fs::read_to_string(OOM_SCORE)?;
    let is_higher = score.trim().parse().is_ok_and(|score: i32| score >= OOM_SCORE_ADDED);
    if is_higher { Ok(()) } else { std::fs::write(OOM_SCORE, OOM_SCORE_ADDED.to_string()) }
}

/// Leaves signals to the platform, which gets them as well and ends the broker last.
fn ignore_signals() -> io::Result<()> {
    for kind in [SignalKind::interrupt(), SignalKind::terminate()] {
        let mut signals = signal(kind)?;
        tokio::spawn(async move { while signals.recv().await.is_some() {} });
    }
    Ok(())
}
