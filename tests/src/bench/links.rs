//! Messages per second through the link to each kind of broker, beside a bare client of the same
//! library with the same window in the same run: no spool, no lanes, no supervision. And the memory
//! of link and embedded broker over a million messages.

mod bare_amqp;
mod bare_mqtt;
mod broker_under_test;
mod made_up;

use std::{
    sync::Arc,
    time::{Duration, Instant},
};

use anyhow::Context as _;
use messaging::{Link, LinkConfig, LogicalAddress, Login};
use serde_json::Value;
use tokio_util::sync::CancellationToken;

use self::{
    broker_under_test::{Account, BrokerUnderTest, MESSAGES, Protocol, WINDOW},
    made_up::{Counting, MadeUpSpool},
};
use super::{
    figures::{figure, result},
    part::Part,
    usage::Usage,
};
use crate::harness::until;

/// Times that each is measured; the fastest counts, for disturbances only slow down.
const ROUNDS: usize = 3;
/// Messages over which memory must not grow, and when it is looked at first.
const MANY: u64 = 1_000_000;
const WARM: u64 = 200_000;
/// Messages that wait in the broker meanwhile, at most.
const BACKLOG: u64 = 20_000;
const PATIENCE: Duration = Duration::from_secs(600);

/// Measures all brokers, one after the other.
pub(super) async fn measure() -> anyhow::Result<Vec<Value>> {
    let mut results = Vec::new();
    for broker in [
        BrokerUnderTest::embedded().await?,
        BrokerUnderTest::rabbitmq().await,
        BrokerUnderTest::mosquitto().await,
    ] {
        results.extend(rates(&broker).await?);
        broker.stop().await?;
    }
    results.extend(Part::Traffic.measure().await?);
    Ok(results)
}

/// Sending and receiving, bare and through the link.
async fn rates(broker: &BrokerUnderTest) -> anyhow::Result<Vec<Value>> {
    subscribe(broker).await?;
    let (mut bare, mut link) = ((0.0_f64, 0.0_f64), (0.0_f64, 0.0_f64));
    for _ in 0..ROUNDS {
        let round = match broker.protocol {
            Protocol::Amqp => (bare_amqp::send(broker).await?, bare_amqp::receive(broker).await?),
            Protocol::Mqtt => (bare_mqtt::send(broker).await?, bare_mqtt::receive(broker).await?),
        };
        bare = (bare.0.max(rate(round.0)), bare.1.max(rate(round.1)));
        let round = (link_send(broker).await?, link_receive(broker).await?);
        link = (link.0.max(rate(round.0)), link.1.max(rate(round.1)));
    }
    let name = broker.name;
    let mut results = Vec::new();
    for (what, bare, link) in [("sent to", bare.0, link.0), ("received from", bare.1, link.1)] {
        results.push(result(&format!("{what} {name}, bare client"), bare, "messages per second"));
        results.push(result(&format!("{what} {name}, link"), link, "messages per second"));
        results.push(result(
            &format!("{what} {name}, link against bare client"),
            link / bare,
            "times",
        ));
    }
    Ok(results)
}

fn rate(took: Duration) -> f64 {
    MESSAGES as f64 / took.as_secs_f64()
}

/// Measures from before the connection to the last outcome, as of the bare client.
async fn link_send(broker: &BrokerUnderTest) -> anyhow::Result<Duration> {
    let spool = Arc::new(MadeUpSpool::new(MESSAGES, broker.address.clone()));
    let began = Instant::now();
    let sender =
        RunningLink::start(broker, &broker.sender, &[], Arc::clone(&spool), Arc::default())?;
    until("everything is sent", PATIENCE, || spool.finished().is_some()).await?;
    sender.stop().await?;
    let finished = spool.finished().context("everything was sent")?;
    Ok(finished.duration_since(began))
}

/// Measures from before the connection to the last message, as of the bare client.
async fn link_receive(broker: &BrokerUnderTest) -> anyhow::Result<Duration> {
    let inbox = Arc::new(Counting::expecting(MESSAGES));
    let began = Instant::now();
    let receiver = receiving_link(broker, &inbox)?;
    until("everything is received", PATIENCE, || inbox.finished().is_some()).await?;
    // Settlements are on their way still.
    tokio::time::sleep(Duration::from_millis(300)).await;
    receiver.stop().await?;
    let finished = inbox.finished().context("everything was received")?;
    Ok(finished.duration_since(began))
}

/// MQTT stores messages only for clients that have subscribed before.
async fn subscribe(broker: &BrokerUnderTest) -> anyhow::Result<()> {
    let receiver = receiving_link(broker, &Arc::default())?;
    until("the subscription is there", PATIENCE, || receiver.is_up()).await?;
    receiver.stop().await
}

fn receiving_link(broker: &BrokerUnderTest, inbox: &Arc<Counting>) -> anyhow::Result<RunningLink> {
    let nothing = Arc::new(MadeUpSpool::new(0, broker.address.clone()));
    let consumed = [broker.address.clone()];
    RunningLink::start(broker, &broker.receiver, &consumed, nothing, Arc::clone(inbox))
}

/// Both ends of the link and the embedded broker are in this process, which does nothing else: its
/// memory is theirs. Measured in batches; every one beyond the first may take no more than the
/// first did.
pub(super) async fn traffic() -> anyhow::Result<Vec<Value>> {
    let broker = BrokerUnderTest::embedded().await?;
    let inbox = Arc::new(Counting::default());
    let spool =
        MadeUpSpool::new(MANY, broker.address.clone()).ahead_of(Arc::clone(&inbox), BACKLOG);
    let receiver = receiving_link(&broker, &inbox)?;
    let began = Instant::now();
    let sender = RunningLink::start(&broker, &broker.sender, &[], Arc::new(spool), Arc::default())?;
    let (mut early, mut highest) = (0.0, 0.0_f64);
    for batch in 1..=MANY / WARM {
        until("a batch is received", PATIENCE, || {
            sender.handle.wake();
            inbox.received() >= batch * WARM
        })
        .await?;
        let resident = Usage::of(std::process::id())?.resident_bytes as f64;
        highest = highest.max(resident);
        if batch == 1 {
            early = resident;
        }
    }
    let took = began.elapsed();
    sender.stop().await?;
    receiver.stop().await?;
    broker.stop().await?;
    let megabyte = 1024.0 * 1024.0;
    Ok(vec![
        figure(
            "through the embedded broker, a million messages",
            MANY as f64 / took.as_secs_f64(),
            "messages per second",
        ),
        figure("memory of link and broker after 200 000 messages", early / megabyte, "MiB"),
        figure("the most memory up to a million messages", highest / megabyte, "MiB"),
        figure(
            "the most memory up to a million messages against 200 000",
            highest / early,
            "times",
        ),
    ])
}

struct RunningLink {
    handle: messaging::LinkHandle,
    stop: CancellationToken,
    running: tokio::task::JoinHandle<()>,
}

impl RunningLink {
    fn start(
        broker: &BrokerUnderTest,
        account: &Account,
        consumed: &[LogicalAddress],
        spool: Arc<MadeUpSpool>,
        inbox: Arc<Counting>,
    ) -> anyhow::Result<Self> {
        let login = Login::new(&account.user_name, &account.password);
        let mut config = LinkConfig::new(broker.url.parse()?, login, &account.user_name);
        config.profile = broker.profile.clone();
        config.consumed = consumed.to_vec();
        config.limits.window = usize::from(WINDOW);
        config.limits.credit = u32::from(WINDOW);
        let (link, handle) = Link::new(config, spool, inbox)?;
        let stop = CancellationToken::new();
        let running = tokio::spawn(link.run(stop.clone()));
        Ok(Self { handle, stop, running })
    }

    fn is_up(&self) -> bool {
        self.handle.state().borrow().is_up()
    }

    async fn stop(self) -> anyhow::Result<()> {
        self.stop.cancel();
        Ok(self.running.await?)
    }
}
