//! One peer: TLS, WebSocket, SASL, sessions, links.

mod opening;

use std::{
    net::SocketAddr,
    sync::{Arc, OnceLock},
    time::Duration,
};

use fe2o3_amqp::{
    acceptor::{
        ConnectionAcceptor, LinkAcceptor, LinkEndpoint, ListenerConnectionHandle,
        ListenerSessionHandle, SaslAcceptor, SessionAcceptor, sasl_acceptor::SaslServerFrame,
    },
    types::{
        definitions::{self, AmqpError, ConnectionError, ErrorCondition},
        performatives::Attach,
        primitives::{Array, Symbol},
        sasl::{SaslCode, SaslInit, SaslOutcome, SaslResponse},
    },
};
use tokio::{task::JoinSet, time::timeout};
use tokio_util::sync::CancellationToken;
use tracing::{debug, info, warn};

use crate::{
    core::Core,
    credentials::is_authentic,
    link::{self, Grant},
};

pub(crate) use opening::Accepted;

/// Frames are cut to this size, so that one large message does not block the others of a
/// connection.
const FRAME_BYTES_MAX: u32 = 64 * 1024;
/// Frames that may wait between the tasks of a connection.
const FRAMES_BUFFERED: usize = 256;
/// Transfers a peer may have under way in one session.
const SESSION_WINDOW: u32 = 4096;
/// Time for a peer to answer a close or an attach.
const CLOSE_TIMEOUT: Duration = Duration::from_secs(2);
const ATTACH_TIMEOUT: Duration = Duration::from_secs(10);

/// Serves one accepted TCP connection to its end.
pub(crate) async fn serve(core: Arc<Core>, accepted: Accepted, shutdown: CancellationToken) {
    let peer = accepted.peer;
    let identity = Identity::new(&core);
    let acceptor = ConnectionAcceptor::builder()
        .container_id("verbund-broker")
        .max_frame_size(FRAME_BYTES_MAX)
        .channel_max(core.config.limits.sessions_max)
        .buffer_size(FRAMES_BUFFERED)
        .sasl_acceptor(identity.clone())
        .build();
    // No idle timeout of our own: peers that send heartbeats only at the full period would be cut.
    // A dead peer shows by TCP keep-alive and by unacknowledged bytes.
    let handshake = async {
        let stream = accepted.open().await?;
        acceptor.accept(stream).await.map_err(|e| e.to_string())
    };
    let opened = tokio::select! {
        () = shutdown.cancelled() => return,
        opened = timeout(core.config.limits.handshake_timeout, handshake) => opened,
    };
    let connection = match opened {
        Ok(Ok(connection)) => connection,
        Ok(Err(reason)) => {
            metrics::counter!("broker_handshakes_failed_total", "reason" => identity.failure())
                .increment(1);
            return info!(%peer, reason, "a peer did not complete the handshake");
        }
        Err(_) => {
            metrics::counter!("broker_handshakes_failed_total", "reason" => "timeout").increment(1);
            return info!(%peer, "a peer took too long for the handshake");
        }
    };
    let Some(user_name) = identity.user_name() else {
        return debug!(%peer, "a peer skipped SASL");
    };
    signed_in(core, connection, peer, user_name, shutdown).await;
}

async fn signed_in(
    core: Arc<Core>,
    mut connection: ListenerConnectionHandle,
    peer: SocketAddr,
    user_name: Arc<str>,
    shutdown: CancellationToken,
) {
    let Some(registration) = core.register(&user_name, peer, shutdown.child_token()) else {
        metrics::counter!("broker_handshakes_failed_total", "reason" => "too-many-connections")
            .increment(1);
        warn!(%peer, user = %user_name, "a user has too many connections; the new one is refused");
        let error = error(AmqpError::ResourceLimitExceeded, "this user has too many connections");
        let _ = timeout(CLOSE_TIMEOUT, connection.close_with_error(error)).await;
        return;
    };
    info!(%peer, user = %user_name, "a peer signed in");
    metrics::gauge!("broker_connections").increment(1.0);
    let links = Arc::new(tokio::sync::Semaphore::new(core.config.limits.links_max));
    let why_cut = Arc::new(OnceLock::new());
    let mut sessions = JoinSet::new();
    let is_cut = loop {
        tokio::select! {
            () = registration.cut.cancelled() => break true,
            Some(_) = sessions.join_next() => {}
            incoming = connection.next_incoming_session() => {
                let Some(incoming) = incoming else { break false };
                let acceptor = SessionAcceptor::builder()
                    .incoming_window(SESSION_WINDOW)
                    .outgoing_window(SESSION_WINDOW)
                    .buffer_size(FRAMES_BUFFERED)
                    .build();
                match timeout(ATTACH_TIMEOUT, acceptor.accept_incoming_session(incoming, &mut connection)).await {
                    Ok(Ok(session)) => {
                        let peer = Peer { core: Arc::clone(&core), user_name: Arc::clone(&user_name), links: Arc::clone(&links), cut: registration.cut.clone(), why_cut: Arc::clone(&why_cut) };
                        sessions.spawn(serve_session(peer, session));
                    }
                    Ok(Err(error)) => debug!(%peer, user = %user_name, %error, "a session could not begin"),
                    Err(_) => break true,
                }
            }
        }
    };
    registration.cut.cancel();
    if is_cut {
        let error = why_cut.get().cloned();
        let error = error.unwrap_or_else(|| {
            self::error(ConnectionError::ConnectionForced, "closed by the broker")
        });
        let _ = timeout(CLOSE_TIMEOUT, connection.close_with_error(error)).await;
    }
    // Links give back what they hold; that needs no peer.
    if timeout(CLOSE_TIMEOUT, async { while sessions.join_next().await.is_some() {} })
        .await
        .is_err()
    {
        sessions.shutdown().await;
    }
    metrics::gauge!("broker_connections").decrement(1.0);
    info!(%peer, user = %user_name, "a peer has left");
}

/// What the links of a connection need.
struct Peer {
    core: Arc<Core>,
    user_name: Arc<str>,
    links: Arc<tokio::sync::Semaphore>,
    cut: CancellationToken,
    why_cut: Arc<OnceLock<definitions::Error>>,
}

impl Peer {
    /// Ends the whole connection.
    fn give_up(&self, error: definitions::Error) {
        let _ = self.why_cut.set(error);
        self.cut.cancel();
    }
}

async fn serve_session(peer: Peer, mut session: ListenerSessionHandle) {
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
    // The session is gone, so the links end by themselves; they give back what they hold.
    drop(session);
    while links.join_next().await.is_some() {}
}

async fn serve_attach(
    peer: &Peer,
    attach: Attach,
    session: &mut ListenerSessionHandle,
    links: &mut JoinSet<()>,
) {
    let permit = Arc::clone(&peer.links).try_acquire_owned();
    let grant = match &permit {
        Ok(_) => link::grant(&peer.core, &peer.user_name, &attach).await,
        Err(_) => {
            Err(error(AmqpError::ResourceLimitExceeded, "this connection has too many links"))
        }
    };
    let acceptor =
        LinkAcceptor::builder().max_message_size(peer.core.config.limits.message_bytes_max).build();
    let endpoint = match timeout(ATTACH_TIMEOUT, acceptor.accept_incoming_attach(attach, session))
        .await
    {
        Ok(Ok(endpoint)) => endpoint,
        Ok(Err(problem)) => {
            debug!(user = %peer.user_name, ?problem, "a link could not be attached");
            // The library has not answered the peer, which would wait for ever.
            let reason = "the link could not be attached; its name must be unique in the session, in both directions";
            return peer.give_up(error(AmqpError::NotAllowed, reason));
        }
        Err(_) => {
            return peer.give_up(error(
                AmqpError::InternalError,
                "the link could not be attached in time",
            ));
        }
    };
    match grant {
        Ok(Grant { queue }) => {
            let (core, user_name, cut) =
                (Arc::clone(&peer.core), Arc::clone(&peer.user_name), peer.cut.clone());
            links.spawn(async move {
                match endpoint {
                    LinkEndpoint::Receiver(receiver) => {
                        link::ingest(core, queue, user_name, receiver, cut).await
                    }
                    LinkEndpoint::Sender(sender) => link::dispatch(core, queue, sender, cut).await,
                }
                drop(permit);
            });
        }
        Err(refusal) => {
            warn!(user = %peer.user_name, condition = ?refusal.condition, reason = refusal.description.as_deref().unwrap_or_default(), "a link is refused");
            metrics::counter!("broker_links_refused_total").increment(1);
            links.spawn(async move {
                let closed = match endpoint {
                    LinkEndpoint::Receiver(receiver) => {
                        timeout(CLOSE_TIMEOUT, receiver.close_with_error(refusal)).await
                    }
                    LinkEndpoint::Sender(sender) => {
                        timeout(CLOSE_TIMEOUT, sender.close_with_error(refusal)).await
                    }
                };
                if let Ok(Err(error)) = closed {
                    debug!(?error, "the peer did not take the refusal of a link cleanly");
                }
            });
        }
    }
}

/// An AMQP error with a sentence for people.
pub(crate) fn error(
    condition: impl Into<ErrorCondition>,
    description: impl Into<String>,
) -> definitions::Error {
    definitions::Error::new(condition, description.into(), None)
}

/// Checks SASL PLAIN (RFC 4616) and remembers who signed in. One per connection.
#[derive(Clone)]
struct Identity {
    core: Arc<Core>,
    user: Arc<OnceLock<Arc<str>>>,
    is_refused: Arc<OnceLock<()>>,
}

impl Identity {
    fn new(core: &Arc<Core>) -> Self {
        Self { core: Arc::clone(core), user: Arc::default(), is_refused: Arc::default() }
    }

    fn user_name(&self) -> Option<Arc<str>> {
        self.user.get().cloned()
    }

    fn failure(&self) -> &'static str {
        if self.is_refused.get().is_some() { "credentials" } else { "protocol" }
    }

    fn check(&self, init: &SaslInit) -> SaslCode {
        if init.mechanism.as_str() != "PLAIN" {
            return SaslCode::Auth;
        }
        let response = init.initial_response.as_ref().map(|r| r.as_slice()).unwrap_or_default();
        let mut parts = response.split(|byte| *byte == 0);
        let (Some(acting_as), Some(name), Some(secret), None) =
            (parts.next(), parts.next(), parts.next(), parts.next())
        else {
            return SaslCode::Auth;
        };
        let Ok(name) = std::str::from_utf8(name) else { return SaslCode::Auth };
        let may_act = acting_as.is_empty() || acting_as == name.as_bytes();
        let user = self.core.credentials.user(name);
        if is_authentic(user.as_ref(), secret) && may_act && self.user.set(Arc::from(name)).is_ok()
        {
            SaslCode::Ok
        } else {
            SaslCode::Auth
        }
    }
}

impl SaslAcceptor for Identity {
    fn mechanisms(&self) -> Array<Symbol> {
        Array::from(vec![Symbol::from("PLAIN")])
    }

    fn on_init(&mut self, init: SaslInit) -> SaslServerFrame {
        let code = self.check(&init);
        if !matches!(code, SaslCode::Ok) {
            let _ = self.is_refused.set(());
        }
        SaslServerFrame::Outcome(SaslOutcome { code, additional_data: None })
    }

    fn on_response(&mut self, _response: SaslResponse) -> SaslServerFrame {
        SaslServerFrame::Outcome(SaslOutcome { code: SaslCode::Auth, additional_data: None })
    }
}
