//! Listeners: accept TCP connections within bounds, and sweep expired messages meanwhile.

use std::{
    net::SocketAddr,
    sync::Arc,
    time::{Duration, Instant},
};

use rustls::ServerConfig;
use rustls_pki_types::{CertificateDer, PrivateKeyDer, pem::PemObject};
use socket2::{SockRef, TcpKeepalive};
use tokio::{
    net::{TcpListener, TcpStream},
    sync::Semaphore,
    task::JoinSet,
    time::MissedTickBehavior,
};
use tokio_rustls::TlsAcceptor;
use tokio_util::sync::CancellationToken;
use tracing::{info, warn};

use crate::{
    clock,
    config::{Carrier, Listener, TlsIdentity},
    connection::{self, Accepted},
    core::Core,
    error::BrokerError,
    waiting::Taken,
};

/// Interval of the search for expired messages.
const SWEEP_EVERY: Duration = Duration::from_secs(5);
/// Time for all connections together to close at shutdown.
const SHUTDOWN_TIMEOUT: Duration = Duration::from_secs(5);
/// Pause after a failed accept, for example for want of file descriptors.
const ACCEPT_RETRY: Duration = Duration::from_millis(100);

/// A listener bound to its address.
pub(crate) struct BoundListener {
    listener: TcpListener,
    address: SocketAddr,
    tls: Option<TlsAcceptor>,
    carrier: Carrier,
}

impl BoundListener {
    pub(crate) const fn address(&self) -> SocketAddr {
        self.address
    }
}

/// Connections that wait to be accepted: the library's 128 are full as soon as a crowd comes. Linux drops those
/// that come next, and they try again after a second only.
const ACCEPT_QUEUE: i32 = 4096;

/// Binds all listeners and loads their certificates.
pub(crate) async fn bind(listeners: &[Listener]) -> Result<Vec<BoundListener>, BrokerError> {
    let mut bound = Vec::with_capacity(listeners.len());
    for config in listeners {
        let tls = config.tls.as_ref().map(tls_acceptor).transpose()?;
        let failed = |source| BrokerError::Listen { address: config.address, source };
        let listener = TcpListener::bind(config.address).await.map_err(failed)?;
        SockRef::from(&listener).listen(ACCEPT_QUEUE).map_err(failed)?;
        let address = listener.local_addr().map_err(failed)?;
        bound.push(BoundListener { listener, address, tls, carrier: config.carrier });
    }
    Ok(bound)
}

fn tls_acceptor(identity: &TlsIdentity) -> Result<TlsAcceptor, BrokerError> {
    let failed = |reason: String| BrokerError::Tls { reason };
    let chain: Vec<_> = CertificateDer::pem_slice_iter(&identity.certificates_pem)
        .collect::<Result<_, _>>()
        .map_err(|e| failed(format!("the certificate chain is not PEM: {e}")))?;
    let key = PrivateKeyDer::from_pem_slice(&identity.key_pem)
        .map_err(|e| failed(format!("the private key is not PEM: {e}")))?;
    let config =
        ServerConfig::builder_with_provider(Arc::new(rustls::crypto::ring::default_provider()))
            .with_safe_default_protocol_versions()
            .map_err(|e| failed(e.to_string()))?
            .with_no_client_auth()
            .with_single_cert(chain, key)
            .map_err(|e| failed(e.to_string()))?;
    Ok(TlsAcceptor::from(Arc::new(config)))
}

/// Serves all listeners and sweeps the queues until `shutdown`.
pub(crate) async fn serve(
    core: Arc<Core>,
    listeners: Vec<BoundListener>,
    shutdown: CancellationToken,
) {
    let permits = Arc::new(Semaphore::new(core.config.limits.connections_max));
    let mut accepting = JoinSet::new();
    for bound in listeners {
        info!(
            address = %bound.address, tls = bound.tls.is_some(), carrier = ?bound.carrier,
            "the broker listens"
        );
        accepting.spawn(accept(Arc::clone(&core), bound, Arc::clone(&permits), shutdown.clone()));
    }
    let mut sweep = tokio::time::interval(SWEEP_EVERY);
    // Sweeps missed under load are not made up for: one finds all that is due.
    sweep.set_missed_tick_behavior(MissedTickBehavior::Delay);
    loop {
        tokio::select! {
            () = shutdown.cancelled() => break,
            _ = sweep.tick() => core.sweep(clock::now_ms()).await,
        }
    }
    let closing = async { while accepting.join_next().await.is_some() {} };
    if tokio::time::timeout(SHUTDOWN_TIMEOUT, closing).await.is_err() {
        warn!("some peers did not leave in time; they are dropped");
    }
}

async fn accept(
    core: Arc<Core>,
    bound: BoundListener,
    permits: Arc<Semaphore>,
    shutdown: CancellationToken,
) {
    let mut connections = JoinSet::new();
    loop {
        let accepted = tokio::select! {
            () = shutdown.cancelled() => break,
            Some(ended) = connections.join_next() => {
                if let Err(error) = ended && error.is_panic() {
                    metrics::counter!("broker_connection_panics_total").increment(1);
                }
                continue;
            }
            accepted = bound.listener.accept() => accepted,
        };
        let (tcp, peer) = match accepted {
            Ok(accepted) => accepted,
            Err(error) => {
                warn!(%error, "a connection could not be accepted");
                // Most often no descriptor is free; trying at once would only burn CPU.
                tokio::time::sleep(ACCEPT_RETRY).await;
                continue;
            }
        };
        // Refused at once: peers that wait here would hold descriptors and know no reason.
        let Ok(permit) = Arc::clone(&permits).try_acquire_owned() else {
            count_refused("connections");
            continue;
        };
        let place = match core.waiting.enter(peer.ip(), Instant::now()) {
            Ok(place) => place,
            Err(Taken::Address) => {
                count_refused("unauthenticated-of-address");
                continue;
            }
            Err(Taken::InAll) => {
                count_refused("unauthenticated");
                continue;
            }
        };
        if let Err(error) = tune(&tcp, core.config.limits.stall_timeout) {
            warn!(%peer, %error, "a connection's socket options could not be set");
        }
        let (core, tls, shutdown) = (Arc::clone(&core), bound.tls.clone(), shutdown.clone());
        let carrier = bound.carrier;
        connections.spawn(async move {
            connection::serve(core, Accepted { tcp, peer, tls, carrier }, place, shutdown).await;
            drop(permit);
        });
    }
    while connections.join_next().await.is_some() {}
}

fn count_refused(reason: &'static str) {
    metrics::counter!("broker_connections_refused_total", "reason" => reason).increment(1);
}

/// Sets socket options by which a dead peer is found: keep-alive when idle, unacknowledged bytes
/// when busy.
fn tune(tcp: &TcpStream, stall_timeout: Duration) -> std::io::Result<()> {
    // A small frame must not wait for the answer to the one before.
    tcp.set_nodelay(true)?;
    let socket = SockRef::from(tcp);
    let probe = (stall_timeout / 4).max(Duration::from_secs(1));
    socket.set_tcp_keepalive(
        &TcpKeepalive::new().with_time(probe * 2).with_interval(probe).with_retries(2),
    )?;
    #[cfg(target_os = "linux")]
    socket.set_tcp_user_timeout(Some(stall_timeout))?;
    Ok(())
}
