//! How many disclosed values per second go through gate, ledger and spool into the one transaction, what that
//! transaction costs beside bare SQLite, and how long the verification of a million entries takes.

mod bare;

use std::time::{Duration, Instant};

use anyhow::Context as _;
use asi_model::{
    DataValue, DateTime, FactoryId, FieldKey,
    messages::{OperationNetworkMessage, ValueSource},
    pubsub::json::Encoding,
};
use factory_connector::{
    books::{Books, BooksConfig, Verdict},
    desk::now,
    disclosure::DisclosurePolicy,
    ledger::{LedgerKey, SignedHead},
    store::{Changes, Store, verify_ledger},
};
use serde_json::{Value, json};

use super::result;

/// Requests, each with so many fields.
const REQUESTS: usize = 500;
const FIELDS: usize = 10;
/// Values that change between two reports: 10 000 per second at the publishing interval of 20 ms.
const VALUES_PER_TRANSACTION: usize = 200;
/// How long values are disclosed without a pause.
const SUSTAINED: Duration = Duration::from_secs(15);
/// Entries to verify.
const ENTRIES: u64 = 1_000_000;

/// Measures all of it, one thing after the other.
pub(super) async fn measure() -> anyhow::Result<Vec<Value>> {
    let folder = tempfile::tempdir()?;
    let mut plant = Plant::open(folder.path()).await?;
    let (mut slowest, mut committing) = (Duration::ZERO, Duration::ZERO);
    let (began, mut values, mut transactions) = (Instant::now(), 0, 0);
    while began.elapsed() < SUSTAINED {
        let transaction = Instant::now();
        committing += plant.disclose(VALUES_PER_TRANSACTION).await?;
        slowest = slowest.max(transaction.elapsed());
        (values, transactions) = (values + VALUES_PER_TRANSACTION, transactions + 1);
    }
    let rate = values as f64 / began.elapsed().as_secs_f64();
    let appended = values as f64 / committing.as_secs_f64();
    let bare = bare::appends(&plant.written, transactions).await?;
    let bare = values as f64 / bare.as_secs_f64();
    let mut results = vec![
        result("disclosed values through gate, ledger and spool, sustained", rate, "per second"),
        result("slowest transaction meanwhile, 200 values", slowest.as_secs_f64() * 1000.0, "ms"),
        result("values appended to ledger and spool", appended, "per second"),
        result("the same rows into bare SQLite", bare, "values per second"),
        result("appending against bare SQLite", appended / bare, "times"),
    ];
    while plant.entries < ENTRIES {
        // Fewer, larger transactions: this only fills the ledger.
        plant.disclose(VALUES_PER_TRANSACTION * 20).await?;
    }
    plant.store.close().await;
    let mut connection = Store::connect(folder.path()).await?;
    let began = Instant::now();
    let outcome = verify_ledger(&mut connection, Some(plant.key.public())).await?;
    let took = began.elapsed().as_secs_f64();
    anyhow::ensure!(outcome.is_intact(), "the ledger is not intact: {:?}", outcome.fault_list.first());
    anyhow::ensure!(outcome.values_compared > 0, "values were compared");
    let millions = outcome.entries as f64 / 1e6;
    results.push(result("ledger verified, with the values it commits to", millions, "million entries"));
    results.push(result("verification of a million entries", took / millions, "s"));
    Ok(results)
}

struct Plant {
    store: Store,
    books: Books,
    key: LedgerKey,
    factory: FactoryId,
    fields: Vec<FieldKey>,
    next: usize,
    count: u64,
    entries: u64,
    written: Written,
}

/// Rows of one kind, and what is in them.
#[derive(Debug, Clone, Copy, Default)]
struct Rows {
    count: usize,
    bytes: usize,
}

/// What the transactions so far have held.
#[derive(Debug, Clone, Copy, Default)]
struct Written {
    reports: Rows,
    entries: Rows,
    values: Rows,
}

impl Rows {
    fn add(&mut self, bytes: usize) {
        self.count += 1;
        self.bytes += bytes;
    }
}

impl Written {
    fn add(&mut self, changes: &Changes) {
        changes.reports.iter().for_each(|row| self.reports.add(row.body.len() + row.salt.len()));
        changes.ledger.iter().for_each(|(entry, _)| self.entries.add(entry.content.len() + entry.hash.len()));
        changes.field_values.values().for_each(|row| self.values.add(row.gate.len()));
    }
}

impl Plant {
    async fn open(folder: &std::path::Path) -> anyhow::Result<Self> {
        let factory: FactoryId = "F".parse()?;
        let mut store = Store::open(folder, &factory, now()).await?;
        let key = LedgerKey::open(&folder.join("key.pem"))?;
        let config = BooksConfig { factory_id: factory.clone(), encoding: Encoding::Digicor };
        let mut books = Books::new(config, store.load().await?, false, now())?;
        let message = network()?;
        let raw = serde_json::to_string(&message)?;
        let fields: Vec<FieldKey> = message.operation_network.fields().map(|(key, ..)| key).collect();
        books.network_arrived(message, raw, now());
        for field in &fields {
            let policy = DisclosurePolicy::default();
            let verdict = Verdict::Map { value_source: ValueSource::External, mapping: None, policy };
            books.decide(field, verdict, None, "eve", now()).context("a decision")?;
        }
        let mut plant =
            Self { store, books, key, factory, fields, next: 0, count: 0, entries: 0, written: Written::default() };
        plant.commit(now()).await?;
        plant.written = Written::default();
        Ok(plant)
    }

    /// The next fields get new values; everything that follows is in one transaction. Answers how long that took.
    async fn disclose(&mut self, values: usize) -> anyhow::Result<Duration> {
        let now = now();
        for _ in 0..values {
            let field = &self.fields[self.next];
            self.next = (self.next + 1) % self.fields.len();
            self.count += 1;
            let taken = self.books.candidate(field, ValueSource::External, DataValue::good(self.count, now), None, now);
            anyhow::ensure!(taken.is_some(), "the field is open");
        }
        self.commit(now).await
    }

    async fn commit(&mut self, now: DateTime) -> anyhow::Result<Duration> {
        self.books.report(now, rand::random);
        let (mut changes, _) = self.books.take();
        changes.heads = SignedHead::of(&self.factory, changes.ledger.iter().map(|(entry, _)| entry), &self.key);
        self.entries += changes.ledger.len() as u64;
        self.written.add(&changes);
        let began = Instant::now();
        self.store.commit(changes).await?;
        Ok(began.elapsed())
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
    Ok(serde_json::from_value(json!({ "messageId": "m1", "factoryId": "F", "collaborationId": "c", "revision": 1,
        "operationNetwork": { "operationNetworkId": "n", "operationList": [
            { "operationId": "op", "operationType": "PRODUCTION", "dynamicDataRequestList": requests } ] } }))?)
}
