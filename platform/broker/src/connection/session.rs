//! Sessions of a connection and the links attached in them.

use std::{
    sync::{Arc, OnceLock},
    time::Duration,
};

use fe2o3_amqp::{
    acceptor::{LinkAcceptor, LinkEndpoint, ListenerSessionHandle},
    types::{
        definitions::{self, AmqpError, ErrorCondition},
        performatives::Attach,
    },
};
use tokio::{
    sync::{OwnedSemaphorePermit, Semaphore},
    task::JoinSet,
    time::timeout,
};
use tokio_util::sync::CancellationToken;
use tracing::{debug, warn};

use crate::{
    amqp_error::amqp_error,
    core::Core,
    link::{self, Publisher},
    queue::Queue,
    shares::{Held, UserShare},
};

/// Frames that may wait for the tasks of a connection, of which a user has few.
pub(super) const FRAMES_PER_CONNECTION: usize = 256;
/// Frames that may wait for a session. A frame may have 64 KiB, so this times the sessions of a user is
/// what one can make wait.
pub(super) const FRAMES_PER_SESSION: usize = 64;
/// Frames that may wait for a link, likewise: as many as the largest message has.
const FRAMES_PER_LINK: usize = 32;
/// Time for a peer to answer a close.
pub(super) const CLOSE_TIMEOUT: Duration = Duration::from_secs(2);
/// Time for a peer to finish a begin or an attach.
pub(super) const ATTACH_TIMEOUT: Duration = Duration::from_secs(10);

/// Rights of one link: to be one of its connection, and one of its user and organisation.
type LinkPermit = (OwnedSemaphorePermit, Held);

/// Context shared by all links of one connection.
#[derive(Clone)]
pub(super) struct Peer {
    pub(super) core: Arc<Core>,
    pub(super) user_name: Arc<str>,
    /// One permit per byte of the user's messages that wait for their commit.
    pub(super) uncommitted: Arc<Semaphore>,
    /// Share of the user in sessions and links, over all its connections.
    pub(super) share: Arc<UserShare>,
    /// One permit per link of the connection.
    pub(super) links: Arc<Semaphore>,
    /// Cancelled to end the connection.
    pub(super) cut: CancellationToken,
    /// Error that the connection is closed with; the first one counts.
    pub(super) close_error: Arc<OnceLock<definitions::Error>>,
}

impl Peer {
    /// Ends the whole connection with an error.
    fn abort(&self, error: definitions::Error) {
        let _ = self.close_error.set(error);
        self.cut.cancel();
    }
}

/// Serves a session until the peer ends it or the connection is cut.
pub(super) async fn serve_session(peer: Peer, mut session: ListenerSessionHandle) {
    let mut links = JoinSet::new();
    loop {
        let attach = tokio::select! {
            () = peer.cut.cancelled() => break,
            Some(_) = links.join_next() => continue,
            attach = session.next_incoming_attach() => attach,
        };
        let Some(attach) = attach else { break };
        serve_attach(&peer, attach, &mut session, &mut links).await;
    }
    // Dropping the session ends its links, which then requeue what they have leased.
    drop(session);
    while links.join_next().await.is_some() {}
}

/// Ends a session for which user or organisation have no room.
pub(super) async fn refuse_session(peer: Peer, mut session: ListenerSessionHandle) {
    warn!(user = %peer.user_name, "a session is refused: the user or its organisation has too many");
    let error = amqp_error(
        AmqpError::ResourceLimitExceeded,
        "this user or its organisation has too many sessions",
    );
    let _ = timeout(CLOSE_TIMEOUT, session.end_with_error(error)).await;
}

async fn serve_attach(
    peer: &Peer,
    attach: Attach,
    session: &mut ListenerSessionHandle,
    links: &mut JoinSet<()>,
) {
    let permit = Arc::clone(&peer.links).try_acquire_owned();
    let authorised = match (permit, peer.share.link()) {
        (Ok(permit), Some(held)) => {
            let queue = link::authorise(&peer.core, &peer.user_name, &attach).await;
            queue.map(|queue| (queue, (permit, held)))
        }
        (Err(_), _) => {
            Err(amqp_error(AmqpError::ResourceLimitExceeded, "this connection has too many links"))
        }
        (_, None) => Err(amqp_error(
            AmqpError::ResourceLimitExceeded,
            "this user or its organisation has too many links",
        )),
    };
    // A refused link is attached all the same: AMQP has no other answer to an attach than an attach
    // that is closed with the error at once.
    let acceptor = LinkAcceptor::builder()
        .max_message_size(peer.core.config.limits.message_bytes_max)
        .buffer_size(FRAMES_PER_LINK)
        .build();
    let attached = timeout(ATTACH_TIMEOUT, acceptor.accept_incoming_attach(attach, session)).await;
    let endpoint = match attached {
        Ok(Ok(endpoint)) => endpoint,
        Ok(Err(problem)) => {
            debug!(user = %peer.user_name, ?problem, "a link could not be attached");
            // The library has not answered the peer, which would wait for ever.
            let reason = "the link could not be attached; its name must be unique in the session, \
                          in both directions";
            return peer.abort(amqp_error(AmqpError::NotAllowed, reason));
        }
        Err(_) => {
            let reason = "the link could not be attached in time";
            return peer.abort(amqp_error(AmqpError::InternalError, reason));
        }
    };
    match authorised {
        Ok((queue, permit)) => {
            links.spawn(serve_link(peer.clone(), queue, endpoint, permit));
        }
        Err(error) => {
            let reason = error.description.as_deref().unwrap_or_default();
            warn!(user = %peer.user_name, condition = ?error.condition, reason, "a link is refused");
            let label = refusal_label(&error.condition);
            metrics::counter!("broker_links_refused_total", "reason" => label).increment(1);
            links.spawn(close_refused(endpoint, error));
        }
    }
}

/// Returns the value of the metric label `reason` for a refused link.
fn refusal_label(condition: &ErrorCondition) -> &'static str {
    match condition {
        ErrorCondition::AmqpError(AmqpError::UnauthorizedAccess) => "rights",
        ErrorCondition::AmqpError(AmqpError::NotFound) => "unknown-queue",
        ErrorCondition::AmqpError(AmqpError::ResourceLimitExceeded) => "limit",
        ErrorCondition::AmqpError(AmqpError::NotImplemented) => "not-implemented",
        _ => "failed",
    }
}

async fn serve_link(peer: Peer, queue: Arc<Queue>, endpoint: LinkEndpoint, permit: LinkPermit) {
    let Peer { core, user_name, uncommitted, share, cut, .. } = peer;
    match endpoint {
        LinkEndpoint::Receiver(receiver) => {
            let publisher = Publisher { user_name, share, uncommitted };
            link::ingest(core, queue, publisher, receiver, cut).await;
        }
        LinkEndpoint::Sender(sender) => {
            link::dispatch(core, queue, share.unsettled(), sender, cut).await;
        }
    }
    drop(permit);
}

async fn close_refused(endpoint: LinkEndpoint, error: definitions::Error) {
    let closed = match endpoint {
        LinkEndpoint::Receiver(receiver) => {
            timeout(CLOSE_TIMEOUT, receiver.close_with_error(error)).await
        }
        LinkEndpoint::Sender(sender) => {
            timeout(CLOSE_TIMEOUT, sender.close_with_error(error)).await
        }
    };
    if let Ok(Err(problem)) = closed {
        debug!(?problem, "the peer did not acknowledge the refusal of a link");
    }
}
