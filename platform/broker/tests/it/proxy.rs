//! A TCP proxy that can stall and cut, and an HTTP proxy.

use std::{
    net::SocketAddr,
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicUsize, Ordering},
    },
    time::Duration,
};

use tokio::{
    io::{AsyncReadExt, AsyncWriteExt},
    net::{TcpListener, TcpStream},
};
use tokio_util::sync::CancellationToken;

pub struct Proxy {
    pub address: SocketAddr,
    pub connections: Arc<AtomicUsize>,
    is_stalled: Arc<AtomicBool>,
    cut: Arc<parking_lot::Mutex<CancellationToken>>,
}

impl Proxy {
    pub async fn to(port: u16) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").await.expect("a port");
        let address = listener.local_addr().expect("an address");
        let connections = Arc::new(AtomicUsize::new(0));
        let is_stalled = Arc::new(AtomicBool::new(false));
        let cut = Arc::new(parking_lot::Mutex::new(CancellationToken::new()));
        tokio::spawn({
            let (connections, is_stalled, cut) =
                (Arc::clone(&connections), Arc::clone(&is_stalled), Arc::clone(&cut));
            async move {
                while let Ok((client, _)) = listener.accept().await {
                    connections.fetch_add(1, Ordering::SeqCst);
                    let Ok(server) = TcpStream::connect(("127.0.0.1", port)).await else {
                        continue;
                    };
                    let token = cut.lock().clone();
                    let is_stalled = Arc::clone(&is_stalled);
                    tokio::spawn(async move {
                        let (client_read, client_write) = client.into_split();
                        let (server_read, server_write) = server.into_split();
                        tokio::select! {
                            () = token.cancelled() => {}
                            () = pass(client_read, server_write, Arc::clone(&is_stalled)) => {}
                            () = pass(server_read, client_write, is_stalled) => {}
                        }
                    });
                }
            }
        });
        Self { address, connections, is_stalled, cut }
    }

    pub fn url(&self) -> String {
        format!("amqp://{}", self.address)
    }

    /// Passes nothing on, in either direction, on any connection, while all stay open.
    pub fn stall(&self, is_stalled: bool) {
        self.is_stalled.store(is_stalled, Ordering::SeqCst);
    }

    /// Cuts all connections.
    pub fn cut(&self) {
        std::mem::take(&mut *self.cut.lock()).cancel();
    }
}

async fn pass(
    mut from: tokio::net::tcp::OwnedReadHalf,
    mut to: tokio::net::tcp::OwnedWriteHalf,
    is_stalled: Arc<AtomicBool>,
) {
    let mut buffer = vec![0; 16 * 1024];
    loop {
        while is_stalled.load(Ordering::SeqCst) {
            tokio::time::sleep(Duration::from_millis(5)).await;
        }
        let Ok(count @ 1..) = from.read(&mut buffer).await else { return };
        while is_stalled.load(Ordering::SeqCst) {
            tokio::time::sleep(Duration::from_millis(5)).await;
        }
        if to.write_all(&buffer[..count]).await.is_err() {
            return;
        }
    }
}

/// Starts an HTTP proxy that asks for the user `plant` with the password `gate`.
pub async fn http_proxy() -> SocketAddr {
    let listener = TcpListener::bind("127.0.0.1:0").await.expect("a port");
    let address = listener.local_addr().expect("an address");
    tokio::spawn(async move {
        while let Ok((client, _)) = listener.accept().await {
            tokio::spawn(connect(client));
        }
    });
    address
}

async fn connect(mut client: TcpStream) -> Option<()> {
    let mut request = Vec::new();
    while !request.ends_with(b"\r\n\r\n") {
        request.push(client.read_u8().await.ok()?);
    }
    let request = String::from_utf8(request).ok()?;
    let target = request.strip_prefix("CONNECT ")?.split(' ').next()?;
    if !request.contains("Proxy-Authorization: Basic cGxhbnQ6Z2F0ZQ==") {
        client
            .write_all(b"HTTP/1.1 407 Proxy Authentication Required\r\nContent-Length: 0\r\n\r\n")
            .await
            .ok()?;
        return None;
    }
    let mut server = TcpStream::connect(target).await.ok()?;
    client.write_all(b"HTTP/1.1 200 Connection established\r\n\r\n").await.ok()?;
    tokio::io::copy_bidirectional(&mut client, &mut server).await.ok()?;
    Some(())
}
