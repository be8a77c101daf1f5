//! Opens the byte stream to a broker: fresh name resolution, TCP that notices a dead peer even
//! while we are busy sending, TLS, and a WebSocket where the broker is reached in one.

mod proxy;
mod stream;
mod websocket;

use std::{io, net::SocketAddr, sync::Arc, time::Duration};

use rustls::ClientConfig;
use socket2::{SockRef, TcpKeepalive};
use tokio::net::{TcpStream, lookup_host};
use tokio_rustls::TlsConnector;

use super::{connection::ConnectionFault, tls};
use crate::config::{BrokerUrl, HttpProxy, TlsConfig};

pub(super) use stream::Stream;

/// What dialling needs to know.
#[derive(Debug, Clone)]
pub(super) struct Dialler {
    pub client: Option<Arc<ClientConfig>>,
    pub tls: TlsConfig,
    pub proxy: Option<HttpProxy>,
    pub stall_timeout: Duration,
    /// Largest message taken, in bytes.
    pub message_bytes_max: u64,
}

impl Dialler {
    /// Connects, through the proxy where there is one. The caller bounds the time.
    pub(super) async fn dial(
        &self,
        broker: &BrokerUrl,
    ) -> Result<Box<dyn Stream>, ConnectionFault> {
        let tcp = match &self.proxy {
            None => self.tcp(broker.host(), broker.port()).await?,
            Some(proxy) => {
                let tcp = self.tcp(&proxy.host, proxy.port).await?;
                proxy::tunnel(tcp, proxy, broker.host(), broker.port()).await?
            }
        };
        let stream = self.encrypted(broker, tcp).await?;
        match broker.websocket_path() {
            None => Ok(stream),
            Some(path) => websocket::open(stream, broker, path, self.message_bytes_max).await,
        }
    }

    /// The stream as the broker's address wants it, plain or in TLS.
    async fn encrypted(
        &self,
        broker: &BrokerUrl,
        tcp: TcpStream,
    ) -> Result<Box<dyn Stream>, ConnectionFault> {
        if !broker.is_encrypted() {
            return Ok(Box::new(tcp));
        }
        let client = self
            .client
            .as_ref()
            .ok_or_else(|| ConnectionFault::permanent("TLS is not configured"))?;
        let name =
            tls::server_name(&self.tls, broker.host()).map_err(ConnectionFault::permanent)?;
        let stream =
            TlsConnector::from(Arc::clone(client)).connect(name, tcp).await.map_err(tls_fault)?;
        Ok(Box::new(stream))
    }

    /// Connects to the first of the host's addresses that answers.
    async fn tcp(&self, host: &str, port: u16) -> Result<TcpStream, ConnectionFault> {
        let addresses: Vec<SocketAddr> = lookup_host((host, port))
            .await
            .map_err(|e| ConnectionFault::passing(format!("cannot resolve {host}: {e}")))?
            .collect();
        let mut last = ConnectionFault::passing(format!("{host} has no address"));
        let count = u32::try_from(addresses.len()).unwrap_or(u32::MAX).max(1);
        for address in addresses {
            // One dead address must not use up the time of the others.
            let connecting =
                tokio::time::timeout(self.stall_timeout / count, TcpStream::connect(address)).await;
            let connected = connecting.unwrap_or_else(|_| Err(io::ErrorKind::TimedOut.into()));
            match connected.and_then(|tcp| tune(&tcp, self.stall_timeout).map(|()| tcp)) {
                Ok(tcp) => return Ok(tcp),
                Err(e) => {
                    last = ConnectionFault::passing(format!("cannot connect to {address}: {e}"))
                }
            }
        }
        Err(last)
    }
}

/// A certificate that is not trusted today will not be tomorrow, unless somebody acts.
fn tls_fault(error: io::Error) -> ConnectionFault {
    let cause = error.get_ref().and_then(|inner| inner.downcast_ref::<rustls::Error>());
    let reason = format!("TLS failed: {error}");
    match cause {
        Some(
            rustls::Error::InvalidCertificate(_)
            | rustls::Error::AlertReceived(_)
            | rustls::Error::NoCertificatesPresented,
        ) => ConnectionFault::permanent(reason),
        _ => ConnectionFault::passing(reason),
    }
}

/// Makes a dead peer show: by keep-alive when idle, by unacknowledged bytes when busy. The
/// heartbeats of the protocol do not suffice, for a writer that is blocked in its socket does not
/// look at its timer.
fn tune(tcp: &TcpStream, stall_timeout: Duration) -> io::Result<()> {
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
