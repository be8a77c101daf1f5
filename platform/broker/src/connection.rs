//! One AMQP connection: handshake, sign-in, sessions, close.

mod sasl;
mod session;
mod transport;

use std::{
    net::SocketAddr,
    sync::{Arc, OnceLock},
    time::Instant,
};

use fe2o3_amqp::{
    acceptor::{ConnectionAcceptor, ListenerConnectionHandle, SessionAcceptor},
    types::definitions::{AmqpError, ConnectionError},
};
use tokio::{sync::Semaphore, task::JoinSet, time::timeout};
use tokio_util::sync::CancellationToken;
use tracing::{debug, info, warn};

use self::{
    sasl::{SaslExchange, TOO_MANY_FAILURES},
    session::{
        ATTACH_TIMEOUT, CLOSE_TIMEOUT, FRAMES_PER_CONNECTION, FRAMES_PER_SESSION, Peer,
        refuse_session, serve_session,
    },
    transport::{Allowance, FRAME_BYTES_MAX, Measured},
};
use crate::{amqp_error::amqp_error, core::Core, waiting::Place};

pub(crate) use transport::{Accepted, Stream};

/// Bytes that a peer may send before it has signed in, those of TLS and of a WebSocket included.
/// Frames of SASL have at most 512 bytes.
const UNAUTHENTICATED_BYTES_MAX: u64 = 64 * 1024;
/// Transfers that a peer may have in flight in one session.
const SESSION_WINDOW: u32 = 4096;

/// Serves one accepted TCP connection to its end.
pub(crate) async fn serve(
    core: Arc<Core>,
    accepted: Accepted,
    place: Place,
    shutdown: CancellationToken,
) {
    let peer = accepted.peer;
    let allowance = Allowance::new(UNAUTHENTICATED_BYTES_MAX);
    let opening = accepted.open(allowance.clone());
    let sasl = SaslExchange::new(&core, Some(peer.ip()));
    serve_opening(core, peer, sasl, opening, allowance, place, shutdown).await;
}

/// Serves a peer over a stream that is open to its end. Its failed sign-ins are not counted, since it has
/// no address.
pub(crate) async fn serve_stream(
    core: Arc<Core>,
    stream: impl Stream,
    shutdown: CancellationToken,
) {
    let peer = SocketAddr::from(([127, 0, 0, 1], 0));
    let Ok(place) = core.waiting.enter(peer.ip(), Instant::now()) else { return };
    let allowance = Allowance::new(UNAUTHENTICATED_BYTES_MAX);
    let stream = Measured::new(stream, allowance.clone());
    let opening = async { Ok(Box::new(stream) as Box<dyn Stream>) };
    let sasl = SaslExchange::new(&core, None);
    serve_opening(core, peer, sasl, opening, allowance, place, shutdown).await;
}

async fn serve_opening(
    core: Arc<Core>,
    peer: SocketAddr,
    sasl: SaslExchange,
    opening: impl Future<Output = Result<Box<dyn Stream>, String>>,
    allowance: Allowance,
    place: Place,
    shutdown: CancellationToken,
) {
    let acceptor = ConnectionAcceptor::builder()
        .container_id("verbund-broker")
        .max_frame_size(FRAME_BYTES_MAX)
        .channel_max(core.config.limits.sessions_max)
        .buffer_size(FRAMES_PER_CONNECTION)
        .sasl_acceptor(sasl.clone())
        .build();
    // No idle timeout of our own: peers that send heartbeats only at the full period would be cut.
    // A dead peer is found by TCP keep-alive and by unacknowledged bytes.
    let handshake = async {
        let stream = opening.await?;
        acceptor.accept(stream).await.map_err(|e| e.to_string())
    };
    let opened = tokio::select! {
        () = shutdown.cancelled() => return,
        () = place.displaced.cancelled() => {
            count_failed_handshake("displaced");
            return info!(%peer, "a peer that had not signed in makes room for another");
        }
        opened = timeout(core.config.limits.handshake_timeout, handshake) => opened,
    };
    let connection = match opened {
        Ok(Ok(connection)) => connection,
        Ok(Err(reason)) => {
            let failure = sasl.failure();
            count_failed_handshake(failure);
            if failure == TOO_MANY_FAILURES {
                return warn!(%peer, "too many sign-ins from here have failed; further ones are refused for a while");
            }
            return info!(%peer, reason, "a peer did not complete the handshake");
        }
        Err(_) => {
            count_failed_handshake("timeout");
            return info!(%peer, "a peer took too long for the handshake");
        }
    };
    let Some(user_name) = sasl.user_name() else {
        return debug!(%peer, "a peer skipped SASL");
    };
    allowance.lift();
    drop(place);
    serve_signed_in(core, connection, peer, user_name, shutdown).await;
}

async fn serve_signed_in(
    core: Arc<Core>,
    mut connection: ListenerConnectionHandle,
    address: SocketAddr,
    user_name: Arc<str>,
    shutdown: CancellationToken,
) {
    let Some(registration) = core.register(&user_name, address, shutdown.child_token()) else {
        count_failed_handshake("too-many-connections");
        warn!(peer = %address, user = %user_name, "a user has too many connections; the new one is refused");
        let error =
            amqp_error(AmqpError::ResourceLimitExceeded, "this user has too many connections");
        let _ = timeout(CLOSE_TIMEOUT, connection.close_with_error(error)).await;
        return;
    };
    info!(peer = %address, user = %user_name, "a peer signed in");
    metrics::gauge!("broker_connections").increment(1.0);
    let peer = Peer {
        links: Arc::new(Semaphore::new(core.config.limits.links_max)),
        core,
        user_name: Arc::clone(&user_name),
        uncommitted: Arc::clone(&registration.uncommitted),
        share: Arc::clone(&registration.share),
        cut: registration.cut.clone(),
        close_error: Arc::new(OnceLock::new()),
    };
    let mut sessions = JoinSet::new();
    let is_closing = serve_sessions(&peer, &mut connection, &mut sessions).await;
    // Ends the links, also where the peer has closed: what they have leased goes to others.
    peer.cut.cancel();
    if is_closing {
        let error = peer.close_error.get().cloned().unwrap_or_else(|| {
            amqp_error(ConnectionError::ConnectionForced, "closed by the broker")
        });
        let _ = timeout(CLOSE_TIMEOUT, connection.close_with_error(error)).await;
    }
    // Links requeue what they have leased; that needs no answer of the peer.
    let ended = timeout(CLOSE_TIMEOUT, async { while sessions.join_next().await.is_some() {} });
    if ended.await.is_err() {
        sessions.shutdown().await;
    }
    metrics::gauge!("broker_connections").decrement(1.0);
    info!(peer = %address, user = %user_name, "a peer has left");
}

/// Accepts sessions until the connection ends. Returns true when the broker has to close it, false
/// when the peer has closed it.
async fn serve_sessions(
    peer: &Peer,
    connection: &mut ListenerConnectionHandle,
    sessions: &mut JoinSet<()>,
) -> bool {
    loop {
        let incoming = tokio::select! {
            () = peer.cut.cancelled() => return true,
            Some(_) = sessions.join_next() => continue,
            incoming = connection.next_incoming_session() => incoming,
        };
        let Some(incoming) = incoming else { return false };
        let acceptor = SessionAcceptor::builder()
            .incoming_window(SESSION_WINDOW)
            .outgoing_window(SESSION_WINDOW)
            .buffer_size(FRAMES_PER_SESSION)
            .build();
        let accepted = acceptor.accept_incoming_session(incoming, connection);
        match timeout(ATTACH_TIMEOUT, accepted).await {
            Ok(Ok(session)) => {
                let served = peer.clone();
                match peer.share.session() {
                    Some(held) => sessions.spawn(async move {
                        serve_session(served, session).await;
                        drop(held);
                    }),
                    None => sessions.spawn(refuse_session(served, session)),
                };
            }
            Ok(Err(error)) => debug!(user = %peer.user_name, %error, "a session could not begin"),
            Err(_) => return true,
        }
    }
}

fn count_failed_handshake(reason: &'static str) {
    metrics::counter!("broker_handshakes_failed_total", "reason" => reason).increment(1);
}
