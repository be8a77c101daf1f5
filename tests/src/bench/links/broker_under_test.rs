//! The brokers, each with one address, one account that sends to it and one that receives from it.

use std::sync::Arc;

use anyhow::Context as _;
use broker::{
    Broker, BrokerConfig, BrokerHandle, BrokerUser, Carrier, CredentialTable, Listener,
    QueueOptions,
};
use messaging::{
    BrokerProfile, LogicalAddress,
    definitions::{self, BrokerPlan, QueueLimits, rabbitmq_definitions},
    test_support::{Mosquitto, RabbitMq, Saving},
};
use tokio::task::JoinHandle;
use tokio_util::sync::CancellationToken;

const FACTORY: &str = "f1";
const PLATFORM: &str = "platform";

/// Messages of each measurement, and bytes of each.
pub(super) const MESSAGES: u64 = 60_000;
pub(super) const BODY_BYTES: usize = 1024;
/// Messages under way, of link and bare client alike.
pub(super) const WINDOW: u16 = 500;

/// Protocol of a broker.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Protocol {
    Amqp,
    Mqtt,
}

/// Account with the rights of a factory.
pub(super) struct Account {
    pub user_name: String,
    pub password: String,
}

pub(super) struct BrokerUnderTest {
    pub name: &'static str,
    pub protocol: Protocol,
    pub profile: BrokerProfile,
    pub url: String,
    pub address: LogicalAddress,
    pub sender: Account,
    pub receiver: Account,
    process: Process,
}

/// Ends with this.
enum Process {
    Embedded {
        _folder: tempfile::TempDir,
        stop: CancellationToken,
        running: JoinHandle<anyhow::Result<()>>,
    },
    RabbitMq(#[expect(dead_code, reason = "held until the end")] RabbitMq),
    Mosquitto(#[expect(dead_code, reason = "held until the end")] Mosquitto),
}

impl BrokerUnderTest {
    /// Starts the platform's own broker with full synchronisation, in this process.
    pub(super) async fn embedded() -> anyhow::Result<Self> {
        let folder = tempfile::tempdir()?;
        let listener =
            Listener { address: ([127, 0, 0, 1], 0).into(), tls: None, carrier: Carrier::Stream };
        let users = Arc::new(CredentialTable::new());
        let (sender, receiver) = accounts();
        let queue = address().to_string();
        let user = |account: &Account| BrokerUser::with_secret(account.password.as_bytes());
        users.put(&sender.user_name, user(&sender).may_produce(queue.parse()?));
        users.put(&receiver.user_name, user(&receiver).may_consume(queue.parse()?));
        let (broker, handle) =
            Broker::new(BrokerConfig::new(listener, folder.path().join("broker.db")), users)
                .await?;
        let stop = CancellationToken::new();
        let shutdown = stop.clone();
        let running = tokio::spawn(async move { Ok(broker.run(shutdown).await?) });
        handle.declare_queue(&queue.parse()?, QueueOptions::default()).await?;
        let url = format!("amqp://127.0.0.1:{}", port(&handle)?);
        let process = Process::Embedded { _folder: folder, stop, running };
        Ok(Self::new(
            "the embedded broker",
            Protocol::Amqp,
            BrokerProfile::embedded(),
            url,
            process,
        ))
    }

    /// RabbitMQ with its AMQP 1.0 plugin.
    pub(super) async fn rabbitmq() -> Self {
        let broker = RabbitMq::start(&rabbitmq_definitions(&plan(), "/", rand::random)).await;
        let url = broker.url();
        Self::new(
            "RabbitMQ 3",
            Protocol::Amqp,
            BrokerProfile::rabbitmq_3(),
            url,
            Process::RabbitMq(broker),
        )
    }

    /// Mosquitto.
    pub(super) async fn mosquitto() -> Self {
        let broker = Mosquitto::start(&plan(), Saving::AtTheEnd).await;
        let url = broker.url();
        Self::new(
            "Mosquitto",
            Protocol::Mqtt,
            BrokerProfile::mqtt(),
            url,
            Process::Mosquitto(broker),
        )
    }

    fn new(
        name: &'static str,
        protocol: Protocol,
        profile: BrokerProfile,
        url: String,
        process: Process,
    ) -> Self {
        let (sender, receiver) = accounts();
        Self { name, protocol, profile, url, address: address(), sender, receiver, process }
    }

    /// Host and port.
    pub(super) fn endpoint(&self) -> anyhow::Result<(&str, u16)> {
        let (_, endpoint) = self.url.split_once("://").context("a url has a scheme")?;
        let (host, port) = endpoint.split_once(':').context("a url has a port")?;
        Ok((host, port.parse()?))
    }

    pub(super) async fn stop(self) -> anyhow::Result<()> {
        if let Process::Embedded { stop, running, .. } = self.process {
            stop.cancel();
            running.await??;
        }
        Ok(())
    }
}

fn port(handle: &BrokerHandle) -> anyhow::Result<u16> {
    Ok(handle.local_addresses().first().context("it listens")?.port())
}

fn address() -> LogicalAddress {
    LogicalAddress::FactoryIngress(FACTORY.parse().expect("an id"))
}

fn accounts() -> (Account, Account) {
    let account =
        |name: &str| Account { user_name: name.to_owned(), password: format!("secret of {name}") };
    (account(FACTORY), account(PLATFORM))
}

fn plan() -> BrokerPlan {
    let (sender, receiver) = accounts();
    let of = |account: Account| definitions::Account {
        user_name: account.user_name,
        password: account.password.into(),
    };
    let factories = vec![(FACTORY.parse().expect("an id"), of(sender))];
    BrokerPlan {
        platform: of(receiver),
        factories,
        tools: Vec::new(),
        limits: QueueLimits::default(),
    }
}
