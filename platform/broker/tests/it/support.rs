//! A broker, links to it, and waiting with a deadline.

use std::{
    path::Path,
    sync::{Arc, Once},
    time::Duration,
};

use asi_model::MessageId;
use broker::{
    AddressPattern, Broker, BrokerConfig, BrokerHandle, BrokerUser, Carrier, CredentialTable,
    Listener, QueueName, QueueOptions, TlsIdentity,
};
use messaging::{
    Envelope, Link, LinkConfig, LinkHandle, LinkLimits, LogicalAddress, Login,
    spool::memory::{AcceptedReports, MemorySpool},
    test_support::RecordingInbox,
};
use tokio::task::JoinHandle;
use tokio_util::sync::CancellationToken;

pub const SECRET: &str = "a-secret-of-much-entropy";
static LOGS: Once = Once::new();

/// Prints logs when `RUST_LOG` asks for them.
pub fn logs() {
    LOGS.call_once(|| {
        tracing_subscriber::fmt()
            .with_env_filter(tracing_subscriber::EnvFilter::from_default_env())
            .with_test_writer()
            .init();
    });
}

/// Waits until something holds, or fails saying what did not.
pub async fn eventually(what: &str, holds: impl FnMut() -> bool) {
    testkit::wait::until(what, Duration::from_secs(20), holds).await;
}

pub fn queue(name: &str) -> QueueName {
    name.parse().expect("a queue name")
}

pub fn address(name: &str) -> LogicalAddress {
    name.parse().expect("an address")
}

pub fn pattern(text: &str) -> AddressPattern {
    text.parse().expect("a pattern")
}

pub fn envelope(id: impl ToString, body: impl Into<bytes::Bytes>) -> Envelope {
    Envelope::new(MessageId::new(id.to_string()).expect("an id"), "test", body)
}

/// A broker in this process with the users `platform` (everything) and `f1` (its own addresses).
pub struct TestBroker {
    pub handle: BrokerHandle,
    pub users: Arc<CredentialTable>,
    stop: CancellationToken,
    running: JoinHandle<()>,
}

impl TestBroker {
    pub async fn start(folder: &Path) -> Self {
        Self::start_with(folder, |_| {}).await
    }

    pub async fn start_with(folder: &Path, change: impl FnOnce(&mut BrokerConfig)) -> Self {
        logs();
        let listener =
            Listener { address: ([127, 0, 0, 1], 0).into(), tls: None, carrier: Carrier::Stream };
        let mut config = BrokerConfig::new(listener, folder.join("broker.db"));
        config.auto_created = vec![pattern("factory.*.ingress"), pattern("factory.*.requests")];
        change(&mut config);
        let users = Arc::new(CredentialTable::new());
        users.put(
            "platform",
            BrokerUser::with_secret(SECRET.as_bytes())
                .may_consume(pattern("#"))
                .may_produce(pattern("#")),
        );
        users.put(
            "f1",
            BrokerUser::with_secret(SECRET.as_bytes())
                .may_consume(pattern("factory.f1.requests"))
                .may_produce(pattern("factory.f1.ingress")),
        );
        let credentials: Arc<CredentialTable> = Arc::clone(&users);
        let (broker, handle) = Broker::new(config, credentials).await.expect("a broker");
        let stop = CancellationToken::new();
        let running = tokio::spawn({
            let stop = stop.clone();
            async move { broker.run(stop).await.expect("runs to its end") }
        });
        Self { handle, users, stop, running }
    }

    pub fn port(&self) -> u16 {
        self.handle.local_addresses()[0].port()
    }

    /// Returns the port of the listener that [`with_websockets`] adds.
    pub fn websocket_port(&self) -> u16 {
        self.handle.local_addresses()[1].port()
    }

    pub fn url(&self) -> String {
        format!("amqp://127.0.0.1:{}", self.port())
    }

    pub async fn declare(&self, name: &str) {
        self.handle.declare_queue(&queue(name), QueueOptions::default()).await.expect("declared");
    }

    pub fn ready(&self, name: &str) -> u64 {
        self.handle.queue(&queue(name)).map_or(0, |q| q.ready)
    }

    /// Ends in order.
    pub async fn stop(self) {
        self.stop.cancel();
        self.running.await.expect("the broker ends");
    }
}

/// A link with a spool in memory and an inbox that remembers.
pub struct TestLink {
    pub handle: LinkHandle,
    pub spool: Arc<MemorySpool>,
    pub inbox: Arc<RecordingInbox>,
    stop: CancellationToken,
    running: JoinHandle<()>,
}

impl TestLink {
    pub fn start(url: &str, user: &str, consumed: &[&str]) -> Self {
        Self::start_with(url, user, consumed, AcceptedReports::Leave, |_| {})
    }

    pub fn start_with(
        url: &str,
        user: &str,
        consumed: &[&str],
        accepted: AcceptedReports,
        change: impl FnOnce(&mut LinkConfig),
    ) -> Self {
        logs();
        let login = Login::new(user, SECRET);
        let mut config =
            LinkConfig::new(url.parse().expect("a url"), login, format!("test-{user}"));
        config.consumed = consumed.iter().map(|name| address(name)).collect();
        config.limits = LinkLimits {
            backoff_min: Duration::from_millis(50),
            backoff_max: Duration::from_millis(500),
            backoff_permanent: Duration::from_secs(5),
            address_backoff: Duration::from_millis(100),
            ..LinkLimits::default()
        };
        change(&mut config);
        let spool = Arc::new(MemorySpool::new(accepted));
        let inbox = Arc::new(RecordingInbox::default());
        let (store, receiver): (Arc<MemorySpool>, Arc<RecordingInbox>) =
            (Arc::clone(&spool), Arc::clone(&inbox));
        let (link, handle) = Link::new(config, store, receiver).expect("a link");
        let stop = CancellationToken::new();
        let running = tokio::spawn(link.run(stop.clone()));
        Self { handle, spool, inbox, stop, running }
    }

    pub fn send(&self, to: &str, envelope: Envelope) {
        self.spool.push(address(to), envelope);
        self.handle.wake();
    }

    pub async fn up(&self) {
        let state = self.handle.state();
        eventually("the link is up", || state.borrow().is_up()).await;
    }

    pub fn reason(&self) -> String {
        self.handle.state().borrow().reason.clone().unwrap_or_default()
    }

    pub async fn stop(self) {
        self.stop.cancel();
        self.running.await.expect("the link ends");
    }
}

/// Listens for WebSockets, too, with the same certificate.
pub fn with_websockets(config: &mut BrokerConfig) {
    let tls = config.listeners[0].tls.clone();
    config.listeners.push(Listener {
        address: ([127, 0, 0, 1], 0).into(),
        tls,
        carrier: Carrier::WebSocket,
    });
}

/// Makes a certificate for localhost and its authority, as PEM.
pub fn certificate() -> (TlsIdentity, bytes::Bytes) {
    let certified =
        rcgen::generate_simple_self_signed(["localhost".to_owned()]).expect("a certificate");
    let pem = bytes::Bytes::from(certified.cert.pem());
    let identity = TlsIdentity {
        certificates_pem: pem.clone(),
        key_pem: bytes::Bytes::from(certified.signing_key.serialize_pem()),
    };
    (identity, pem)
}
