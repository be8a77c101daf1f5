//! Retention keeps up with what comes.

use std::time::Duration;

use asi_model::DateTime;
use platform::{
    clock::Clock,
    config::RetentionConfig,
    retention::Retention,
    store::{Leaver, NewInboxMessage, Organisation, Store, WriterKey, WriterRow},
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

#[tokio::test]
async fn what_a_factory_left_behind_goes_in_portions() {
    let folder = tempfile::tempdir().expect("a folder");
    let store = Store::open(&folder.path().join("store.sqlite")).await.expect("it opens");
    let now = Clock::system().now();
    let organisation_id: asi_model::OrganisationId = "a".parse().expect("an id");
    let [left, other] = ["F", "G"].map(|id| id.parse::<asi_model::FactoryId>().expect("an id"));
    let mut work = store.begin().await.expect("begun");
    let organisation = Organisation {
        organisation_id: organisation_id.clone(),
        name: "a".into(),
        created_at: now,
    };
    work.organisations().add(&organisation).await.expect("added");
    for factory in [&left, &other] {
        work.factories().add(factory, &organisation_id, "f", now).await.expect("added");
        for epoch in 0..2_500 {
            let key = WriterKey { factory_id: factory.clone(), data_set_writer_id: 1, epoch };
            work.writers().put(&WriterRow::new(key)).await.expect("stored");
        }
    }
    work.removals().leave(&Leaver::Factory(left.clone()), now).await.expect("it leaves");
    work.commit().await.expect("committed");
    let retention = Retention::new(store.clone(), Clock::system(), &RetentionConfig::default());
    retention.round().await.expect("cleared");
    let mut work = store.read().await.expect("begun");
    assert_eq!(work.writers().count(&left).await.expect("read"), 0);
    assert_eq!(work.writers().count(&other).await.expect("read"), 2_500);
}
