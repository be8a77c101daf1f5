//! Entrances of a broker: as it is, behind TLS, and in WebSockets.

use std::{io, net::Ipv4Addr, path::Path, sync::Arc};

use anyhow::Context as _;
use rustls::{
    ClientConfig, RootCertStore,
    pki_types::{CertificateDer, pem::PemObject as _},
};
use tokio::io::{AsyncRead, AsyncWrite};
use tokio_rustls::TlsConnector;
use websocket::{Endpoint, Subprotocol};

use super::route::Route;

/// Name for which the broker has a certificate.
const HOST: &str = "127.0.0.1";
/// Largest message of a WebSocket that is read.
const MESSAGE_BYTES_MAX: usize = 1 << 20;

/// Both directions of an open connection.
pub(super) trait Wire: AsyncRead + AsyncWrite + Send + Unpin {}

impl<W: AsyncRead + AsyncWrite + Send + Unpin> Wire for W {}

/// Layers that a client lays over TCP.
#[derive(Debug, Clone)]
pub(super) enum Layers {
    None,
    Tls(Arc<ClientConfig>),
    /// A WebSocket in TLS.
    WebSocket(Arc<ClientConfig>),
}

/// A listener with the layers that it expects, or only those that a client goes through.
#[derive(Debug, Clone)]
pub(super) struct Entrance {
    pub(super) port: u16,
    pub(super) layers: Layers,
}

impl Entrance {
    pub(super) const fn plain(port: u16) -> Self {
        Self { port, layers: Layers::None }
    }

    /// Opens a connection from an address.
    pub(super) async fn open(&self, from: Ipv4Addr) -> io::Result<Box<dyn Wire>> {
        let stream = Route::new(from, self.port).connect().await?;
        let (tls, is_in_websocket) = match &self.layers {
            Layers::None => return Ok(Box::new(stream)),
            Layers::Tls(tls) => (tls, false),
            Layers::WebSocket(tls) => (tls, true),
        };
        let name = HOST.try_into().map_err(io::Error::other)?;
        let stream = TlsConnector::from(Arc::clone(tls)).connect(name, stream).await?;
        if !is_in_websocket {
            return Ok(Box::new(stream));
        }
        let authority = format!("{HOST}:{}", self.port);
        let endpoint = Endpoint { authority: &authority, path: "/" };
        let opened =
            websocket::connect(stream, endpoint, Subprotocol::Amqp, MESSAGE_BYTES_MAX).await;
        Ok(Box::new(opened.map_err(io::Error::other)?))
    }
}

/// Returns what a client needs that trusts the authority of a platform alone.
pub(super) fn trusting(platform: &Path) -> anyhow::Result<Arc<ClientConfig>> {
    let file = platform.join("certificates/root.pem");
    let root = CertificateDer::from_pem_file(&file)
        .with_context(|| format!("reading {}", file.display()))?;
    let mut roots = RootCertStore::empty();
    roots.add(root)?;
    let config = ClientConfig::builder().with_root_certificates(roots).with_no_client_auth();
    Ok(Arc::new(config))
}
