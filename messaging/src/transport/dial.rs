//! Byte streams to a broker: name resolution on every attempt, TCP that detects a dead peer even
//! while data is being sent, TLS, and a WebSocket if the broker's address asks for one.

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

/// Settings of the streams.
#[derive(Debug, Clone)]
pub(super) struct Dialler {
    pub client: Option<Arc<ClientConfig>>,
    pub tls: TlsConfig,
    pub proxy: Option<HttpProxy>,
    pub stall_timeout: Duration,
    /// Largest message accepted, in bytes.
    pub message_bytes_max: u64,
}

impl Dialler {
    /// Connects, through the proxy if there is one. The caller limits the time.
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

    /// Wraps the stream in TLS if the broker's address asks for it.
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
            .map_err(|e| ConnectionFault::transient(format!("cannot resolve {host}: {e}")))?
            .collect();
        let mut last = ConnectionFault::transient(format!("{host} has no address"));
        let count = u32::try_from(addresses.len()).unwrap_or(u32::MAX).max(1);
        for address in addresses {
            // A dead address must not use up the time of the others.
            let connecting =
                tokio::time::timeout(self.stall_timeout / count, TcpStream::connect(address)).await;
            let connected = connecting.unwrap_or_else(|_| Err(io::ErrorKind::TimedOut.into()));
            match connected.and_then(|tcp| tune(&tcp, self.stall_timeout).map(|()| tcp)) {
                Ok(tcp) => return Ok(tcp),
                Err(e) => {
                    last = ConnectionFault::transient(format!("cannot connect to {address}: {e}"))
                }
            }
        }
        Err(last)
    }
}

/// Converts an error of TLS. A certificate that is not trusted stays so until a person acts.
fn tls_fault(error: io::Error) -> ConnectionFault {
    let cause = error.get_ref().and_then(|inner| inner.downcast_ref::<rustls::Error>());
    let reason = format!("TLS failed: {error}");
    match cause {
        Some(
            rustls::Error::InvalidCertificate(_)
            | rustls::Error::AlertReceived(_)
            | rustls::Error::NoCertificatesPresented,
        ) => ConnectionFault::permanent(reason),
        _ => ConnectionFault::transient(reason),
    }
}

/// Sets the socket to detect a dead peer: by keep-alive when idle, by unacknowledged bytes when
/// busy. The heartbeats of the protocol do not suffice, because a writer that is blocked in its
/// socket does not check its timer.
fn tune(tcp: &TcpStream, stall_timeout: Duration) -> io::Result<()> {
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
