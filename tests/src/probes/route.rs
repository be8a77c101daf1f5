//! Ways to the listeners of this machine, from different addresses: what mean people do counts for theirs.

use std::{
    io,
    net::{Ipv4Addr, SocketAddr},
};

use tokio::net::{TcpListener, TcpSocket, TcpStream};
use tokio_util::task::AbortOnDropHandle;

/// Address of those who mean harm; crowds have others besides.
pub(super) const HOSTILE: Ipv4Addr = Ipv4Addr::new(127, 3, 0, 1);

/// A listener, and the address from which it is reached.
#[derive(Debug, Clone, Copy)]
pub(super) struct Route {
    from: Ipv4Addr,
    port: u16,
}

impl Route {
    pub(super) const fn new(from: Ipv4Addr, port: u16) -> Self {
        Self { from, port }
    }

    /// Returns the way of those who mean well.
    pub(super) const fn honest(port: u16) -> Self {
        Self::new(Ipv4Addr::LOCALHOST, port)
    }

    pub(super) const fn hostile(port: u16) -> Self {
        Self::new(HOSTILE, port)
    }

    /// Returns the endpoint URL of an OPC UA server.
    pub(super) fn opcua_url(self) -> String {
        format!("opc.tcp://127.0.0.1:{}", self.port)
    }

    pub(super) async fn connect(self) -> io::Result<TcpStream> {
        let socket = TcpSocket::new_v4()?;
        socket.bind(SocketAddr::new(self.from.into(), 0))?;
        // A small frame must not wait for the answer to the one before.
        socket.set_nodelay(true)?;
        socket.connect(SocketAddr::new(Ipv4Addr::LOCALHOST.into(), self.port)).await
    }
}

/// A listener that passes all on along a route: clients whose library chooses the address for them come from that of
/// the route.
#[derive(Debug)]
pub(super) struct Relay {
    port: u16,
    _passes_on: AbortOnDropHandle<()>,
}

impl Relay {
    pub(super) async fn along(route: Route) -> io::Result<Self> {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).await?;
        let port = listener.local_addr()?.port();
        let passes_on = tokio::spawn(async move {
            while let Ok((mut here, _)) = listener.accept().await {
                tokio::spawn(async move {
                    if let Ok(mut there) = route.connect().await {
                        tokio::io::copy_bidirectional(&mut here, &mut there).await.ok();
                    }
                });
            }
        });
        Ok(Self { port, _passes_on: AbortOnDropHandle::new(passes_on) })
    }

    /// Returns the way to the relay.
    pub(super) const fn route(&self) -> Route {
        Route::honest(self.port)
    }
}
