//! Supervision: connects, serves the connection, and reconnects after every failure.

use std::{sync::Arc, time::Duration};

use tokio_util::sync::CancellationToken;
use tracing::{info, warn};

use super::{
    backoff::Backoff, consumers::Consumers, context::LinkContext, sender::Sender, state::LinkPhase,
};
use crate::{
    clock,
    config::LinkConfig,
    inbox::Inbox,
    spool::SpoolStore,
    transport::{Connection, ConnectionFault, Transport},
};

/// Time limit of the inbox to finish its batch when the connection ends.
const INBOX_GRACE: Duration = Duration::from_secs(30);

/// A link with its dependencies.
pub(super) struct Supervisor {
    pub config: LinkConfig,
    pub transport: Box<dyn Transport>,
    pub store: Arc<dyn SpoolStore>,
    pub inbox: Arc<dyn Inbox>,
    pub context: Arc<LinkContext>,
}

impl Supervisor {
    pub(super) async fn run(self, shutdown: CancellationToken) {
        let limits = self.config.limits;
        let mut backoff =
            Backoff::new(limits.backoff_min, limits.backoff_max, limits.backoff_permanent);
        let mut attempts = 0;
        while !shutdown.is_cancelled() {
            let broker = &self.config.brokers[attempts % self.config.brokers.len()];
            attempts += 1;
            let name = broker.to_string();
            // Not within the call: the borrow would lock the state against the change.
            let reason = self.context.state.borrow().reason.clone();
            self.context.enter(LinkPhase::Connecting, &name, reason);
            let connecting = tokio::select! {
                () = shutdown.cancelled() => break,
                connected = self.transport.connect(broker) => connected,
            };
            let fault = match connecting {
                Ok(connection) => {
                    info!(broker = name, "The link is up.");
                    // Before the sender starts: it must not send on what held for the connection
                    // before.
                    self.store.connected();
                    self.context.enter(LinkPhase::Up, &name, None);
                    let up_since = tokio::time::Instant::now();
                    let fault = self.serve(Arc::from(connection), &shutdown).await;
                    if self.context.has_data_flowed() || up_since.elapsed() > limits.backoff_max {
                        backoff.reset();
                        // The same broker first: it worked.
                        attempts -= 1;
                    }
                    fault
                }
                Err(fault) => fault,
            };
            if shutdown.is_cancelled() {
                break;
            }
            self.pause(&name, fault, &mut backoff, &shutdown).await;
        }
        let broker = self.context.state.borrow().broker.clone();
        self.context.enter(LinkPhase::Stopped, &broker, None);
    }

    async fn pause(
        &self,
        broker: &str,
        fault: ConnectionFault,
        backoff: &mut Backoff,
        shutdown: &CancellationToken,
    ) {
        let (fault, pause) = match self.context.take_backoff() {
            Some((reason, pause)) => (ConnectionFault::permanent(reason), pause),
            None => {
                let pause = backoff.after_failure(fault.is_permanent, rand::random());
                (fault, pause)
            }
        };
        let pause_ms = u64::try_from(pause.as_millis()).unwrap_or(u64::MAX);
        warn!(
            broker,
            reason = fault.reason,
            permanent = fault.is_permanent,
            pause_ms,
            "The link is down."
        );
        metrics::counter!("link_failures_total", "kind" => if fault.is_permanent { "permanent" } else { "passing" })
            .increment(1);
        let phase =
            LinkPhase::Down { retry_at: clock::now() + pause, is_permanent: fault.is_permanent };
        self.context.enter(phase, broker, Some(fault.reason));
        // For pages alone: the link goes on without the number.
        if let Ok(backlog) = self.store.backlog().await {
            self.context.set_backlog(backlog);
        }
        tokio::select! {
            () = shutdown.cancelled() => {}
            () = self.context.reconnect.notified() => {}
            () = tokio::time::sleep(pause) => {}
        }
    }

    /// Sends and receives until the connection is lost or the link is shut down.
    async fn serve(
        &self,
        connection: Arc<dyn Connection>,
        shutdown: &CancellationToken,
    ) -> ConnectionFault {
        let stop = shutdown.child_token();
        let (stalls, mut stalled) = tokio::sync::mpsc::channel(1);
        let consumers = Consumers {
            connection: Arc::clone(&connection),
            inbox: Arc::clone(&self.inbox),
            context: Arc::clone(&self.context),
            profile: self.config.profile.clone(),
            limits: self.config.limits,
            stalls: stalls.clone(),
            stop: stop.clone(),
        };
        let sender = Sender::new(
            Arc::clone(&connection),
            Arc::clone(&self.store),
            Arc::clone(&self.context),
            self.config.profile.clone(),
            self.config.limits,
            stalls,
        );
        let mut consuming = tokio::spawn(consumers.run());
        let mut sending = tokio::spawn(sender.run(stop.clone()));
        let fault = tokio::select! {
            fault = connection.lost() => fault,
            Some(reason) = stalled.recv() => ConnectionFault::transient(reason),
            () = shutdown.cancelled() => ConnectionFault::transient("shut down"),
            () = self.context.backoff_requested() => ConnectionFault::transient("a pause was requested"),
            // Both tasks run until they are stopped, so one that ends before has panicked.
            _ = &mut consuming => ConnectionFault::transient("receiving failed unexpectedly"),
            _ = &mut sending => ConnectionFault::transient("sending failed unexpectedly"),
        };
        stop.cancel();
        // The sender first: outcomes resolve only when the endpoints are dropped.
        finish(sending, INBOX_GRACE).await;
        // The inbox may be committing; its settlements still reach the broker.
        finish(consuming, INBOX_GRACE).await;
        connection.close().await;
        fault
    }
}

async fn finish(mut task: tokio::task::JoinHandle<()>, grace: Duration) {
    if task.is_finished() {
        return;
    }
    if tokio::time::timeout(grace, &mut task).await.is_err() {
        warn!("A task of the link did not stop in time. It is aborted.");
        task.abort();
    }
}
