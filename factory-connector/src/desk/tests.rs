//! The desk with a real store, outbox and twin; the test stands where people, platform and link
//! stand.

mod crash;
mod failures;
mod lease;
mod ledger;
mod lookup;
mod revocation;

use std::{
    path::{Path, PathBuf},
    sync::Arc,
    time::Duration,
};

use asi_model::{DataValue, FieldKey, StatusCode, messages::ValueSource, pubsub::json::Encoding};
use async_trait::async_trait;
use messaging::{
    Delivery, Envelope, RowId, RowOutcome, SendOutcome, SpoolRow, SpoolStore,
    spool::{Fetch, Lane},
};
use serde_json::{Value, json};
use sqlx::{ConnectOptions as _, SqliteConnection, sqlite::SqliteConnectOptions};
use tempfile::TempDir;
use time::OffsetDateTime;
use tokio::{sync::mpsc, task::JoinHandle};
use tokio_util::sync::CancellationToken;

use super::*;
use crate::ledger_key::{self, LEDGER_KEY_FILE};
use crate::{
    books::{EntryOutcome, Verdict, new_message_id},
    lease::LeaseGate,
    operator::{Action, EntryId, OperationKey, OperatorEntry},
    outbox::{Departures, Outbox},
    store::{LedgerCursor, LedgerFilter, Readers, Session},
};
use disclosure::DisclosurePolicy;

/// How long anything may take.
const DEADLINE: Duration = Duration::from_secs(30);
/// Between two looks.
const PAUSE: Duration = Duration::from_millis(2);

struct Nobody;

#[async_trait]
impl twin::FieldWriter for Nobody {
    async fn write(&self, _: &FieldKey, _: DataValue, _: &twin::TwinUser) -> StatusCode {
        StatusCode::BAD_NOT_WRITABLE
    }
    async fn decide(&self, _: &FieldKey, _: twin::FieldDecision, _: &twin::TwinUser) -> StatusCode {
        StatusCode::BAD_NOT_WRITABLE
    }
}

#[async_trait]
impl twin::Authenticator for Nobody {
    async fn authenticate(&self, _: &str, _: &str) -> Option<twin::Role> {
        None
    }
}

/// A running desk.
struct Office {
    folder: PathBuf,
    kept: Option<TempDir>,
    desk: DeskHandle,
    outbox: Outbox,
    gate: Arc<LeaseGate>,
    readers: Readers,
    shutdown: CancellationToken,
    running: JoinHandle<Result<(), StoreError>>,
    _twin: twin::Twin,
    _work: mpsc::Receiver<Vec<MappingWork>>,
    _candidates: mpsc::Sender<Vec<Candidate>>,
}

impl Office {
    async fn open() -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        Self::open_in(folder.path().to_owned(), Some(folder)).await
    }

    async fn open_in(folder: PathBuf, kept: Option<TempDir>) -> Self {
        let factory_id: asi_model::FactoryId = "F".parse().expect("an id");
        let store = Store::open(&folder, &factory_id, now()).await.expect("a store");
        let readers = store.readers();
        let key = ledger_key::open(&folder.join(LEDGER_KEY_FILE)).expect("a key");
        let twin_config = twin::TwinConfig {
            listen: "127.0.0.1:0".parse().expect("an address"),
            pki_directory: folder.join("pki"),
            ..twin::TwinConfig::default()
        };
        let (twin, twin_handle) =
            twin::Twin::new(factory_id.clone(), twin_config, Arc::new(Nobody), Arc::new(Nobody))
                .expect("a twin");
        let (desk, commands) = channel();
        let (mappings, work) = mpsc::channel(64);
        let (candidates_in, candidates) = mpsc::channel(64);
        let ephemerals = Arc::new(Ephemerals::default());
        let departures = Arc::new(Departures::default());
        let gate = Arc::new(LeaseGate::default());
        gate.open(1);
        let outbox = Outbox::new(
            factory_id.clone(),
            readers.clone(),
            desk.clone(),
            Arc::clone(&ephemerals),
            Arc::clone(&departures),
            Arc::clone(&gate),
        );
        let config = DeskConfig {
            books: BooksConfig { factory_id, encoding: Encoding::Digicor },
            publishing_interval: Duration::from_millis(1),
            spool: SpoolLimits::default(),
            retention: RetentionLimits::default(),
        };
        let rooms = Rooms {
            twin: twin_handle,
            mappings,
            link: None,
            ephemerals,
            departures,
            events: EventLog::new(64, 1),
        };
        let made = Desk::new(config, store, rooms, key, commands, candidates)
            .await
            .expect("the store is read");
        let shutdown = CancellationToken::new();
        let running = tokio::spawn(made.run(shutdown.clone()));
        Self {
            folder,
            kept,
            desk,
            outbox,
            gate,
            readers,
            shutdown,
            running,
            _twin: twin,
            _work: work,
            _candidates: candidates_in,
        }
    }

    /// Stops, and leaves the folder.
    async fn close(self) -> TempDir {
        self.shutdown.cancel();
        self.running.await.expect("it ends").expect("in good order");
        self.kept.expect("a folder of its own")
    }

    async fn receive(&self, subject: &str, body: Value) {
        let envelope = Envelope::new(new_message_id(), subject, body.to_string());
        let delivery = Delivery {
            envelope,
            principal: None,
            is_redelivered: false,
            delivery_count: 0,
            received_at: OffsetDateTime::now_utc(),
        };
        self.desk.deliver(vec![delivery]).await;
    }

    /// Two requests of one operation, each with one field that is decided Manual; two recipients.
    async fn with_two_open_fields() -> Self {
        let office = Self::open().await;
        office.receive("operation-network", network(1)).await;
        office.open_fields().await;
        office
    }

    async fn open_fields(&self) {
        for name in ["made", "note"] {
            let verdict = Verdict::Map {
                value_source: ValueSource::Manual,
                mapping: None,
                policy: DisclosurePolicy::default(),
            };
            self.desk.decide(field(name), verdict, None, "eve").await.expect("decided");
        }
    }

    /// Types values into both fields: one message with two reports.
    async fn enter_both(&self, number: u64) {
        let entries =
            vec![entry("made", json!(number)), entry("note", json!(format!("note {number}")))];
        let outcomes = self.desk.enter(entries).await.expect("written");
        assert!(
            outcomes.iter().all(|outcome| matches!(outcome, EntryOutcome::Taken(_))),
            "{outcomes:?}"
        );
    }

    /// What the link would fetch.
    async fn fetch(&self, lane: Lane) -> Vec<SpoolRow> {
        let fetch = Fetch { lane, after: RowId(0), through: None, limit: 1000 };
        self.outbox.fetch(fetch).await.expect("the spool is read")
    }

    /// The broker accepts these, as far as they may leave.
    async fn accept(&self, rows: &[SpoolRow]) -> usize {
        let left: Vec<_> = rows.iter().filter(|row| self.outbox.may_leave(row)).collect();
        let outcome = |row: &&SpoolRow| RowOutcome {
            id: row.id,
            outcome: SendOutcome::Accepted,
            at: OffsetDateTime::now_utc(),
        };
        self.outbox.record(left.iter().map(outcome).collect()).await.expect("recorded");
        left.len()
    }

    async fn receipt(&self, report: &Report, through: u32) {
        let body = json!({ "messageType": "receipt", "messageId": new_message_id(), "factoryId": "F", "receiptList": [
            { "dataSetWriterId": report.writer, "epoch": report.epoch, "throughSequence": through, "missingList": [] } ] });
        self.receive("receipt", body).await;
    }

    async fn entries(&self, recipient: &str) -> Vec<Value> {
        let filter = LedgerFilter { recipient: recipient.parse().ok(), ..LedgerFilter::default() };
        let mut cursor = LedgerCursor::new(filter);
        let rows = self.session().await.ledger().next(&mut cursor).await.expect("read");
        rows.iter().map(|row| serde_json::from_str(&row.content).expect("JSON")).collect()
    }

    async fn session(&self) -> Session {
        self.readers.session().await.expect("a connection")
    }
}

/// A report as it left.
#[derive(Debug, Clone, PartialEq)]
struct Report {
    writer: u64,
    epoch: u64,
    sequence: u64,
}

fn reports(row: &SpoolRow) -> Vec<Report> {
    let message: Value = serde_json::from_slice(&row.envelope.body).expect("JSON");
    let report = |report: &Value| Report {
        writer: report["DataSetWriterId"].as_u64().expect("a number"),
        epoch: report["MetaDataVersion"]["MajorVersion"].as_u64().expect("a number"),
        sequence: report["SequenceNumber"].as_u64().expect("a number"),
    };
    message["Messages"].as_array().expect("reports").iter().map(report).collect()
}

fn network(revision: u64) -> Value {
    let request = |id: &str, name: &str, kind: u8| {
        json!({ "dynamicDataRequestId": id, "requesterId": "acme", "recipientList": ["acme", "hull"],
            "purpose": "Plan", "reportDataFormat": { "reportName": "Progress", "reportFieldList": [
                { "name": name, "type": kind } ] } })
    };
    json!({ "messageType": "operation-network", "messageId": new_message_id(), "factoryId": "F",
        "collaborationId": "c", "revision": revision, "operationNetwork": { "operationNetworkId": "n",
        "operationList": [ { "operationId": "op", "operationType": "PRODUCTION", "dynamicDataRequestList":
            [request("R1", "made", 9), request("R2", "note", 12)] } ] } })
}

fn request_of(name: &str) -> &'static str {
    if name == "made" { "R1" } else { "R2" }
}

fn field(name: &str) -> FieldKey {
    let request = asi_model::RequestKey {
        operation_network_id: "n".parse().expect("an id"),
        operation_id: "op".parse().expect("an id"),
        dynamic_data_request_id: request_of(name).parse().expect("an id"),
    };
    request.field(name.parse().expect("a name"))
}

fn entry(name: &str, value: Value) -> OperatorEntry {
    let at = DateTime::from_unix_micros(now().unix_micros());
    OperatorEntry {
        entry_id: EntryId::fresh(),
        operation: OperationKey {
            operation_network_id: "n".parse().expect("an id"),
            operation_id: "op".parse().expect("an id"),
        },
        made_at: at,
        received_at: at,
        made_by: "otto".to_owned(),
        action: Action::Value {
            dynamic_data_request_id: request_of(name).parse().expect("an id"),
            field_name: name.parse().expect("a name"),
            value,
        },
    }
}

async fn connect(folder: &Path) -> SqliteConnection {
    let options = SqliteConnectOptions::new().filename(folder.join("connector.sqlite"));
    options.connect().await.expect("the store opens beside the desk")
}
