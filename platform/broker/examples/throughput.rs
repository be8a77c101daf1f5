//! Messages per second through the embedded broker: the link against a bare client with the same window, in one run.
//!
//! `cargo run --release -p broker --example throughput [MESSAGES]` prints rates and their ratio. The bare client keeps
//! the same number of messages under way but has no spool, no lanes and no supervision.

#![allow(clippy::print_stdout)]

use std::{
    sync::{
        Arc,
        atomic::{AtomicUsize, Ordering},
    },
    time::{Duration, Instant},
};

use anyhow::{Context, Result, ensure};
use asi_model::MessageId;
use async_trait::async_trait;
use broker::{Broker, BrokerConfig, BrokerHandle, BrokerUser, CredentialTable, Listener, QueueOptions};
use fe2o3_amqp::{
    Connection, Receiver, Sender, Session,
    link::receiver::CreditMode,
    sasl_profile::SaslProfile,
    types::messaging::{Body, Data, Header, Message},
    types::primitives::Value,
};
use futures::{StreamExt, stream::FuturesUnordered};
use messaging::{
    Delivery, Envelope, Inbox, Link, LinkConfig, LogicalAddress, Login, Settlement,
    spool::memory::{AcceptedReports, MemorySpool},
};
use tokio_util::sync::CancellationToken;

const WINDOW: usize = 500;
const BODY_BYTES: usize = 1024;
const SECRET: &str = "benchmark-secret";

struct Counting(AtomicUsize);

#[async_trait]
impl Inbox for Counting {
    async fn receive(&self, _address: &LogicalAddress, deliveries: Vec<Delivery>) -> Vec<Settlement> {
        self.0.fetch_add(deliveries.len(), Ordering::Relaxed);
        vec![Settlement::Accept; deliveries.len()]
    }
}

#[tokio::main]
async fn main() -> Result<()> {
    let messages = std::env::args().nth(1).map_or(Ok(50_000), |n| n.parse())?;
    let folder = tempfile::tempdir()?;
    let listener = Listener { address: ([127, 0, 0, 1], 0).into(), tls: None };
    let users = Arc::new(CredentialTable::new());
    let all = "#".parse::<broker::AddressPattern>()?;
    users.put("bench", BrokerUser::with_secret(SECRET.as_bytes()).may_consume(all.clone()).may_produce(all));
    let (broker, handle) = Broker::new(BrokerConfig::new(listener, folder.path().join("broker.db")), users).await?;
    let stop = CancellationToken::new();
    let running = tokio::spawn(broker.run(stop.clone()));
    for name in ["tool.bare.reports", "tool.link.reports"] {
        handle.declare_queue(&name.parse()?, QueueOptions::default()).await?;
    }
    let port = handle.local_addresses()[0].port();
    println!("{messages} messages of {BODY_BYTES} bytes, window {WINDOW}, embedded broker with full synchronisation");
    let bare = (send_bare(port, messages).await?, receive_bare(port, messages).await?);
    let link = (send_link(port, messages, &handle).await?, receive_link(port, messages).await?);
    for (what, bare, link) in [("send", bare.0, link.0), ("receive", bare.1, link.1)] {
        println!("{what:8} bare {bare:9.0}/s   link {link:9.0}/s   ratio {:.2}", link / bare);
    }
    stop.cancel();
    running.await??;
    Ok(())
}

#[allow(clippy::cast_precision_loss)]
fn rate(messages: usize, since: Instant) -> f64 {
    messages as f64 / since.elapsed().as_secs_f64()
}

async fn connect(port: u16) -> Result<fe2o3_amqp::connection::ConnectionHandle<()>> {
    let stream = tokio::net::TcpStream::connect(("127.0.0.1", port)).await?;
    stream.set_nodelay(true)?;
    let profile = SaslProfile::Plain { username: "bench".into(), password: SECRET.into() };
    Ok(Connection::builder().container_id("bare").sasl_profile(profile).open_with_stream(stream).await?)
}

async fn send_bare(port: u16, messages: usize) -> Result<f64> {
    let mut connection = connect(port).await?;
    let mut session = Session::begin(&mut connection).await?;
    let mut sender = Sender::attach(&mut session, "bare-out", "tool.bare.reports").await?;
    let started = Instant::now();
    let mut outcomes = FuturesUnordered::new();
    for _ in 0..messages {
        if outcomes.len() >= WINDOW {
            outcomes.next().await.context("an outcome")??;
        }
        let mut message = Message::from(Data::from(vec![b'x'; BODY_BYTES]));
        message.header = Some(Header { durable: true, ..Header::default() });
        outcomes.push(sender.send_batchable(message).await?);
    }
    while let Some(outcome) = outcomes.next().await {
        ensure!(outcome?.is_accepted(), "every message is accepted");
    }
    let rate = rate(messages, started);
    let _ = connection.close().await;
    Ok(rate)
}

async fn receive_bare(port: u16, messages: usize) -> Result<f64> {
    let mut connection = connect(port).await?;
    let mut session = Session::begin(&mut connection).await?;
    let credit = CreditMode::Auto(u32::try_from(WINDOW)?);
    let mut receiver = Receiver::builder()
        .name("bare-in")
        .source("tool.bare.reports")
        .credit_mode(credit)
        .attach(&mut session)
        .await?;
    let started = Instant::now();
    let mut batch = Vec::with_capacity(100);
    for n in 1..=messages {
        batch.push(receiver.recv::<Body<Value>>().await?);
        if batch.len() == 100 || n == messages {
            receiver.accept_all(batch.drain(..)).await?;
        }
    }
    let rate = rate(messages, started);
    let _ = connection.close().await;
    Ok(rate)
}

async fn send_link(port: u16, messages: usize, broker: &BrokerHandle) -> Result<f64> {
    let spool = Arc::new(MemorySpool::new(AcceptedReports::Leave));
    let to: LogicalAddress = "tool.link.reports".parse()?;
    for n in 0..messages {
        spool.push(to.clone(), Envelope::new(MessageId::new(format!("m{n}"))?, "bench", vec![b'x'; BODY_BYTES]));
    }
    let (link, _handle) =
        Link::new(config(port)?, Arc::<MemorySpool>::clone(&spool), Arc::new(Counting(AtomicUsize::new(0))))?;
    let stop = CancellationToken::new();
    let started = Instant::now();
    let running = tokio::spawn(link.run(stop.clone()));
    wait(|| spool.waiting() == 0).await?;
    let rate = rate(messages, started);
    ensure!(
        broker.queue(&"tool.link.reports".parse()?).is_some_and(|q| q.ready as usize == messages),
        "all are stored"
    );
    stop.cancel();
    running.await?;
    Ok(rate)
}

async fn receive_link(port: u16, messages: usize) -> Result<f64> {
    let inbox = Arc::new(Counting(AtomicUsize::new(0)));
    let mut config = config(port)?;
    config.consumed = vec!["tool.link.reports".parse()?];
    let spool = Arc::new(MemorySpool::new(AcceptedReports::Leave));
    let (link, _handle) = Link::new(config, spool, Arc::<Counting>::clone(&inbox))?;
    let stop = CancellationToken::new();
    let started = Instant::now();
    let running = tokio::spawn(link.run(stop.clone()));
    wait(|| inbox.0.load(Ordering::Relaxed) >= messages).await?;
    let rate = rate(messages, started);
    stop.cancel();
    running.await?;
    Ok(rate)
}

fn config(port: u16) -> Result<LinkConfig> {
    Ok(LinkConfig::new(format!("amqp://127.0.0.1:{port}").parse()?, Login::new("bench", SECRET), "bench"))
}

async fn wait(mut is_done: impl FnMut() -> bool) -> Result<()> {
    let deadline = Instant::now() + Duration::from_secs(300);
    while !is_done() {
        ensure!(Instant::now() < deadline, "not in time");
        tokio::time::sleep(Duration::from_millis(2)).await;
    }
    Ok(())
}
