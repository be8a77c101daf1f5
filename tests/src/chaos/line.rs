//! The line between factories and broker: a TCP proxy that can be cut, stalled, emptied into
//! nothing and thinned.

use std::{net::SocketAddr, time::Duration};

use tokio::{
    io::{AsyncReadExt as _, AsyncWriteExt as _},
    net::{
        TcpListener, TcpStream,
        tcp::{OwnedReadHalf, OwnedWriteHalf},
    },
    sync::watch,
};
use tokio_util::{sync::CancellationToken, task::AbortOnDropHandle};

/// Treatment of the bytes that pass.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Condition {
    /// Everything passes at once.
    Clear,
    /// Bytes wait, and nothing passes.
    Stalled,
    /// Bytes are taken and thrown away.
    Swallowing,
    /// Few bytes a second pass.
    Thin,
}

/// Bytes that a thin line carries at once, and the pause after them: 16 kB/s.
const THIN_BYTES: usize = 512;
const THIN_PAUSE: Duration = Duration::from_millis(32);

/// A running proxy.
#[derive(Debug)]
pub struct Line {
    condition: watch::Sender<Condition>,
    cut: watch::Sender<CancellationToken>,
    _task: AbortOnDropHandle<()>,
}

impl Line {
    /// Listens and passes every connection on.
    ///
    /// # Errors
    /// When the port is taken.
    pub async fn open(listen: SocketAddr, to: SocketAddr) -> std::io::Result<Self> {
        let listener = TcpListener::bind(listen).await?;
        let (condition, is) = watch::channel(Condition::Clear);
        let (cut, alive) = watch::channel(CancellationToken::new());
        let task = tokio::spawn(async move {
            while let Ok((client, _)) = listener.accept().await {
                let (is, token) = (is.clone(), alive.borrow().clone());
                tokio::spawn(async move {
                    // Nobody behind it: the client sees its connection closed and tries again.
                    let Ok(server) = TcpStream::connect(to).await else { return };
                    token.run_until_cancelled(carry(client, server, is)).await;
                });
            }
        });
        Ok(Self { condition, cut, _task: AbortOnDropHandle::new(task) })
    }

    /// Changes how bytes pass from now on, on open connections too.
    pub fn set(&self, condition: Condition) {
        self.condition.send_replace(condition);
    }

    /// Resets every open connection.
    pub fn cut(&self) {
        self.cut.send_replace(CancellationToken::new()).cancel();
    }
}

async fn carry(client: TcpStream, server: TcpStream, is: watch::Receiver<Condition>) {
    // Without lingering a dropped socket is reset: what was under way is gone.
    for socket in [&client, &server] {
        socket.set_zero_linger().ok();
        socket.set_nodelay(true).ok();
    }
    let (from_client, to_client) = client.into_split();
    let (from_server, to_server) = server.into_split();
    let there = pass(from_client, to_server, is.clone());
    let back = pass(from_server, to_client, is);
    tokio::select! { _ = there => (), _ = back => () }
}

/// Ends when either side ends, or this line is closed.
async fn pass(
    mut from: OwnedReadHalf,
    mut to: OwnedWriteHalf,
    mut is: watch::Receiver<Condition>,
) -> anyhow::Result<()> {
    let mut buffer = vec![0; 64 * 1024];
    loop {
        let most = if *is.borrow() == Condition::Thin { THIN_BYTES } else { buffer.len() };
        let count = from.read(&mut buffer[..most]).await?;
        anyhow::ensure!(count > 0, "the end");
        let now = *is.wait_for(|condition| *condition != Condition::Stalled).await?;
        if now == Condition::Thin {
            tokio::time::sleep(THIN_PAUSE).await;
        }
        if now != Condition::Swallowing {
            to.write_all(&buffer[..count]).await?;
        }
    }
}
