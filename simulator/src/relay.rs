//! The network between clients and a machine, which can be broken.
//!
//! Clients connect to the relay's address, the server listens elsewhere. So connections can be cut
//! without a response of the server, and hang without a sign to either peer.

use std::{io, net::SocketAddr, sync::Arc, time::Duration};

use parking_lot::Mutex;
use tokio::{
    io::{AsyncReadExt as _, AsyncWriteExt as _},
    net::{TcpListener, TcpStream, tcp},
    sync::watch,
};
use tokio_util::sync::CancellationToken;

const BUFFER_BYTES: usize = 64 << 10;
const CONNECT_TIMEOUT: Duration = Duration::from_secs(2);

/// The state of the network, and the connections of now.
pub(crate) struct Relay {
    target: Mutex<Option<SocketAddr>>,
    hangs: watch::Sender<bool>,
    connections: Mutex<CancellationToken>,
}

impl Relay {
    pub(crate) fn new() -> Arc<Self> {
        Arc::new(Self {
            target: Mutex::default(),
            hangs: watch::Sender::new(false),
            connections: Mutex::new(CancellationToken::new()),
        })
    }

    /// Sets the target of connections; without one they are reset.
    pub(crate) fn set_target(&self, target: Option<SocketAddr>) {
        *self.target.lock() = target;
    }

    pub(crate) fn drop_connections(&self) {
        std::mem::take(&mut *self.connections.lock()).cancel();
    }

    /// Swallows everything, or no longer.
    pub(crate) fn set_hanging(&self, hangs: bool) {
        self.hangs.send_replace(hangs);
    }

    /// Accepts connections until told to stop.
    pub(crate) async fn run(self: Arc<Self>, listener: TcpListener, shutdown: CancellationToken) {
        loop {
            let client = tokio::select! {
                () = shutdown.cancelled() => break,
                accepted = listener.accept() => accepted,
            };
            let Ok((client, _)) = client else {
                // Out of file descriptors, most likely: others close in time.
                tokio::time::sleep(Duration::from_millis(50)).await;
                continue;
            };
            let target = *self.target.lock();
            let Some(target) = target else {
                reset(&client);
                continue;
            };
            let cut = self.connections.lock().clone();
            let hangs = self.hangs.subscribe();
            tokio::spawn(async move {
                if let Err(error) = serve(client, target, cut, hangs).await {
                    tracing::debug!(%error, "A relayed connection ended.");
                }
            });
        }
        self.drop_connections();
    }
}

async fn serve(
    client: TcpStream,
    target: SocketAddr,
    cut: CancellationToken,
    hangs: watch::Receiver<bool>,
) -> io::Result<()> {
    let server = tokio::time::timeout(CONNECT_TIMEOUT, TcpStream::connect(target)).await??;
    client.set_nodelay(true)?;
    server.set_nodelay(true)?;
    let (mut client, mut server) = (client, server);
    let result = {
        let (client_read, client_write) = client.split();
        let (server_read, server_write) = server.split();
        tokio::select! {
            () = cut.cancelled() => None,
            result = pump(client_read, server_write, hangs.clone()) => Some(result),
            result = pump(server_read, client_write, hangs) => Some(result),
        }
    };
    match result {
        Some(result) => result,
        None => {
            reset(&client);
            reset(&server);
            Ok(())
        }
    }
}

async fn pump(
    mut from: tcp::ReadHalf<'_>,
    mut to: tcp::WriteHalf<'_>,
    mut hangs: watch::Receiver<bool>,
) -> io::Result<()> {
    let mut buffer = vec![0; BUFFER_BYTES];
    loop {
        let count = from.read(&mut buffer).await?;
        if count == 0 {
            return to.shutdown().await;
        }
        // The sender is never dropped before the relay; an error means that the simulator ends.
        if hangs.wait_for(|hangs| !hangs).await.is_err() {
            return Ok(());
        }
        to.write_all(&buffer[..count]).await?;
    }
}

/// Closes a connection as a crashed peer does: by a reset instead of an orderly shutdown.
fn reset(stream: &TcpStream) {
    let _ = socket2::SockRef::from(stream).set_linger(Some(Duration::ZERO));
}
