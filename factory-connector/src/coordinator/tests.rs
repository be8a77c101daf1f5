//! The coordinator with a real store, spool and twin. Tests take the parts of people, platform and
//! link.

#![allow(clippy::disallowed_methods, reason = "tests run by the machine's clock")]

mod answers;
mod caps;
mod crash;
mod failures;
mod knowledge;
mod lease;
mod ledger;
mod lookup;
mod mapping_states;
mod message_ids;
mod message_times;
mod opc_ua_decisions;
mod past;
mod receipts;
mod replacement;
mod retention;
mod revocation;
mod signatures;
mod ways_to_the_gate;
mod witness;

use std::{
    path::{Path, PathBuf},
    sync::Arc,
    time::Duration,
};

use asi_model::{DataValue, FieldKey, StatusCode, messages::ValueSource, pubsub::json::Encoding};
use async_trait::async_trait;
use connector_state::{
    EngineCommand, StateConfig,
    operator::{Action, EntryId, OperationKey, OperatorEntry},
    use_cases::{
        decide::{DecisionCommand, DecisionRequest, decide},
        enter::{EntryOutcome, enter_all},
        revoke::{Revocation, revoke},
    },
};
use disclosure::{DecisionBasis, DisclosurePolicy};
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
use crate::clock::new_message_id;
use crate::config::{RetentionLimits, SpoolLimits};
use crate::{
    in_flight::InFlight,
    keep_alive_queue::KeepAliveQueue,
    lease::LeaseGate,
    ledger_key::{self, LEDGER_KEY_FILE},
    link_adapter::ConnectorSpool,
    live_events::LiveEvents,
    message_signer::MessageSigner,
    store::{LedgerCursor, LedgerFilter, Readers, StoreSession},
};

/// Longest time that anything may take.
const DEADLINE: Duration = Duration::from_secs(30);
/// Pause between two polls.
const PAUSE: Duration = Duration::from_millis(2);

struct Nobody;

#[async_trait]
impl twin::FieldWriter for Nobody {
    async fn write(&self, _: &FieldKey, _: DataValue, _: &twin::TwinUser) -> StatusCode {
        StatusCode::BAD_NOT_WRITABLE
    }
    async fn decide(&self, _: &FieldKey, _: twin::TwinDecision, _: &twin::TwinUser) -> StatusCode {
        StatusCode::BAD_NOT_WRITABLE
    }
}

#[async_trait]
impl twin::Authenticator for Nobody {
    async fn authenticate(
        &self,
        _: &str,
        _: &str,
        _: Option<std::net::IpAddr>,
    ) -> Result<twin::Role, twin::SignInRefusal> {
        Err(twin::SignInRefusal::WrongCredentials)
    }
}

struct Running {
    folder: PathBuf,
    kept: Option<TempDir>,
    coordinator: CoordinatorHandle,
    spool: ConnectorSpool,
    gate: Arc<LeaseGate>,
    readers: Readers,
    shutdown: CancellationToken,
    running: JoinHandle<Result<(), StoreError>>,
    _twin: twin::Twin,
    work: mpsc::Receiver<Vec<EngineCommand>>,
    candidates: mpsc::Sender<Vec<Candidate>>,
}

impl Running {
    async fn open() -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        Self::open_in(folder.path().to_owned(), Some(folder)).await
    }

    async fn open_in(folder: PathBuf, kept: Option<TempDir>) -> Self {
        Self::open_with(folder, kept, Duration::from_millis(1)).await
    }

    async fn open_with(
        folder: PathBuf,
        kept: Option<TempDir>,
        publishing_interval: Duration,
    ) -> Self {
        Self::open_waiting(folder, kept, publishing_interval, DEADLINE).await
    }

    /// Opens a connector whose reports wait so long at most for the word of the ledger's witness.
    async fn open_waiting(
        folder: PathBuf,
        kept: Option<TempDir>,
        publishing_interval: Duration,
        witness_wait: Duration,
    ) -> Self {
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
        let (coordinator, commands) = channel();
        let (mappings, work) = mpsc::channel(64);
        let (candidates_in, candidates) = mpsc::channel(64);
        let keep_alives = Arc::new(KeepAliveQueue::default());
        let in_flight = Arc::new(InFlight::default());
        let gate = Arc::new(LeaseGate::default());
        gate.open(1);
        let spool = ConnectorSpool::new(
            factory_id.clone(),
            readers.clone(),
            coordinator.clone(),
            Arc::clone(&keep_alives),
            Arc::clone(&in_flight),
            Arc::clone(&gate),
            MessageSigner::new(factory_id.clone(), key.clone()).expect("a key"),
        );
        let config = CoordinatorConfig {
            state: StateConfig { factory_id, encoding: Encoding::Digicor },
            publishing_interval,
            spool: SpoolLimits::default(),
            retention: RetentionLimits::default(),
            witness_wait,
        };
        let outputs = Outputs {
            twin: twin_handle,
            mappings,
            link: None,
            keep_alives,
            in_flight,
            events: LiveEvents::new(64, 1),
        };
        let made = Coordinator::new(config, store, outputs, key, commands, candidates)
            .await
            .expect("the store is read");
        let shutdown = CancellationToken::new();
        let running = tokio::spawn(made.run(shutdown.clone()));
        Self {
            folder,
            kept,
            coordinator,
            spool,
            gate,
            readers,
            shutdown,
            running,
            _twin: twin,
            work,
            candidates: candidates_in,
        }
    }

    /// Stops, and returns the folder.
    async fn close(self) -> TempDir {
        self.shutdown.cancel();
        self.running.await.expect("it ends").expect("in good order");
        self.kept.expect("a folder of its own")
    }

    async fn receive(&self, subject: &str, body: Value) {
        let envelope = Envelope::new(new_message_id(), subject, body.to_string());
        let delivery = Delivery {
            envelope,
            is_redelivered: false,
            delivery_count: 0,
            received_at: OffsetDateTime::now_utc(),
        };
        self.coordinator.deliver(vec![delivery]).await;
    }

    /// Opens two requests of one operation, each with one field that is decided Manual, for two
    /// recipients.
    async fn with_two_open_fields() -> Self {
        let running = Self::open().await;
        running.receive("operation-network", network(1)).await;
        running.open_fields().await;
        running
    }

    async fn open_fields(&self) {
        for name in ["made", "note"] {
            let command = DecisionCommand::Map {
                value_source: ValueSource::Manual,
                mapping: None,
                policy: DisclosurePolicy::default(),
            };
            decide_field(&self.coordinator, field(name), command).await;
        }
    }

    /// Types values into both fields: one message with two reports.
    async fn enter_both(&self, number: u64) {
        let entries =
            vec![entry("made", json!(number)), entry("note", json!(format!("note {number}")))];
        let outcomes = self.enter(entries).await.expect("written");
        assert!(
            outcomes.iter().all(|outcome| matches!(outcome, EntryOutcome::Taken(_))),
            "{outcomes:?}"
        );
    }

    async fn enter(
        &self,
        entries: Vec<OperatorEntry>,
    ) -> Result<Vec<EntryOutcome>, CoordinatorError> {
        self.coordinator.execute(|state, now| enter_all(state, entries, now)).await
    }

    /// Ends the consent to `made`; the receipt's id.
    async fn revoke(&self, reason: Option<&str>) -> String {
        let revocation = Revocation {
            fields: vec![field("made")],
            command: DecisionCommand::LeavePending,
            reason: reason.map(str::to_owned),
            revoked_by: "eve".to_owned(),
        };
        let revoked =
            self.coordinator.execute(move |state, now| revoke(state, &revocation, now)).await;
        revoked.expect("written").expect("revoked").to_string()
    }

    /// Returns the messages that the link would fetch.
    async fn fetch(&self, lane: Lane) -> Vec<SpoolRow> {
        let fetch = Fetch { lane, after: RowId(0), through: None, limit: 1000 };
        self.spool.fetch(fetch).await.expect("the spool is read")
    }

    /// Lets the broker accept these messages, as far as they may leave, and returns their number.
    async fn accept(&self, rows: &[SpoolRow]) -> usize {
        let left: Vec<_> = rows.iter().filter(|row| self.spool.may_leave(row)).collect();
        let outcome = |row: &&SpoolRow| RowOutcome {
            id: row.id,
            outcome: SendOutcome::Accepted,
            at: OffsetDateTime::now_utc(),
        };
        self.spool.record(left.iter().map(outcome).collect()).await.expect("recorded");
        left.len()
    }

    async fn receipt(&self, report: &Report, through: u32) {
        self.receipt_without(report, through, &[]).await;
    }

    /// Delivers a receipt that lists these numbers as missing.
    async fn receipt_without(&self, report: &Report, through: u32, missing: &[u32]) {
        let body = json!({ "messageType": "receipt", "messageId": new_message_id(), "factoryId": "F", "receiptList": [
            { "dataSetWriterId": report.writer, "epoch": report.epoch, "throughSequence": through,
              "missingList": missing } ] });
        self.receive("receipt", body).await;
    }

    async fn entries(&self, recipient: &str) -> Vec<Value> {
        let filter = LedgerFilter { recipient: recipient.parse().ok(), ..LedgerFilter::default() };
        let mut cursor = LedgerCursor::new(filter);
        let rows = self.session().await.ledger().next(&mut cursor).await.expect("read");
        rows.iter().map(|row| serde_json::from_str(&row.content).expect("JSON")).collect()
    }

    async fn session(&self) -> StoreSession {
        self.readers.session().await.expect("a connection")
    }
}

/// A report as it was sent.
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
        entry_id: fresh_entry_id(),
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

fn fresh_entry_id() -> EntryId {
    uuid::Uuid::now_v7().to_string().try_into().expect("a UUID is an id")
}

async fn decide_field(coordinator: &CoordinatorHandle, key: FieldKey, command: DecisionCommand) {
    let (decided_by, basis) = ("eve".to_owned(), DecisionBasis::default());
    let request = DecisionRequest { command, reason: None, decided_by, basis, preview: None };
    let decided = coordinator.execute(move |state, now| decide(state, &key, request, now)).await;
    decided.expect("written").expect("decided");
}

async fn connect(folder: &Path) -> SqliteConnection {
    let options = SqliteConnectOptions::new().filename(folder.join("connector.sqlite"));
    options.connect().await.expect("the store opens beside the coordinator")
}
