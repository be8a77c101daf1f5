//! Quota and expiry of foreign brokers, and what becomes of their disk.

use std::time::Duration;

use asi_model::MessageId;
use messaging::{
    BrokerProfile, Envelope,
    definitions::{BrokerPlan, QueueLimits, rabbitmq_definitions},
    test_support::{Mosquitto, RabbitMq, Saving},
};

use crate::support::{TestLink, address, eventually, plan};

const QUEUE: &str = "factory.f1.requests";
/// Bytes of one body.
const BODY: usize = 100_000;
const COUNT: usize = 60;

fn bounded(bytes_max: u64) -> BrokerPlan {
    BrokerPlan { limits: QueueLimits { bytes_max, ..QueueLimits::default() }, ..plan() }
}

/// Pushes messages that cannot be compressed much.
#[expect(
    clippy::disallowed_methods,
    reason = "brokers count the age of messages by the machine's clock"
)]
fn fill(platform: &TestLink, name: &str, ttl: Option<Duration>) {
    for at in 0..COUNT {
        let body: Vec<u8> = (0..BODY).map(|_| rand::random()).collect();
        let id = MessageId::new(format!("{name}{at}")).expect("an id");
        let creation_time = Some(time::OffsetDateTime::now_utc());
        let message = Envelope { ttl, creation_time, ..Envelope::new(id, "test", body) };
        platform.spool.push(address(QUEUE), message);
    }
    platform.handle.wake();
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn mosquitto_bounds_what_waits_by_its_bytes_and_its_file_shrinks() {
    // A third of what comes: the platform has three topics, which count together.
    let broker = Mosquitto::start(&bounded((BODY * COUNT / 9) as u64), Saving::Always).await;
    let start = |user: &str, consumed: &[&str]| {
        let password = format!("secret of {user}");
        TestLink::start(BrokerProfile::mqtt(), &broker.url(), user, &password, consumed)
    };
    let subscribe = || async {
        let factory = start("f1", &[QUEUE]);
        let mut state = factory.handle.state();
        state.wait_for(messaging::LinkState::is_up).await.expect("the link runs");
        // Its subscription has no answer that shows here.
        tokio::time::sleep(Duration::from_secs(1)).await;
        factory
    };
    subscribe().await.stop().await;
    let platform = start("platform", &[]);

    fill(&platform, "kept", None);
    eventually("all are accepted", || platform.spool.waiting() == 0).await;
    let quota = (BODY * COUNT / 3) as u64;
    eventually("what waits is stored", || broker.bytes_stored() > quota / 2).await;
    tokio::time::sleep(Duration::from_secs(3)).await;
    let stored = broker.bytes_stored();
    assert!(stored < quota * 2, "{stored} bytes are stored with a quota of {quota}");
    let factory = subscribe().await;
    eventually("what waited arrives", || factory.inbox.ids().len() >= COUNT / 4).await;
    eventually("the file shrinks", || broker.bytes_stored() < quota / 4).await;
    assert!(factory.inbox.ids().len() < COUNT, "what was beyond the quota was dropped");
    factory.stop().await;

    fill(&platform, "short", Some(Duration::from_secs(5)));
    eventually("all are accepted", || platform.spool.waiting() == 0).await;
    eventually("what waits is stored", || broker.bytes_stored() > quota / 2).await;
    tokio::time::sleep(Duration::from_secs(6)).await;
    // It looks for what has expired when the client comes again.
    let factory = subscribe().await;
    eventually("the file shrinks", || broker.bytes_stored() < quota / 4).await;
    assert!(factory.inbox.ids().is_empty(), "what has expired is not delivered");
    factory.stop().await;
    platform.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn rabbitmq_refuses_beyond_the_quota_and_its_files_shrink() {
    let quota = (BODY * COUNT / 3) as u64;
    let broker = RabbitMq::start(&rabbitmq_definitions(&bounded(quota), "/", rand::random)).await;
    let start = |user: &str, consumed: &[&str]| {
        let password = format!("secret of {user}");
        TestLink::start(BrokerProfile::rabbitmq_3(), &broker.url(), user, &password, consumed)
    };
    let empty = broker.bytes_stored();
    // It reads the dead letters, as the platform does.
    let platform = start("platform", &["dead-letters"]);
    // The limit is one for those that come later: of what is on its way at the same time more may be accepted.
    fill(&platform, "first", None);
    eventually("the quota is used up", || platform.spool.waiting() <= COUNT * 2 / 3).await;
    // There is nothing to observe of what is refused again and again.
    tokio::time::sleep(Duration::from_secs(5)).await;
    let refused = platform.spool.waiting();
    fill(&platform, "second", None);
    tokio::time::sleep(Duration::from_secs(5)).await;
    let waiting = platform.spool.waiting();
    assert_eq!(waiting, refused + COUNT, "what comes beyond the quota is refused");
    let full = broker.bytes_stored();
    let factory = start("f1", &[QUEUE]);
    eventually("all arrive", || factory.inbox.ids().len() >= 2 * COUNT).await;
    eventually("none waits", || platform.spool.waiting() == 0).await;
    // What has arrived is settled a moment later; until then it would take the room of what comes, and never expire.
    eventually("the queue is empty", || broker.messages_in(QUEUE) == 0).await;
    factory.stop().await;
    fill(&platform, "short", Some(Duration::from_secs(5)));
    eventually("all are accepted", || platform.spool.waiting() == 0).await;
    // Expired messages of quorum queues become dead letters, within the quota of that queue.
    eventually("dead letters arrive", || platform.inbox.ids().len() >= COUNT / 4).await;
    // The last were accepted only once there was room, and live as long.
    tokio::time::sleep(Duration::from_secs(6)).await;
    let factory = start("f1", &[QUEUE]);
    tokio::time::sleep(Duration::from_secs(1)).await;
    assert!(factory.inbox.ids().is_empty(), "what has expired is not delivered");
    assert!(full > empty + quota / 2, "{empty} empty, {full} full");
    // The log of all queues is rolled over by what comes later, and with it go the files of what is gone.
    let mut stored = broker.bytes_stored();
    for round in 0..10 {
        if stored < full / 2 {
            break;
        }
        fill(&platform, &format!("later{round}-"), None);
        let arrived = COUNT * (round + 1);
        eventually("all arrive", || factory.inbox.ids().len() >= arrived).await;
        tokio::time::sleep(Duration::from_secs(3)).await;
        stored = broker.bytes_stored();
    }
    assert!(stored < full / 2, "{stored} bytes are stored, {full} with a full queue");
    factory.stop().await;
    platform.stop().await;
}
