//! Every way in which a field can be written, through the real desk, store and twin: each passes
//! the gate.

use std::{collections::BTreeMap, path::Path};

use asi_model::{DataValue, StatusCode, Variant, messages::ValueSource};
use tokio::task::JoinHandle;
use twin::{Authenticator, FieldWriter as _, Twin, TwinConfig, TwinUser};

use super::*;
use crate::{
    books::{
        Verdict,
        tests::{field, network},
    },
    operator::{Action, EntryId, OperationKey, OperatorEntry},
    twin_side::DeskWriter,
};
use disclosure::DisclosurePolicy;

/// Who could bring a value. A new way must be listed here: the sources below are looked through for
/// others.
#[derive(Debug, Clone, Copy)]
enum Way {
    /// A mapping's functions or script, alike: what the mapping engine yields is a candidate.
    Mapping,
    /// A source or script that fails, which is a status without value.
    LostSource,
    /// An OPC UA client's write to the twin's node.
    OpcUaWrite,
    /// A value typed at the engineer's page.
    TypedValue,
    /// An entry at the operator's page.
    OperatorsPage,
}

const WAYS: [Way; 5] =
    [Way::Mapping, Way::LostSource, Way::OpcUaWrite, Way::TypedValue, Way::OperatorsPage];

impl Way {
    const fn source(self) -> ValueSource {
        match self {
            Self::Mapping | Self::LostSource => ValueSource::Mapping,
            Self::OpcUaWrite => ValueSource::External,
            Self::TypedValue | Self::OperatorsPage => ValueSource::Manual,
        }
    }
}

struct Nobody;

#[async_trait::async_trait]
impl Authenticator for Nobody {
    async fn authenticate(&self, _: &str, _: &str) -> Option<twin::Role> {
        None
    }
}

struct Running {
    handle: DeskHandle,
    candidates: mpsc::Sender<Vec<Candidate>>,
    readers: crate::store::Readers,
    shutdown: CancellationToken,
    task: JoinHandle<Result<(), StoreError>>,
    /// Kept so that decisions about mappings have somewhere to go.
    _mappings: mpsc::Receiver<Vec<MappingWork>>,
}

async fn start(directory: &Path) -> Running {
    let factory_id: asi_model::FactoryId = "F".parse().expect("an id");
    let store = Store::open(directory, &factory_id, now()).await.expect("a store");
    let (handle, commands) = channel();
    let config = TwinConfig {
        listen: std::net::SocketAddr::from((std::net::Ipv4Addr::LOCALHOST, 0)),
        pki_directory: directory.join("pki"),
        ..TwinConfig::default()
    };
    let writer = Arc::new(DeskWriter(handle.clone()));
    let (_, twin) =
        Twin::new(factory_id.clone(), config, writer, Arc::new(Nobody)).expect("a twin");
    let (mappings, mapping_work) = mpsc::channel(64);
    let (candidates, candidate_work) = mpsc::channel(64);
    let rooms = Rooms {
        twin,
        mappings,
        link: None,
        ephemerals: Arc::default(),
        departures: Arc::default(),
        events: EventLog::new(64, 1),
    };
    let key = crate::ledger_key::open(&directory.join("key.pem")).expect("a key");
    let readers = store.readers();
    let config = DeskConfig {
        books: BooksConfig { factory_id, encoding: asi_model::pubsub::json::Encoding::Digicor },
        publishing_interval: Duration::from_millis(1),
        spool: SpoolLimits::default(),
        retention: RetentionLimits::default(),
    };
    let desk =
        Desk::new(config, store, rooms, key, commands, candidate_work).await.expect("a desk");
    let shutdown = CancellationToken::new();
    let task = tokio::spawn(desk.run(shutdown.clone()));
    Running { handle, candidates, readers, shutdown, task, _mappings: mapping_work }
}

fn mapping() -> mapping_engine::Mapping {
    let json = serde_json::json!({ "mappingId": "m", "target": field("made"), "targetType": "UInt64",
        "inputs": [], "steps": [] });
    serde_json::from_value(json).expect("a mapping")
}

impl Running {
    async fn stop(self) {
        self.shutdown.cancel();
        self.task.await.expect("no panic").expect("stopped");
    }

    /// Opens the field for one source, coarsely.
    async fn open(&self, source: ValueSource) {
        let policy: DisclosurePolicy =
            serde_json::from_str(r#"{"roundingStep":10}"#).expect("a policy");
        let mapping = (source == ValueSource::Mapping).then(|| Box::new(mapping()));
        let verdict = Verdict::Map { value_source: source, mapping, policy };
        self.handle.decide(field("made"), verdict, None, "eve").await.expect("decided");
    }

    async fn bring(&self, way: Way, number: u64) {
        let value = || DataValue::good(number, now());
        match way {
            Way::Mapping | Way::LostSource => {
                let lost = DataValue { status: StatusCode::BAD_NO_DATA, ..value() };
                let value = if matches!(way, Way::LostSource) { lost } else { value() };
                let number =
                    |books: &Books| books.field(&field("made")).map(|field| TargetKey(field.id));
                let target =
                    self.handle.read(number).await.expect("read").expect("the field is requested");
                let candidate = Candidate { target, value, state: None };
                self.candidates.send(vec![candidate]).await.expect("taken");
            }
            Way::OpcUaWrite => {
                let user = TwinUser { name: "client".into(), role: twin::Role::Engineer };
                let status =
                    DeskWriter(self.handle.clone()).write(&field("made"), value(), &user).await;
                assert_eq!(status, StatusCode::GOOD_CLAMPED);
            }
            Way::TypedValue => {
                self.handle
                    .value(field("made"), ValueSource::Manual, value())
                    .await
                    .expect("taken");
            }
            Way::OperatorsPage => {
                let request = field("made").request;
                let entry = OperatorEntry {
                    entry_id: EntryId::fresh(),
                    operation: OperationKey {
                        operation_network_id: request.operation_network_id,
                        operation_id: request.operation_id,
                    },
                    made_at: now(),
                    received_at: now(),
                    made_by: "otto".to_owned(),
                    action: Action::Value {
                        dynamic_data_request_id: request.dynamic_data_request_id,
                        field_name: field("made").field_name,
                        value: number.into(),
                    },
                };
                self.handle.enter(vec![entry]).await.expect("entered");
            }
        }
    }

    /// What the node shows.
    async fn shown(&self) -> Option<DataValue> {
        self.handle
            .read(|books| books.field(&field("made")).and_then(|f| f.gate.disclosed().cloned()))
            .await
            .expect("read")
    }

    /// Every value of the field that ever left, as the ledger keeps it.
    async fn left(&self) -> Vec<serde_json::Value> {
        let statement = "SELECT r.body FROM ledger_entry e JOIN report r ON r.id = e.report_id \
             WHERE e.recipient = 'acme' ORDER BY e.number";
        let bodies: Vec<String> = sqlx::query_scalar(statement)
            .fetch_all(self.readers.session().await.expect("a connection").connection())
            .await
            .expect("the ledger is read");
        let reports = bodies
            .iter()
            .map(|body| serde_json::from_str::<serde_json::Value>(body).expect("JSON"));
        reports
            .map(|report| report["Payload"]["made"].clone())
            .filter(|value| !value.is_null())
            .collect()
    }
}

#[tokio::test]
async fn every_way_in_passes_the_gate() {
    let directory = tempfile::tempdir().expect("a folder");
    let mut desk = start(directory.path()).await;
    let message = network(1, |_| ());
    let raw = serde_json::to_string(&message).expect("serialises");
    desk.handle
        .change(move |books, now| books.network_arrived(message, raw, now))
        .await
        .expect("arrived");
    for (place, way) in WAYS.into_iter().enumerate() {
        // 17, 117, 217, ...: each leaves as the ten above it.
        let number = place as u64 * 100 + 17;
        desk.bring_undecided(way, number).await;
        assert_eq!(desk.shown().await, None, "{way:?}: nothing is decided");
        desk.open(way.source()).await;
        let before = desk.left().await.len();
        desk.bring(way, number).await;
        let expected =
            if matches!(way, Way::LostSource) { Variant::Null } else { Variant::from(number + 3) };
        let deadline = tokio::time::Instant::now() + Duration::from_secs(10);
        while desk.shown().await.is_none_or(|shown| shown.value != expected) {
            assert!(tokio::time::Instant::now() < deadline, "{way:?} never arrived");
            tokio::time::sleep(Duration::from_millis(2)).await;
        }
        while desk.left().await.len() == before {
            assert!(tokio::time::Instant::now() < deadline, "{way:?} was never reported");
            tokio::time::sleep(Duration::from_millis(2)).await;
        }
        let left = desk.left().await;
        // Restored from the store, the gate shows what it showed, and nothing else leaves.
        desk.stop().await;
        desk = start(directory.path()).await;
        assert_eq!(
            desk.shown().await.map(|shown| shown.value),
            Some(expected),
            "{way:?}: after a restart"
        );
        let after = desk.left().await;
        assert!(
            after.iter().all(|value| left.contains(value)),
            "{way:?}: a restart let {after:?} leave"
        );
        let undecided = Verdict::LeavePending;
        desk.handle.decide(field("made"), undecided, None, "eve").await.expect("decided");
    }
    for value in desk.left().await {
        let number = value["Body"].as_str().and_then(|text| text.parse::<u64>().ok());
        assert!(
            value["Type"] != 9 || number.is_some_and(|number| number % 10 == 0),
            "finer than the step: {value}"
        );
    }
    desk.stop().await;
}

impl Running {
    /// Brings a value for a field that is open for nobody.
    async fn bring_undecided(&self, way: Way, number: u64) {
        let value = DataValue::good(number, now());
        match way {
            Way::Mapping | Way::LostSource => self.bring(Way::Mapping, number).await,
            Way::OpcUaWrite => {
                let user = TwinUser { name: "client".into(), role: twin::Role::Engineer };
                let status =
                    DeskWriter(self.handle.clone()).write(&field("made"), value, &user).await;
                assert_eq!(status, StatusCode::BAD_NOT_WRITABLE);
            }
            Way::TypedValue => {
                let taken = self.handle.value(field("made"), ValueSource::Manual, value).await;
                assert_eq!(taken, Ok(Taken::Not(StatusCode::BAD_NOT_WRITABLE)));
            }
            Way::OperatorsPage => self.bring(Way::OperatorsPage, number).await,
        }
    }
}

/// Nothing but the listed ways brings values to a gate, and nothing but the gate decides what is
/// disclosed.
#[test]
fn there_is_no_way_around_the_gate() {
    let mut found: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut folders = vec![package.join("src"), package.join("disclosure/src")];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            let name = path.strip_prefix(package).expect("below it").to_string_lossy();
            let name = name.replace('\\', "/").replace("disclosure/src/", "disclosure/");
            let name = name.trim_start_matches("src/").to_owned();
            if name.contains("tests") {
                continue;
            }
            let text = std::fs::read_to_string(&path).expect("a source");
            let text = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
            for what in [
                ".candidate(",
                ".candidate_for(",
                "gate.on(",
                "disclosed =",
                "GateState {",
                ".gate =",
            ] {
                let count = text.matches(what).count();
                if count > 0 {
                    found.entry(what).or_default().push(format!("{name} {count}"));
                }
            }
        }
    }
    for places in found.values_mut() {
        places.sort();
    }
    // The desk takes candidates of mappings, and values of people and OPC UA clients; the
    // operator's page and the beginning of a request's validity use the same function of the books.
    assert_eq!(
        found[".candidate("],
        ["books/operator.rs 1", "books/validity.rs 1", "desk/messages.rs 1"]
    );
    assert_eq!(found[".candidate_for("], ["books/values.rs 1", "desk.rs 1"]);
    assert_eq!(
        found["gate.on("],
        ["api/preview.rs 1", "books/values.rs 2"],
        "a trial gate's, and the one way in"
    );
    assert_eq!(
        found["GateState {"],
        ["disclosure/gate.rs 2", "disclosure/gate/document.rs 1"],
        "what is read back from the store"
    );
    assert_eq!(
        found[".gate ="],
        ["books/field.rs 1", "books/requests.rs 1"],
        "loaded, or made anew and empty"
    );
    assert_eq!(
        found["disclosed ="],
        ["api/preview.rs 1", "disclosure/gate.rs 3"],
        "a trial gate's, and the gate's own"
    );
}
