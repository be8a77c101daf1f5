//! Links to a foreign broker, and waiting with a deadline.

use std::{
    sync::Arc,
    time::{Duration, Instant},
};

use asi_model::MessageId;
use messaging::{
    BrokerProfile, Envelope, Link, LinkConfig, LinkHandle, LogicalAddress, Login, Roots,
    definitions::{Account, Plan, QueueLimits},
    spool::memory::{AcceptedReports, MemorySpool},
    test_support::RecordingInbox,
};
use tokio::task::JoinHandle;
use tokio_util::sync::CancellationToken;

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
        let mut config =
            LinkConfig::new(url.parse().expect("a url"), Login::new(user, password), user);
        config.profile = profile;
        if let Some(root) = root {
            config.tls.roots = Roots::Pem(root.to_owned().into_bytes().into());
        }
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
        self.spool.push(address(to), leased);
        self.handle.wake();
    }

    pub fn reason(&self) -> String {
        self.handle.state().borrow().reason.clone().unwrap_or_default()
    }

    pub async fn stop(self) {
        self.stop.cancel();
        self.running.await.expect("the link ends");
    }
}

pub fn envelope(id: &str) -> Envelope {
    Envelope::new(MessageId::new(id).expect("an id"), "test", "{}")
}

pub fn address(text: &str) -> LogicalAddress {
    text.parse().expect("an address")
}

pub async fn eventually(what: &str, mut holds: impl FnMut() -> bool) {
    let deadline = Instant::now() + Duration::from_secs(120);
    while !holds() {
        assert!(Instant::now() < deadline, "not in time: {what}");
        tokio::time::sleep(Duration::from_millis(10)).await;
    }
}

pub fn plan() -> Plan {
    let account = |name: &str| Account {
        user_name: name.to_owned(),
        password: format!("secret of {name}").into(),
    };
    Plan {
        platform: account("platform"),
        factories: ["f1", "f2"].map(|id| (id.parse().expect("an id"), account(id))).to_vec(),
        tools: Vec::new(),
        limits: QueueLimits::default(),
    }
}
