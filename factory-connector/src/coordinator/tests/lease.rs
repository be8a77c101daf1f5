use connector_state::use_cases::configuration::set_lease_held;

use super::*;
use crate::lease::LeaseGate;

/// Without the lease nothing leaves, control messages included; everything else goes on, and leaves
/// with the lease.
#[tokio::test]
async fn without_the_lease_nothing_leaves_and_nothing_is_lost() {
    let running = Running::with_two_open_fields().await;
    running.enter_both(1).await;
    let fetched = running.fetch(Lane::Reports).await;
    running.spool.connected();
    assert!(
        fetched.iter().all(|row| !running.spool.may_leave(row)),
        "not even what was fetched before"
    );
    running.enter_both(2).await;
    for lane in [Lane::Control, Lane::Newest, Lane::Reports] {
        assert_eq!(running.fetch(lane).await, [], "{lane:?}");
    }
    assert_eq!(
        running.entries("acme").await.len(),
        6,
        "two consents and four reports are in the ledger"
    );

    running.gate.open(7);
    assert!(
        fetched.iter().all(|row| !running.spool.may_leave(row)),
        "it was fetched under another lease"
    );
    let rows = running.fetch(Lane::Reports).await;
    assert_eq!(rows.iter().map(|row| reports(row).len()).sum::<usize>(), 4);
    let all = [running.fetch(Lane::Control).await, rows].concat();
    assert!(
        all.iter().all(|row| row.envelope.lease == Some(7) && running.spool.may_leave(row)),
        "{all:?}"
    );
    running.close().await;
}

/// A new gate is closed.
#[test]
fn a_gate_is_closed_at_first() {
    assert_eq!(LeaseGate::default().number(), None);
}

fn epochs(rows: &[SpoolRow]) -> Vec<u64> {
    let mut epochs: Vec<u64> = rows.iter().flat_map(reports).map(|report| report.epoch).collect();
    epochs.dedup();
    epochs
}

/// A copy numbers its reports in epochs of its own, so that neither's reports are mistaken for
/// repeats of the other's, even where the copy first ends before it wrote anything.
#[tokio::test]
async fn a_copied_store_begins_new_epochs_and_the_original_goes_on() {
    let running = Running::with_two_open_fields().await;
    running.enter_both(1).await;
    let before = epochs(&running.fetch(Lane::Reports).await);
    let original = running.close().await;
    let copy = tempfile::tempdir().expect("a folder");
    for file in std::fs::read_dir(original.path())
        .expect("listed")
        .flatten()
        .filter(|file| file.path().is_file())
    {
        std::fs::copy(file.path(), copy.path().join(file.file_name())).expect("copied");
    }
    let factory: asi_model::FactoryId = "F".parse().expect("an id");
    let mut instances = Vec::new();
    for _ in 0..2 {
        let store = Store::open(copy.path(), &factory, now()).await.expect("opened");
        let identity = store.identity().clone();
        assert!(identity.is_restored && !identity.was_lease_held, "{identity:?}");
        instances.push(identity.instance_id);
        store.close().await;
    }
    assert_ne!(instances[0], instances[1], "each start is another instance");

    for (folder, is_copy) in [(copy, true), (original, false)] {
        let running = Running::open_in(folder.path().to_owned(), Some(folder)).await;
        running.enter_both(2).await;
        let known = epochs(&running.fetch(Lane::Reports).await);
        assert_eq!((known[0], known.len() > 1), (before[0], is_copy), "{known:?}");
        let folder = running.close().await;
        let store = Store::open(folder.path(), &factory, now()).await.expect("opened");
        assert!(!store.identity().is_restored, "once");
        store.close().await;
    }
}

/// Requests are known to be this connector's from the start only where the last answer granted it
/// the lease.
#[tokio::test]
async fn the_lease_is_remembered_where_it_was_granted() {
    let mut running = Running::open().await;
    let factory: asi_model::FactoryId = "F".parse().expect("an id");
    for is_held in [true, false] {
        let set = running.coordinator.execute(move |_, _| set_lease_held(is_held)).await;
        set.expect("written");
        let folder = running.close().await;
        let store = Store::open(folder.path(), &factory, now()).await.expect("opened");
        assert_eq!(store.identity().was_lease_held, is_held);
        store.close().await;
        running = Running::open_in(folder.path().to_owned(), Some(folder)).await;
    }
    running.close().await;
}
