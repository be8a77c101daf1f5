//! Retention keeps up with what comes.

use std::time::Duration;

use asi_model::DateTime;
use platform::{
    clock::Clock,
    config::RetentionConfig,
    retention::Retention,
    store::{NewInboxMessage, Store},
};

#[tokio::test]
async fn all_that_is_too_old_goes_in_one_round() {
    let folder = tempfile::tempdir().expect("a folder");
    let store = Store::open(&folder.path().join("store.sqlite")).await.expect("it opens");
    let message = |number: usize, received_at| NewInboxMessage {
        message_id: format!("m{number}").parse().expect("an id"),
        message_type: "ua-data".into(),
        received_at,
        body: "{}".into(),
    };
    let now = Clock::system().now();
    let old = DateTime::from_ticks(1);
    let messages: Vec<NewInboxMessage> =
        (0..5_000).map(|number| message(number, if number == 0 { now } else { old })).collect();
    let mut work = store.begin().await.expect("begun");
    work.inbox().store("factory.F.ingress", &messages).await.expect("stored");
    work.commit().await.expect("committed");
    let retention = Retention::new(store, Clock::system(), &RetentionConfig::default());
    let round = tokio::time::timeout(Duration::from_secs(30), retention.round());
    assert_eq!(round.await.expect("it ends").expect("forgotten"), 4_999);
    assert_eq!(retention.round().await.expect("nothing is left"), 0);
}
