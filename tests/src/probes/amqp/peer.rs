//! One end of a connection to the broker, written byte by byte.

use std::{
    io,
    time::{Duration, Instant},
};

use anyhow::Context as _;
use testkit::amqp::{
    AMQP, AMQP_HEADER, NULL, SASL, SASL_HEADER, begin, described, frame, sasl_init, string,
};
use tokio::{
    io::{AsyncReadExt as _, AsyncWriteExt as _},
    time::timeout,
};

use super::super::{entrance::Wire, route::Route};
use crate::world::{OBSERVER, OBSERVER_PASSWORD};

/// Time in which the broker has to answer or to close.
const PATIENCE: Duration = Duration::from_secs(15);

// Codes of performatives (AMQP 1.0, part 2, 2.7).
const OPEN: u8 = 0x10;
const BEGIN: u8 = 0x11;
pub(super) const ATTACH: u8 = 0x12;
pub(super) const DISPOSITION: u8 = 0x15;
pub(super) const DETACH: u8 = 0x16;
pub(super) const END: u8 = 0x17;
pub(super) const CLOSE: u8 = 0x18;

/// One end of a connection.
pub(super) struct Peer(Box<dyn Wire>);

impl Peer {
    /// Connects, and says nothing yet.
    pub async fn connect(route: Route) -> anyhow::Result<Self> {
        Ok(Self(Box::new(route.connect().await?)))
    }

    /// Signs the observer in, opens the connection and begins a session.
    pub async fn open(route: Route) -> anyhow::Result<Self> {
        Self::open_as(route, OBSERVER, OBSERVER_PASSWORD).await
    }

    /// Does the same for another user.
    pub async fn open_as(route: Route, user: &str, password: &str) -> anyhow::Result<Self> {
        Self::open_on(Box::new(route.connect().await?), user, password).await
    }

    /// Signs in on an open connection.
    pub async fn open_on(wire: Box<dyn Wire>, user: &str, password: &str) -> anyhow::Result<Self> {
        let mut peer = Self(wire);
        let open = described(OPEN, &[string("probe")]);
        peer.send(SASL_HEADER).await;
        peer.send(&frame(SASL, 0, &sasl_init(user, password))).await;
        peer.send(AMQP_HEADER).await;
        peer.send(&frame(AMQP, 0, &open)).await;
        peer.send(&frame(AMQP, 0, &begin(NULL.to_vec()))).await;
        peer.header().await?;
        let (mechanisms, outcome) = (peer.read().await?, peer.read().await?);
        anyhow::ensure!(
            !mechanisms.is_empty() && outcome.get(2) == Some(&0x44),
            "no outcome of the sign-in"
        );
        peer.header().await?;
        peer.until(&[OPEN]).await?;
        peer.until(&[BEGIN]).await?;
        Ok(peer)
    }

    /// Reads a header of the protocol.
    pub async fn header(&mut self) -> anyhow::Result<()> {
        timeout(PATIENCE, self.0.read_exact(&mut [0; 8])).await??;
        Ok(())
    }

    /// Sends, if the other end still reads. Returns whether it does.
    pub async fn send(&mut self, bytes: &[u8]) -> bool {
        let sending = async {
            self.0.write_all(bytes).await?;
            self.0.flush().await
        };
        matches!(timeout(PATIENCE, sending).await, Ok(Ok(())))
    }

    /// Reads the body of a frame.
    pub async fn read(&mut self) -> io::Result<Vec<u8>> {
        let reading = async {
            let mut head = [0; 8];
            self.0.read_exact(&mut head).await?;
            let size = u32::from_be_bytes([head[0], head[1], head[2], head[3]]);
            let mut body = vec![0; (size as usize).saturating_sub(8)];
            self.0.read_exact(&mut body).await?;
            Ok(body)
        };
        timeout(PATIENCE, reading).await.map_err(|_| io::ErrorKind::TimedOut)?
    }

    /// Reads up to one of these performatives.
    pub async fn until(&mut self, codes: &[u8]) -> anyhow::Result<Vec<u8>> {
        loop {
            let body =
                self.read().await.with_context(|| format!("no performative {codes:02x?}"))?;
            if body.get(2).is_some_and(|code| codes.contains(code)) {
                return Ok(body);
            }
        }
    }

    /// Waits until the other end closes. Returns whether it said why.
    pub async fn closed(&mut self) -> anyhow::Result<bool> {
        let mut is_reasoned = false;
        let until = Instant::now() + PATIENCE;
        loop {
            match self.read().await {
                Ok(body) => is_reasoned |= body.get(2) == Some(&CLOSE),
                Err(error) if error.kind() == io::ErrorKind::TimedOut => {
                    anyhow::bail!("the connection is held open")
                }
                Err(_) => return Ok(is_reasoned),
            }
            anyhow::ensure!(Instant::now() < until, "frames come, and no end");
        }
    }
}
