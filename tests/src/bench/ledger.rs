//! Rate of disclosed values through gate, ledger and spool into the one transaction,
//! what that transaction costs beside bare SQLite, and how long the verification of a million
//! entries takes: in the store, and by an auditor who has a file and a checkpoint only.

mod audit;
mod bare;

use std::time::{Duration, Instant};

use anyhow::Context as _;
use asi_model::{
    DataValue, DateTime, FactoryId, FieldKey,
    messages::{OperationNetworkMessage, ValueSource},
    pubsub::json::Encoding,
};
use connector_state::{
    ChangeSet, ConnectorState, IdSource, StateConfig, Writes,
    transaction::{self, DeliveryState},
    use_cases::{
        decide::{DecisionCommand, DecisionRequest, decide},
        revise::receive_network,
        seal,
        values::write_value,
    },
};
use disclosure::{DecisionBasis, DisclosurePolicy};
use factory_connector::{clock::now, store::Store};
use ledger::LedgerKey;
use serde_json::{Value, json};

use self::bare::BareStore;
use super::figures::result;

/// Requests, each with so many fields.
const REQUESTS: usize = 500;
const FIELDS: usize = 10;
/// Values that change between two reports: 10 000 per second at the publishing interval of 20 ms.
const VALUES_PER_TRANSACTION: usize = 200;
/// Time during which values are disclosed without a pause.
const SUSTAINED: Duration = Duration::from_secs(15);
/// Transactions beside those of bare SQLite.
const TURNS: usize = 40;
const TRANSACTIONS_PER_TURN: usize = 25;
/// Entries to verify, of two chains: each has a million, of which one is audited from its file.
const ENTRIES: u64 = 2_000_000;
/// Values per report where the ledger is only filled.
const VALUES_PER_REPORT: usize = 2;

/// Measures all of it, one thing after the other.
pub(super) async fn measure() -> anyhow::Result<Vec<Value>> {
    let folder = tempfile::tempdir()?;
    let mut plant = Plant::open(folder.path()).await?;
    let mut slowest = Duration::ZERO;
    let (began, mut values) = (Instant::now(), 0);
    while began.elapsed() < SUSTAINED {
        let transaction = Instant::now();
        plant.disclose(VALUES_PER_TRANSACTION).await?;
        slowest = slowest.max(transaction.elapsed());
        values += VALUES_PER_TRANSACTION;
    }
    let rate = values as f64 / began.elapsed().as_secs_f64();
    let mut results = vec![
        result("disclosed values through gate, ledger and spool, sustained", rate, "per second"),
        result("slowest transaction meanwhile, 200 values", slowest.as_secs_f64() * 1000.0, "ms"),
    ];
    results.extend(against_bare().await?);
    plant.spread();
    while plant.entries < ENTRIES {
        // Fewer, larger transactions: this only fills the ledger.
        plant.disclose(REQUESTS * VALUES_PER_REPORT).await?;
    }
    plant.sign_logs().await?;
    plant.store.close().await;
    let mut session = Store::connect(folder.path()).await?;
    let began = Instant::now();
    let outcome = session.ledger().verify(Some(plant.key.public())).await?;
    let took = began.elapsed().as_secs_f64();
    anyhow::ensure!(
        outcome.is_intact(),
        "the ledger is not intact: {:?}",
        outcome.fault_list.first()
    );
    let entries = outcome.entries;
    anyhow::ensure!(entries >= ENTRIES, "only {entries} entries were verified");
    anyhow::ensure!(outcome.values_compared >= ENTRIES / 2, "values were compared");
    let millions = entries as f64 / 1e6;
    results.push(result(
        "ledger verified, with the values it commits to",
        millions,
        "million entries",
    ));
    results.push(result("verification of a million entries", took / millions, "s"));
    results.extend(audit::measure(folder.path(), &mut session).await?);
    Ok(results)
}

struct Plant {
    store: Store,
    state: ConnectorState,
    pending: ChangeSet,
    key: LedgerKey,
    fields: Vec<FieldKey>,
    next: usize,
    count: u64,
    entries: u64,
}

/// Compares the connector's transaction with the same one by bare SQLite, a few of each in turn, so
/// that disturbances meet both.
async fn against_bare() -> anyhow::Result<Vec<Value>> {
    let (own_folder, bare_folder) = (tempfile::tempdir()?, tempfile::tempdir()?);
    let mut plant = Plant::open(own_folder.path()).await?;
    let mut beside = Plant::open(bare_folder.path()).await?;
    // The first round of all fields makes rows that are overwritten from then on.
    plant.disclose(REQUESTS * FIELDS).await?;
    beside.disclose(REQUESTS * FIELDS).await?;
    let mut store = BareStore::open(bare_folder.path())?;
    let (mut own, mut bare) = (Duration::ZERO, Duration::ZERO);
    for _ in 0..TURNS {
        for _ in 0..TRANSACTIONS_PER_TURN {
            own += plant.disclose(VALUES_PER_TRANSACTION).await?;
        }
        for _ in 0..TRANSACTIONS_PER_TURN {
            bare += store.commit(&beside.changes(VALUES_PER_TRANSACTION, now())?)?;
        }
    }
    let values = (TURNS * TRANSACTIONS_PER_TURN * VALUES_PER_TRANSACTION) as f64;
    let (own, bare) = (values / own.as_secs_f64(), values / bare.as_secs_f64());
    Ok(vec![
        result("values appended to ledger and spool", own, "per second"),
        result("the same rows into the same tables by bare SQLite", bare, "values per second"),
        result("appending against bare SQLite", own / bare, "times"),
    ])
}

impl Plant {
    async fn open(folder: &std::path::Path) -> anyhow::Result<Self> {
        let factory: FactoryId = "F".parse()?;
        let mut store = Store::open(folder, &factory, now()).await?;
        let key = factory_connector::ledger_key::open(&folder.join("key.pem"))?;
        let config = StateConfig { factory_id: factory, encoding: Encoding::Digicor };
        let (snapshot, ids) = (store.load().await?, IdSource::new(rand::random()));
        let (mut state, mut pending) = ConnectorState::load(config, snapshot, ids, false, now())?;
        pending.merge(seal::sign_all_heads(&mut state, &key));
        let message = network()?;
        let raw = serde_json::to_string(&message)?;
        let fields: Vec<FieldKey> =
            message.operation_network.fields().map(|(key, ..)| key).collect();
        pending.merge(receive_network(&mut state, message, raw, now()));
        for field in &fields {
            let policy = DisclosurePolicy::default();
            let value_source = ValueSource::External;
            let command = DecisionCommand::Map { value_source, mapping: None, policy };
            let (decided_by, basis) = ("eve".to_owned(), DecisionBasis::default());
            let request =
                DecisionRequest { command, reason: None, decided_by, basis, preview: None };
            pending.merge(decide(&mut state, field, request, now()).context("a decision")?);
        }
        let mut plant = Self { store, state, pending, key, fields, next: 0, count: 0, entries: 0 };
        plant.disclose(0).await?;
        Ok(plant)
    }

    /// Orders the fields so that as many values as [`VALUES_PER_REPORT`] for each request change
    /// before the next values of any.
    fn spread(&mut self) {
        let place = |index: usize| (index % FIELDS / VALUES_PER_REPORT, index / FIELDS);
        let mut fields: Vec<_> = self.fields.drain(..).enumerate().collect();
        fields.sort_by_key(|(index, _)| place(*index));
        self.fields.extend(fields.into_iter().map(|(_, field)| field));
        self.next = 0;
    }

    /// Gives the next fields new values in one transaction, with everything that follows. Returns its
    /// duration.
    async fn disclose(&mut self, values: usize) -> anyhow::Result<Duration> {
        let changes = self.changes(values, now())?;
        let began = Instant::now();
        self.store.commit(changes).await?;
        Ok(began.elapsed())
    }

    /// Signs checkpoints over all entries, as the connector does each minute.
    async fn sign_logs(&mut self) -> anyhow::Result<()> {
        self.pending.merge(seal::checkpoint_logs(&mut self.state, &self.key));
        self.disclose(0).await.map(drop)
    }

    /// Changes that follow when the next fields get new values.
    fn changes(&mut self, values: usize, now: DateTime) -> anyhow::Result<Writes> {
        for _ in 0..values {
            let field = &self.fields[self.next];
            self.next = (self.next + 1) % self.fields.len();
            self.count += 1;
            let value = DataValue::good(self.count, now);
            let written = write_value(&mut self.state, field, ValueSource::External, value, now);
            anyhow::ensure!(written.is_ok(), "the field is open");
        }
        let Self { state, pending, key, .. } = self;
        let (writes, _) = transaction::refresh(state, std::mem::take(pending))
            .take_back(state, DeliveryState::default(), key, now)
            .report(state, now, rand::random)
            .sign(state, key);
        self.entries += writes.ledger.entries.len() as u64;
        Ok(writes)
    }
}

fn network() -> anyhow::Result<OperationNetworkMessage> {
    let requests: Vec<_> = (0..REQUESTS)
        .map(|request| {
            let fields: Vec<_> = (0..FIELDS)
                .map(|field| json!({ "name": format!("count{field}"), "type": 9, "unit": "PIECE" }))
                .collect();
            json!({ "dynamicDataRequestId": format!("R{request}"), "requesterId": "acme",
                "recipientList": ["acme", "hull"], "purpose": "Plan",
                "reportDataFormat": { "reportName": "Progress", "reportFieldList": fields } })
        })
        .collect();
    Ok(serde_json::from_value(
        json!({ "messageId": "m1", "factoryId": "F", "collaborationId": "c", "revision": 1,
        "operationNetwork": { "operationNetworkId": "n", "operationList": [
            { "operationId": "op", "operationType": "PRODUCTION", "dynamicDataRequestList": requests } ] } }),
    )?)
}
