//! Serving a router until shutdown, over TLS where configured.

use std::{future::Future, net::SocketAddr, path::PathBuf, pin::pin, sync::Arc, time::Duration};

use axum::{
    Router,
    serve::{Listener, ListenerExt},
};
use rustls::pki_types::{CertificateDer, PrivateKeyDer, pem::PemObject};
use serde::Deserialize;
use tokio::{
    net::{TcpListener, TcpStream},
    sync::{Semaphore, mpsc},
};
use tokio_rustls::{TlsAcceptor, server::TlsStream};
use tokio_util::sync::CancellationToken;
use tracing::{debug, warn};

/// Certificate and key of a server, as PEM files.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TlsFiles {
    /// The certificate chain, leaf first.
    pub certificate: PathBuf,
    /// PEM file of the private key of the leaf.
    pub key: PathBuf,
}

/// A server could not start or broke off.
#[derive(Debug, thiserror::Error)]
pub enum ServerError {
    /// The address cannot be listened on.
    #[error("cannot listen on {address}")]
    Listen { address: SocketAddr, source: std::io::Error },
    /// A PEM file cannot be used.
    #[error("cannot read {}", path.display())]
    ReadPem { path: PathBuf, source: rustls::pki_types::pem::Error },
    /// Certificate and key do not make a server.
    #[error("certificate and key cannot be used")]
    UseCertificate(#[source] rustls::Error),
    /// The listener failed while requests were served.
    #[error("serving broke off")]
    Serve(#[source] std::io::Error),
}

/// Longest TLS handshake: a client that stays silent must not occupy a place for ever.
const HANDSHAKE_TIMEOUT: Duration = Duration::from_secs(10);
/// Handshakes under way at once. No caller is signed in yet, so the bound is on memory and CPU that
/// any caller can claim.
const HANDSHAKES_MAX: usize = 128;
/// Connections that wait to be served. Few: beyond them the listener's own backlog holds clients.
const ACCEPTED_WAITING_MAX: usize = 16;
/// Longest wait for open requests once shutdown begins. A slow client must not hold up the
/// shutdown.
const DRAIN_TIMEOUT: Duration = Duration::from_secs(5);

/// Binds the address; port 0 takes a free one.
///
/// # Errors
/// [`ServerError::Listen`].
pub async fn listen(address: SocketAddr) -> Result<TcpListener, ServerError> {
    TcpListener::bind(address).await.map_err(|source| ServerError::Listen { address, source })
}

impl TlsFiles {
    /// Reads the files.
    ///
    /// # Errors
    /// [`ServerError`] naming the file at fault.
    pub fn load(&self) -> Result<Arc<rustls::ServerConfig>, ServerError> {
        let read = |path: &PathBuf| {
            let path = path.clone();
            move |source| ServerError::ReadPem { path, source }
        };
        let chain = CertificateDer::pem_file_iter(&self.certificate)
            .and_then(Iterator::collect)
            .map_err(read(&self.certificate))?;
        let key = PrivateKeyDer::from_pem_file(&self.key).map_err(read(&self.key))?;
        server_config(chain, key)
    }
}

/// A TLS configuration for a certificate chain and its key.
///
/// # Errors
/// [`ServerError::UseCertificate`].
pub fn server_config(
    chain: Vec<CertificateDer<'static>>,
    key: PrivateKeyDer<'static>,
) -> Result<Arc<rustls::ServerConfig>, ServerError> {
    let provider = Arc::new(rustls::crypto::ring::default_provider());
    let mut config = rustls::ServerConfig::builder_with_provider(provider)
        .with_safe_default_protocol_versions()
        .map_err(ServerError::UseCertificate)?
        .with_no_client_auth()
        .with_single_cert(chain, key)
        .map_err(ServerError::UseCertificate)?;
    config.alpn_protocols = vec![b"http/1.1".to_vec()];
    Ok(Arc::new(config))
}

/// Serves until shutdown; open requests get a few seconds to finish. Handlers may extract
/// `ConnectInfo<SocketAddr>`.
///
/// # Errors
/// [`ServerError::Serve`].
pub async fn serve(
    listener: TcpListener,
    tls: Option<Arc<rustls::ServerConfig>>,
    router: Router,
    shutdown: CancellationToken,
) -> Result<(), ServerError> {
    let service = router.into_make_service_with_connect_info::<SocketAddr>();
    let soft = shutdown.clone().cancelled_owned();
    match tls {
        None => {
            until_drained(
                axum::serve(listener, service).with_graceful_shutdown(soft).into_future(),
                shutdown,
            )
            .await
        }
        Some(tls) => {
            let listener =
                TlsListener::new(listener, tls, shutdown.clone()).map_err(ServerError::Serve)?;
            // axum knows the peer's address of foreign listeners only through `tap_io`.
            let listener = listener.tap_io(|_| ());
            until_drained(
                axum::serve(listener, service).with_graceful_shutdown(soft).into_future(),
                shutdown,
            )
            .await
        }
    }
}

async fn until_drained(
    serving: impl Future<Output = std::io::Result<()>>,
    shutdown: CancellationToken,
) -> Result<(), ServerError> {
    let mut serving = pin!(serving);
    tokio::select! {
        result = &mut serving => return result.map_err(ServerError::Serve),
        () = shutdown.cancelled() => {}
    }
    match tokio::time::timeout(DRAIN_TIMEOUT, serving).await {
        Ok(result) => result.map_err(ServerError::Serve),
        Err(_) => {
            warn!("Open requests were cut off at shutdown.");
            Ok(())
        }
    }
}

/// Accepts TLS connections; handshakes run beside each other, so that a silent peer holds nobody
/// up.
struct TlsListener {
    accepted: mpsc::Receiver<(TlsStream<TcpStream>, SocketAddr)>,
    local_address: SocketAddr,
}

impl TlsListener {
    fn new(
        listener: TcpListener,
        tls: Arc<rustls::ServerConfig>,
        shutdown: CancellationToken,
    ) -> std::io::Result<Self> {
        let local_address = listener.local_addr()?;
        let (sender, accepted) = mpsc::channel(ACCEPTED_WAITING_MAX);
        tokio::spawn(shutdown.run_until_cancelled_owned(accept_loop(
            listener,
            TlsAcceptor::from(tls),
            sender,
        )));
        Ok(Self { accepted, local_address })
    }
}

async fn accept_loop(
    mut listener: TcpListener,
    acceptor: TlsAcceptor,
    sender: mpsc::Sender<(TlsStream<TcpStream>, SocketAddr)>,
) {
    let handshakes = Arc::new(Semaphore::new(HANDSHAKES_MAX));
    loop {
        let Ok(permit) = Arc::clone(&handshakes).acquire_owned().await else { return };
        let (stream, address) = Listener::accept(&mut listener).await;
        let (acceptor, sender) = (acceptor.clone(), sender.clone());
        tokio::spawn(async move {
            let _permit = permit;
            match tokio::time::timeout(HANDSHAKE_TIMEOUT, acceptor.accept(stream)).await {
                Ok(Ok(stream)) => drop(sender.send((stream, address)).await),
                Ok(Err(error)) => debug!(%address, %error, "A TLS handshake failed."),
                Err(_) => debug!(%address, "A TLS handshake took too long."),
            }
        });
    }
}

impl Listener for TlsListener {
    type Io = TlsStream<TcpStream>;
    type Addr = SocketAddr;

    async fn accept(&mut self) -> (Self::Io, Self::Addr) {
        match self.accepted.recv().await {
            Some(connection) => connection,
            None => std::future::pending().await,
        }
    }

    fn local_addr(&self) -> std::io::Result<SocketAddr> {
        Ok(self.local_address)
    }
}
