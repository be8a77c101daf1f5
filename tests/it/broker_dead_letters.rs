//! Messages that a broker of another make sets aside: the platform takes them, and says why.

use std::{sync::Arc, time::Duration};

use messaging::{
    Envelope, Link, LinkConfig, LinkHandle, LinkState, Settlement,
    spool::memory::{AcceptedReports, MemorySpool},
    test_support::RecordingInbox,
};
use platform::clock::Clock;
use serde_json::{Value, json};
use tokio_util::{sync::CancellationToken, task::AbortOnDropHandle};
use verbund_tests::{
    harness::{Api, eventually},
    world::{BrokerKind, ExternalBroker, Places, TOOL, World},
};

const PATIENCE: Duration = Duration::from_secs(60);
/// Time within which RabbitMQ counts again what is in its queues.
const COUNTED_WITHIN: Duration = Duration::from_secs(6);

/// One who sends and reads at the broker beside the programs.
struct Bystander {
    spool: Arc<MemorySpool>,
    inbox: Arc<RecordingInbox>,
    handle: LinkHandle,
    _running: AbortOnDropHandle<()>,
}

impl Bystander {
    async fn start(config: LinkConfig) -> Self {
        let spool = Arc::new(MemorySpool::new(AcceptedReports::Leave));
        let inbox = Arc::<RecordingInbox>::default();
        let (store, receiver): (Arc<MemorySpool>, Arc<RecordingInbox>) =
            (Arc::clone(&spool), Arc::clone(&inbox));
        let (link, handle) = Link::new(config, store, receiver).unwrap();
        let running = AbortOnDropHandle::new(tokio::spawn(link.run(CancellationToken::new())));
        let mut state = handle.state();
        state.wait_for(LinkState::is_up).await.unwrap();
        Self { spool, inbox, handle, _running: running }
    }

    fn send_to_the_tool(&self, id: &str, ttl: Option<Duration>) {
        let creation_time = Some(Clock::system().now().into());
        let message =
            Envelope { ttl, creation_time, ..Envelope::new(id.parse().unwrap(), "test", "{}") };
        self.spool.push(format!("tool.{TOOL}.reports").parse().unwrap(), message);
        self.handle.wake();
    }
}

/// Waits until the platform shows a message as a dead letter.
async fn shown(platform: &Api, message_id: &str) -> Value {
    eventually("the dead letter is shown", PATIENCE, || async {
        let letters = platform.list("/api/v1/dead-letters").await.map_err(|e| format!("{e:#}"))?;
        let found = letters.iter().find(|letter| letter["messageId"] == message_id).cloned();
        found.ok_or_else(|| format!("{letters:?}"))
    })
    .await
    .unwrap()
}

#[tokio::test(flavor = "multi_thread")]
async fn what_rabbitmq_sets_aside_is_taken_and_shown_with_the_reason() {
    rustls::crypto::ring::default_provider().install_default().ok();
    let folder = tempfile::tempdir().unwrap();
    let places = Places::anywhere(folder.path().to_owned()).unwrap();
    let external = ExternalBroker::start(BrokerKind::RabbitMq).await.unwrap();
    let (sends, reads) = (external.link_of_platform().unwrap(), external.link_of_tool().unwrap());
    let mut world = World::start_beside(places, Some(external)).unwrap();
    let platform = world.platform_api().await.unwrap();
    let sender = Bystander::start(sends).await;

    // There is no reader yet.
    sender.send_to_the_tool("late", Some(Duration::from_secs(3)));
    let late = shown(&platform, "late").await;
    assert_eq!(late["bytes"], 0, "whose it was is not known, so its content is not kept");
    assert_eq!((&late["code"], &late["address"]), (&json!("EXPIRED"), &json!("dead-letters")));

    let reader = Bystander::start(reads).await;
    reader.inbox.answer("refused", Settlement::reject("NO_USE", "It is of no use."));
    sender.send_to_the_tool("refused", None);
    let refused = shown(&platform, "refused").await;
    assert_eq!(refused["code"], "SET_ASIDE_BY_BROKER");
    assert_eq!(reader.inbox.ids(), ["refused"], "what has expired is not delivered");

    tokio::time::sleep(COUNTED_WITHIN).await;
    let broker = world.external.as_ref().unwrap();
    assert_eq!(broker.messages_in("dead-letters"), Some(0), "nothing waits for a reader");

    // The broker does not say whose it was, so it cannot be taken as if it came now.
    let path = format!("/api/v1/dead-letters/{}/replay", late["id"].as_str().unwrap());
    let replayed: Value = platform.post(&path, &json!({})).await.unwrap();
    assert_eq!(replayed["isTaken"], false);
    let letters = platform.list("/api/v1/dead-letters").await.unwrap();
    assert_eq!(letters.len(), 2, "{letters:?}");
    world.stop().unwrap();
}
