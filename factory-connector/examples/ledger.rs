//! How many disclosed values per second go through gate, ledger and spool into the one transaction, and how long the
//! verification of a million entries takes. Prints one line of name, value and unit per figure.
//!
//! `cargo run --release -p factory-connector --example ledger [entries]`

use std::{
    io::Write as _,
    time::{Duration, Instant},
};

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
    store::{Store, verify_ledger},
};
use serde_json::json;

/// Requests, each with so many fields.
const REQUESTS: usize = 500;
const FIELDS: usize = 10;
/// Values that change between two reports: 10 000 per second at the publishing interval of 20 ms.
const VALUES_PER_TRANSACTION: usize = 200;
/// How long values are disclosed without a pause.
const SUSTAINED: Duration = Duration::from_secs(15);
/// Entries to verify unless told otherwise.
const ENTRIES: u64 = 1_000_000;

#[tokio::main]
async fn main() -> anyhow::Result<()> {
    let entries: u64 = std::env::args().nth(1).map_or(Ok(ENTRIES), |text| text.parse())?;
    let folder = tempfile::tempdir()?;
    let mut plant = Plant::open(folder.path()).await?;
    let mut slowest = Duration::ZERO;
    let (began, mut values) = (Instant::now(), 0);
    while began.elapsed() < SUSTAINED {
        let transaction = Instant::now();
        values += plant.disclose(VALUES_PER_TRANSACTION).await?;
        slowest = slowest.max(transaction.elapsed());
    }
    #[allow(clippy::cast_precision_loss)]
    let rate = values as f64 / began.elapsed().as_secs_f64();
    say("disclosed values through gate, ledger and spool, sustained", rate, "values/s")?;
    say("slowest transaction meanwhile, 200 values", slowest.as_secs_f64() * 1000.0, "ms")?;
    while plant.entries < entries {
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
    #[allow(clippy::cast_precision_loss)]
    let millions = outcome.entries as f64 / 1e6;
    say("ledger verified, with the values it commits to", millions, "million entries")?;
    say("verification of a million entries", took / millions, "s")
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
        let mut plant = Self { store, books, key, factory, fields, next: 0, count: 0, entries: 0 };
        plant.commit(now()).await?;
        Ok(plant)
    }

    /// The next fields get new values; everything that follows is in one transaction.
    async fn disclose(&mut self, values: usize) -> anyhow::Result<usize> {
        let now = now();
        for _ in 0..values {
            let field = &self.fields[self.next];
            self.next = (self.next + 1) % self.fields.len();
            self.count += 1;
            let taken = self.books.candidate(field, ValueSource::External, DataValue::good(self.count, now), None, now);
            anyhow::ensure!(taken.is_some(), "the field is open");
        }
        self.commit(now).await?;
        Ok(values)
    }

    async fn commit(&mut self, now: DateTime) -> anyhow::Result<()> {
        self.books.report(now, rand::random);
        let (mut changes, _) = self.books.take();
        changes.heads = SignedHead::of(&self.factory, changes.ledger.iter().map(|(entry, _)| entry), &self.key);
        self.entries += changes.ledger.len() as u64;
        self.store.commit(changes).await?;
        Ok(())
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

fn say(name: &str, value: f64, unit: &str) -> anyhow::Result<()> {
    writeln!(std::io::stdout(), "{name}\t{value:.1}\t{unit}").context("writing to standard output")
}
