//! Serving a router until shutdown, over TLS where configured, within bounds that hold before anybody
//! has signed in: on connections, on the size of what comes, and on the patience with slow clients.

mod bodies;
mod connection;
mod connections;
mod limits;
mod patience;
mod stream;

use std::{
    net::SocketAddr, os::unix::fs::MetadataExt as _, path::PathBuf, sync::Arc, time::Duration,
};

use axum::Router;
use connections::Connections;
use rustls::pki_types::{CertificateDer, PrivateKeyDer, pem::PemObject};
use serde::Deserialize;
use tokio::net::TcpListener;
use tokio_rustls::TlsAcceptor;
use tokio_util::{sync::CancellationToken, task::TaskTracker};
use tracing::warn;

pub use self::{bodies::BodyTooSlow, limits::ListenerLimits};
use crate::data_directory::is_trusted_owner;

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
    /// Other users of the machine may read or write the key.
    #[error("others may read or write the key {path}: run `chmod o-rwx {path}`", path = path.display())]
    SharedKey { path: PathBuf },
    /// The owner of the key could read and change it.
    #[error("the key {path} belongs to another user: run `chown` for this program's or root", path = path.display())]
    ForeignKey { path: PathBuf },
    /// Certificate and key do not make a server.
    #[error("certificate and key cannot be used")]
    UseCertificate(#[source] rustls::Error),
}

/// Pause after a failure to accept any connection.
const ACCEPT_PAUSE: Duration = Duration::from_millis(100);
/// Longest wait for open requests once shutdown begins. A slow client must not hold up the
/// shutdown.
const DRAIN_TIMEOUT: Duration = Duration::from_secs(5);

/// Connections that wait to be accepted. Beyond it Linux drops what comes, and who comes next tries again after a
/// second only: with the library's 128 a crowd that comes again and again keeps out everybody else for that long. It
/// allows 4 096 as a rule.
const ACCEPT_QUEUE: i32 = 4096;

/// Binds the address; port 0 takes a free one.
///
/// # Errors
/// [`ServerError::Listen`].
pub async fn listen(address: SocketAddr) -> Result<TcpListener, ServerError> {
    let failed = |source| ServerError::Listen { address, source };
    let listener = TcpListener::bind(address).await.map_err(failed)?;
    rustix::net::listen(&listener, ACCEPT_QUEUE).map_err(|error| failed(error.into()))?;
    Ok(listener)
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
        self.check_key()?;
        let key = PrivateKeyDer::from_pem_file(&self.key).map_err(read(&self.key))?;
        server_config(chain, key)
    }

    /// Refuses a key that all users of the machine have, or another one. Its group may read it: so the
    /// key of several services is shared.
    fn check_key(&self) -> Result<(), ServerError> {
        // A key that is not there is an error of its reading.
        let Ok(metadata) = std::fs::metadata(&self.key) else { return Ok(()) };
        if metadata.mode() & 0o007 != 0 {
            return Err(ServerError::SharedKey { path: self.key.clone() });
        }
        if !is_trusted_owner(metadata.uid()) {
            return Err(ServerError::ForeignKey { path: self.key.clone() });
        }
        Ok(())
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
pub async fn serve(
    listener: TcpListener,
    tls: Option<Arc<rustls::ServerConfig>>,
    router: Router,
    limits: ListenerLimits,
    shutdown: CancellationToken,
) {
    let connections = Connections::new(limits);
    let tls = tls.map(TlsAcceptor::from);
    let tasks = TaskTracker::new();
    // Cancelled when patience with open requests is at its end.
    let cut_off = CancellationToken::new();
    while let Some(accepted) = shutdown.run_until_cancelled(listener.accept()).await {
        let (stream, peer) = match accepted {
            Ok(accepted) => accepted,
            Err(error) if is_of_connection(&error) => continue,
            Err(error) => {
                // No descriptors are left, as a rule: those that end make room.
                warn!(%error, "A connection cannot be accepted.");
                tokio::time::sleep(ACCEPT_PAUSE).await;
                continue;
            }
        };
        let Some(admitted) = connections.admit(peer.ip()) else { continue };
        let serving = connection::Serving {
            peer,
            tls: tls.clone(),
            router: router.clone(),
            limits: connections.limits().clone(),
            shutdown: shutdown.clone(),
        };
        let cut_off = cut_off.clone();
        tasks.spawn(async move {
            let close = admitted.close.clone();
            let serve = serving.run(stream, admitted.activity.clone());
            cut_off.run_until_cancelled(close.run_until_cancelled(serve)).await;
            drop(admitted);
        });
    }
    drop(listener);
    tasks.close();
    if tokio::time::timeout(DRAIN_TIMEOUT, tasks.wait()).await.is_err() {
        warn!("Open requests were cut off at shutdown.");
        cut_off.cancel();
        tasks.wait().await;
    }
}

/// Returns true for an error of one connection, which says nothing about others.
fn is_of_connection(error: &std::io::Error) -> bool {
    use std::io::ErrorKind::{ConnectionAborted, ConnectionRefused, ConnectionReset};
    matches!(error.kind(), ConnectionRefused | ConnectionAborted | ConnectionReset)
}
