//! File of a plant: opened with a clock and ids of the test, and read as a whole.

use connector_state::{IdSource, use_cases::seal};

use super::*;

/// Tables of which nothing leaves: states of gates, and what identifies the file itself.
const PRIVATE_TABLES: [&str; 3] = ["identity", "field_value", "user"];

/// Makes a folder in the machine's memory where there is one: a history writes hundreds of times.
pub(super) fn folder() -> TempDir {
    let memory = Path::new("/dev/shm");
    let folder = if memory.is_dir() { tempfile::tempdir_in(memory) } else { tempfile::tempdir() };
    folder.expect("a folder")
}

/// Opens or makes the file in a folder. `starts` numbers the starts of the plant: the same ids
/// follow from the same number.
pub(super) async fn open(
    folder: &Path,
    twin: twin::TwinHandle,
    now: DateTime,
    starts: u8,
) -> (UnitOfWork, ConnectorSpool) {
    let factory_id: asi_model::FactoryId = "F".parse().expect("an id");
    let mut store = Store::open(folder, &factory_id, now).await.expect("a store");
    let key = ::ledger::LedgerKey::from_secret(&[3; 32]);
    let is_restored = store.identity().is_restored;
    let snapshot = store.load().await.expect("the store is read");
    let state_config = StateConfig { factory_id: factory_id.clone(), encoding: Encoding::Digicor };
    let ids = IdSource::new([starts; 32]);
    let loaded = ConnectorState::load(state_config.clone(), snapshot, ids, is_restored, now);
    let (mut state, mut pending) = loaded.expect("it can be read");
    pending.merge(seal::sign_all_heads(&mut state, &key));
    let (keep_alives, in_flight) =
        (Arc::new(KeepAliveQueue::default()), Arc::new(InFlight::default()));
    let gate = Arc::new(LeaseGate::default());
    gate.open(1);
    let spool = ConnectorSpool::new(
        factory_id.clone(),
        store.readers(),
        channel().0,
        Arc::clone(&keep_alives),
        Arc::clone(&in_flight),
        gate,
        MessageSigner::new(factory_id, key.clone()).expect("a key"),
    );
    let config = CoordinatorConfig {
        witness_wait: std::time::Duration::ZERO,
        state: state_config,
        publishing_interval: Duration::from_millis(1),
        spool: SpoolLimits::default(),
        retention: RetentionLimits::default(),
    };
    let (mappings, work) = mpsc::channel(1);
    // There is no mapping engine: nothing may wait for it.
    drop(work);
    let events = LiveEvents::new(1, 1);
    let outputs = Outputs { twin, mappings, link: None, keep_alives, in_flight, events };
    (UnitOfWork { config, store, state, pending, outputs, key }, spool)
}

/// Returns the rows of all tables that are not the plant's own.
pub(super) async fn stored(folder: &Path) -> Vec<String> {
    let mut connection = connect(folder).await;
    let tables: Vec<String> = sqlx::query_scalar(
        "SELECT name FROM sqlite_schema WHERE type = 'table' AND name NOT LIKE 'sqlite_%'
             AND name NOT LIKE '\\_%' ESCAPE '\\' ORDER BY name",
    )
    .fetch_all(&mut connection)
    .await
    .expect("tables");
    let mut rows = Vec::new();
    for table in tables.iter().filter(|table| !PRIVATE_TABLES.contains(&table.as_str())) {
        let columns: Vec<String> =
            sqlx::query_scalar("SELECT 'quote(' || name || ')' FROM pragma_table_info(?)")
                .bind(table)
                .fetch_all(&mut connection)
                .await
                .expect("columns");
        let columns = columns.join(" || ' ' || ");
        let sql = format!("SELECT '{table} ' || {columns} AS row FROM {table} ORDER BY row");
        let found: Vec<String> = sqlx::query_scalar(sqlx::AssertSqlSafe(sql))
            .fetch_all(&mut connection)
            .await
            .expect("rows");
        rows.extend(found);
    }
    rows
}
