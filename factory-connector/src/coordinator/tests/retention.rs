//! Retention: the chains state what is emptied and removed, and what is missing besides is found.

use ::ledger::{LedgerKey, Verification};
use asi_model::FactoryId;
use connector_state::{
    ChangeSet, ConnectorState, StateConfig,
    transaction::{self, DeliveryState},
    use_cases::{
        retain::{RetentionLimit, empty_values, remove_entries},
        seal,
    },
};

use super::{
    ledger::{run, small_ledger, verified},
    *,
};

/// Store and state without a running coordinator.
pub(super) struct Plant {
    pub(super) store: Store,
    state: ConnectorState,
    pending: ChangeSet,
    key: LedgerKey,
}

impl Plant {
    pub(super) async fn open(folder: &Path) -> Self {
        let factory_id: FactoryId = "F".parse().expect("an id");
        let mut store = Store::open(folder, &factory_id, now()).await.expect("a store");
        let key = crate::ledger_key::open(&folder.join(LEDGER_KEY_FILE)).expect("the key");
        let snapshot = store.load().await.expect("read");
        let config =
            StateConfig { factory_id, encoding: asi_model::pubsub::json::Encoding::Digicor };
        let ids = crate::clock::id_source();
        let (mut state, mut pending) =
            ConnectorState::load(config, snapshot, ids, false, now()).expect("loaded");
        pending.merge(seal::sign_all_heads(&mut state, &key));
        Self { store, state, pending, key }
    }

    pub(super) async fn commit(&mut self) {
        let changes = std::mem::take(&mut self.pending);
        let (writes, _) = transaction::refresh(&mut self.state, changes)
            .take_back(&mut self.state, DeliveryState::default(), &self.key, now())
            .report(&mut self.state, now(), crate::clock::salt)
            .sign(&mut self.state, &self.key);
        self.store.commit(writes).await.expect("written");
    }

    async fn empty_values(&mut self, before: DateTime) -> usize {
        let limit = RetentionLimit { days: 1, before };
        let old = self.store.read().reports().old(before, 0).await.expect("read");
        self.pending.merge(empty_values(&mut self.state, &old, limit, before));
        self.commit().await;
        old.len()
    }

    pub(super) async fn remove_entries(&mut self, before: DateTime) {
        let limit = RetentionLimit { days: 1, before };
        let old = self.store.read().ledger().old_entries(before).await.expect("read");
        self.pending.merge(remove_entries(&mut self.state, old, limit, &self.key, before));
        self.commit().await;
    }
}

fn later() -> DateTime {
    DateTime::from_unix_micros(now().unix_micros() + 1_000_000)
}

fn has(outcome: &Verification, message: &str) -> bool {
    outcome.fault_list.iter().any(|fault| fault.message == message)
}

const EMPTIED: &str = "the values were emptied without a statement of retention";

/// Retention removes old entries, and the ledger still proves the others; rows that the spool
/// needs stay.
#[tokio::test]
async fn retention_leaves_a_ledger_that_verifies() {
    let folder = small_ledger().await;
    let mut connection = connect(folder.path()).await;
    let before = verified(&mut connection).await;
    run(&mut connection, "UPDATE report SET state = 'DONE'").await;
    let spooled = "UPDATE report SET state = 'SENT' WHERE id = (SELECT min(id) FROM report)";
    run(&mut connection, spooled).await;
    let mut plant = Plant::open(folder.path()).await;
    plant.commit().await;

    assert!(plant.empty_values(later()).await > 0);
    let outcome = verified(&mut connection).await;
    assert!(outcome.is_intact() && outcome.values_emptied > 0, "{outcome:?}");
    assert_eq!(outcome.values_emptied + outcome.values_compared, before.values_compared);
    assert!(outcome.values_compared > 0, "the report that was not receipted keeps its values");
    let statements = outcome.entries - before.entries;
    assert!(statements > 0, "the chains state it");

    plant.remove_entries(later()).await;
    let outcome = verified(&mut connection).await;
    assert!(
        outcome.is_intact() && outcome.values_compared > 0,
        "what was not receipted stays: {outcome:?}"
    );
    let older = outcome.entries_pruned;
    assert!(older > 0, "{outcome:?}");
    run(&mut connection, "UPDATE report SET state = 'DONE'").await;
    plant.remove_entries(DateTime::from_unix_micros(later().unix_micros() + 1_000_000)).await;
    let outcome = verified(&mut connection).await;
    assert!(outcome.is_intact(), "{outcome:?}");
    assert!(outcome.entries_pruned >= before.entries && outcome.entries < 8, "{outcome:?}");
    let reports: i64 = sqlx::query_scalar("SELECT count(*) FROM report")
        .fetch_one(&mut connection)
        .await
        .expect("counted");
    assert_eq!(reports, 0, "with the entries went their reports");
    plant.store.close().await;
}

/// Finding 1 of the ledger: body and salt of a report set to null in the store.
#[tokio::test]
async fn values_emptied_in_the_store_are_found() {
    let folder = small_ledger().await;
    let mut connection = connect(folder.path()).await;
    for condition in ["id = (SELECT min(id) FROM report)", "true"] {
        let mut attempt = sqlx::Connection::begin(&mut connection).await.expect("a transaction");
        let sql = format!("UPDATE report SET body = NULL, salt = NULL WHERE {condition}");
        run(&mut attempt, &sql).await;
        let outcome = verified(&mut attempt).await;
        assert!(has(&outcome, EMPTIED), "{condition}: {outcome:?}");
        attempt.rollback().await.expect("rolled back");
    }
    // A restart states nothing afterwards.
    run(&mut connection, "UPDATE report SET body = NULL, salt = NULL, state = 'DONE'").await;
    let mut plant = Plant::open(folder.path()).await;
    plant.commit().await;
    assert!(has(&verified(&mut connection).await, EMPTIED));
    plant.store.close().await;
}

/// Retention of a former version is stated at the first start, once, in words of its own.
#[tokio::test]
async fn what_a_former_version_emptied_is_stated_at_the_first_start() {
    let folder = small_ledger().await;
    let mut connection = connect(folder.path()).await;
    run(&mut connection, "UPDATE report SET state = 'DONE'").await;
    // As the former version left it: without seal and logs, and with emptied values.
    run(
        &mut connection,
        "UPDATE report SET body = NULL, salt = NULL WHERE id = (SELECT min(id) FROM report)",
    )
    .await;
    run(&mut connection, "DELETE FROM ledger_seal").await;
    let blank =
        "UPDATE ledger_log SET start = '', size = 0, root = x'', leaves = x'', checkpoint = ''";
    run(&mut connection, blank).await;
    run(&mut connection, "UPDATE identity SET must_state_retention = 1").await;
    let outcome = verified(&mut connection).await;
    assert!(outcome.is_intact() && outcome.values_emptied > 0, "before the start: {outcome:?}");
    let mut plant = Plant::open(folder.path()).await;
    plant.commit().await;
    let outcome = verified(&mut connection).await;
    assert!(outcome.is_intact() && outcome.values_emptied > 0, "{outcome:?}");
    plant.store.close().await;
    let stated: Vec<String> =
        sqlx::query_scalar("SELECT content FROM ledger_entry WHERE event = 'RETENTION'")
            .fetch_all(&mut connection)
            .await
            .expect("read");
    assert!(!stated.is_empty());
    for content in &stated {
        let entry: serde_json::Value = serde_json::from_str(content).expect("JSON");
        assert_eq!((&entry["rule"], &entry["days"]), (&"FORMER_VERSION".into(), &().into()));
    }
    // Values that are emptied later are not stated by another start.
    run(&mut connection, "UPDATE report SET body = NULL, salt = NULL").await;
    let mut plant = Plant::open(folder.path()).await;
    plant.commit().await;
    assert!(has(&verified(&mut connection).await, EMPTIED));
    plant.store.close().await;
    run(&mut connection, "UPDATE identity SET must_state_retention = 1").await;
    let mut plant = Plant::open(folder.path()).await;
    plant.commit().await;
    let outcome = verified(&mut connection).await;
    assert!(has(&outcome, "what a former version emptied is stated twice"), "{outcome:?}");
    plant.store.close().await;
}
