//! Links to a foreign broker, and waiting with a deadline.

use std::{sync::Arc, time::Duration};

use asi_model::MessageId;
use messaging::{
    BrokerProfile, ClientIdentity, Envelope, Link, LinkConfig, LinkHandle, LogicalAddress, Login,
    Roots,
    definitions::{Account, BrokerPlan, QueueLimits},
    spool::memory::{AcceptedReports, MemorySpool},
    test_support::RecordingInbox,
};
use rcgen::{
    BasicConstraints, CertificateParams, DnType, ExtendedKeyUsagePurpose, IsCa, Issuer, KeyPair,
};
use tokio::task::JoinHandle;
use tokio_util::sync::CancellationToken;
use zeroize::Zeroizing;

/// A running link with a spool and inbox in memory.
pub struct TestLink {
    pub handle: LinkHandle,
    pub spool: Arc<MemorySpool>,
    pub inbox: Arc<RecordingInbox>,
    stop: CancellationToken,
    running: JoinHandle<()>,
}

impl TestLink {
    pub fn start(
        profile: BrokerProfile,
        url: &str,
        user: &str,
        password: &str,
        consumed: &[&str],
    ) -> Self {
        Self::start_trusting(None, profile, url, user, password, consumed)
    }

    pub fn start_trusting(
        root: Option<&str>,
        profile: BrokerProfile,
        url: &str,
        user: &str,
        password: &str,
        consumed: &[&str],
    ) -> Self {
        Self::start_showing(None, root, profile, url, user, password, consumed)
    }

    /// Starts a link that shows a certificate of its own.
    pub fn start_showing(
        identity: Option<ClientIdentity>,
        root: Option<&str>,
        profile: BrokerProfile,
        url: &str,
        user: &str,
        password: &str,
        consumed: &[&str],
    ) -> Self {
        let mut config =
            LinkConfig::new(url.parse().expect("a url"), Login::new(user, password), user);
        config.profile = profile;
        config.tls.identity = identity;
        if let Some(root) = root {
            config.tls.roots = Roots::Pem(root.to_owned().into_bytes().into());
        }
        // As the platform and the connectors do.
        config.has_session_per_address = user == "platform";
        config.consumed = consumed.iter().map(|a| address(a)).collect();
        config.limits.backoff_min = Duration::from_millis(100);
        config.limits.backoff_max = Duration::from_secs(1);
        config.limits.address_backoff = Duration::from_millis(300);
        let spool = Arc::new(MemorySpool::new(AcceptedReports::Leave));
        let inbox = Arc::new(RecordingInbox::default());
        let (store, receiver): (Arc<MemorySpool>, Arc<RecordingInbox>) =
            (Arc::clone(&spool), Arc::clone(&inbox));
        let (link, handle) = Link::new(config, store, receiver).expect("a link");
        let stop = CancellationToken::new();
        let running = tokio::spawn(link.run(stop.clone()));
        Self { handle, spool, inbox, stop, running }
    }

    pub fn send(&self, to: &str, id: &str) {
        self.spool.push(address(to), envelope(id));
        self.handle.wake();
    }

    pub fn send_under(&self, lease: u64, to: &str, id: &str) {
        let mut leased = envelope(id);
        leased.lease = Some(lease);
        leased.signature = Some(signature());
        self.spool.push(address(to), leased);
        self.handle.wake();
    }

    /// Counts the deliveries of a message, repeats included.
    pub fn deliveries_of(&self, id: &str) -> usize {
        self.inbox.ids().iter().filter(|seen| *seen == id).count()
    }

    pub fn has_received(&self, id: &str) -> bool {
        self.deliveries_of(id) > 0
    }

    /// The lease of a received message; none when the message was not received.
    pub fn lease_of(&self, id: &str) -> Option<Option<u64>> {
        let received = self.inbox.received.lock();
        let message_id = id.parse().ok();
        let delivery = received.iter().find(|(_, d)| d.envelope.message_id == message_id);
        delivery.map(|(_, d)| d.envelope.lease)
    }

    /// The signature of a received message.
    pub fn signature_of(&self, id: &str) -> Option<String> {
        let received = self.inbox.received.lock();
        let message_id = id.parse().ok();
        let delivery = received.iter().find(|(_, d)| d.envelope.message_id == message_id);
        delivery.and_then(|(_, d)| d.envelope.signature.clone())
    }

    pub fn reason(&self) -> String {
        self.handle.state().borrow().reason.clone().unwrap_or_default()
    }

    pub async fn stop(self) {
        self.stop.cancel();
        self.running.await.expect("the link ends");
    }
}

/// An authority that issues certificates to clients.
pub struct Authority {
    /// Its own certificate, as PEM.
    pub certificate: String,
    issuer: Issuer<'static, KeyPair>,
}

impl Authority {
    pub fn new(name: &str) -> Self {
        let key = KeyPair::generate().expect("a key");
        let mut params = CertificateParams::default();
        params.distinguished_name.push(DnType::CommonName, name);
        params.is_ca = IsCa::Ca(BasicConstraints::Unconstrained);
        let certificate = params.self_signed(&key).expect("a certificate").pem();
        Self { certificate, issuer: Issuer::new(params, key) }
    }

    /// A certificate for a client, with its key.
    pub fn identity(&self, name: &str) -> ClientIdentity {
        let key = KeyPair::generate().expect("a key");
        let mut params = CertificateParams::new(vec![name.to_owned()]).expect("a name");
        params.distinguished_name.push(DnType::CommonName, name);
        params.extended_key_usages = vec![ExtendedKeyUsagePurpose::ClientAuth];
        let certificate = params.signed_by(&key, &self.issuer).expect("signed");
        ClientIdentity {
            certificates_pem: certificate.pem().into_bytes().into(),
            key_pem: Zeroizing::new(key.serialize_pem().into_bytes()),
        }
    }
}

/// A text as long as a signature.
pub fn signature() -> String {
    format!("{}..{}", "A".repeat(320), "B".repeat(86))
}

pub fn envelope(id: &str) -> Envelope {
    Envelope::new(MessageId::new(id).expect("an id"), "test", "{}")
}

pub fn address(text: &str) -> LogicalAddress {
    text.parse().expect("an address")
}

/// Waits until a condition is true; panics after two minutes.
pub async fn eventually(what: &str, is_true: impl FnMut() -> bool) {
    testkit::wait::until(what, Duration::from_secs(120), is_true).await;
}

pub fn plan() -> BrokerPlan {
    let account = |name: &str| Account {
        user_name: name.to_owned(),
        password: format!("secret of {name}").into(),
    };
    BrokerPlan {
        platform: account("platform"),
        factories: ["f1", "f2"].map(|id| (id.parse().expect("an id"), account(id))).to_vec(),
        tools: Vec::new(),
        limits: QueueLimits::default(),
    }
}
