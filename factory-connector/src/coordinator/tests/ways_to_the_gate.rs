//! Ways in which a field can be written, through the real coordinator, store and twin: each passes
//! the gate.

mod places;

use std::path::Path;

use asi_model::{DataValue, StatusCode, Variant, messages::ValueSource};
use connector_state::{
    ConnectorState,
    scene::{field, network},
    use_cases::revise::receive_network,
};
use twin::{FieldWriter as _, Twin, TwinConfig, TwinUser};

use super::*;
use crate::twin_adapter::CoordinatorWriter;

/// Origins of values. A new one must be listed here: a test searches the sources for others.
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

struct Gateway {
    handle: CoordinatorHandle,
    candidates: mpsc::Sender<Vec<Candidate>>,
    readers: crate::store::Readers,
    shutdown: CancellationToken,
    task: JoinHandle<Result<(), StoreError>>,
    /// Kept so that decisions about mappings have somewhere to go.
    _mappings: mpsc::Receiver<Vec<EngineCommand>>,
}

async fn start(directory: &Path) -> Gateway {
    let factory_id: asi_model::FactoryId = "F".parse().expect("an id");
    let store = Store::open(directory, &factory_id, now()).await.expect("a store");
    let (handle, commands) = channel();
    let config = TwinConfig {
        listen: std::net::SocketAddr::from((std::net::Ipv4Addr::LOCALHOST, 0)),
        pki_directory: directory.join("pki"),
        ..TwinConfig::default()
    };
    let writer = Arc::new(CoordinatorWriter(handle.clone()));
    let (_, twin) =
        Twin::new(factory_id.clone(), config, writer, Arc::new(Nobody)).expect("a twin");
    let (mappings, mapping_work) = mpsc::channel(64);
    let (candidates, candidate_work) = mpsc::channel(64);
    let outputs = Outputs {
        twin,
        mappings,
        link: None,
        keep_alives: Arc::default(),
        in_flight: Arc::default(),
        events: LiveEvents::new(64, 1),
    };
    let key = crate::ledger_key::open(&directory.join("key.pem")).expect("a key");
    let readers = store.readers();
    let config = CoordinatorConfig {
        state: StateConfig { factory_id, encoding: asi_model::pubsub::json::Encoding::Digicor },
        publishing_interval: Duration::from_millis(1),
        spool: SpoolLimits::default(),
        retention: RetentionLimits::default(),
        witness_wait: Duration::ZERO,
    };
    let coordinator = Coordinator::new(config, store, outputs, key, commands, candidate_work)
        .await
        .expect("a coordinator");
    let shutdown = CancellationToken::new();
    let task = tokio::spawn(coordinator.run(shutdown.clone()));
    Gateway { handle, candidates, readers, shutdown, task, _mappings: mapping_work }
}

fn mapping() -> mapping_engine::Mapping {
    let json = serde_json::json!({ "mappingId": "m", "target": field("made"), "targetType": "UInt64",
        "inputs": [], "steps": [] });
    serde_json::from_value(json).expect("a mapping")
}

impl Gateway {
    async fn stop(self) {
        self.shutdown.cancel();
        self.task.await.expect("no panic").expect("stopped");
    }

    /// Opens the field for one source, coarsely.
    async fn open(&self, source: ValueSource) {
        let policy: DisclosurePolicy =
            serde_json::from_str(r#"{"roundingStep":10}"#).expect("a policy");
        let mapping = (source == ValueSource::Mapping).then(|| Box::new(mapping()));
        let command = DecisionCommand::Map { value_source: source, mapping, policy };
        decide_field(&self.handle, field("made"), command).await;
    }

    async fn bring(&self, way: Way, number: u64) {
        let value = || DataValue::good(number, now());
        match way {
            Way::Mapping | Way::LostSource => {
                let lost = DataValue { status: StatusCode::BAD_NO_DATA, ..value() };
                let value = if matches!(way, Way::LostSource) { lost } else { value() };
                let number = |state: &ConnectorState| {
                    state.field(&field("made")).map(|field| field.target_key())
                };
                let target =
                    self.handle.read(number).await.expect("read").expect("the field is requested");
                let candidate = Candidate { target, value, state: None };
                self.candidates.send(vec![candidate]).await.expect("taken");
            }
            Way::OpcUaWrite => {
                let user = TwinUser { name: "client".into(), role: twin::Role::Engineer };
                let status = CoordinatorWriter(self.handle.clone())
                    .write(&field("made"), value(), &user)
                    .await;
                assert_eq!(status, StatusCode::GOOD_CLAMPED);
            }
            Way::TypedValue => {
                self.handle
                    .write_value(field("made"), ValueSource::Manual, value())
                    .await
                    .expect("taken");
            }
            Way::OperatorsPage => {
                let request = field("made").request;
                let entry = OperatorEntry {
                    entry_id: fresh_entry_id(),
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
                self.handle
                    .execute(|state, now| enter_all(state, vec![entry], now))
                    .await
                    .expect("entered");
            }
        }
    }

    /// Returns the value that the twin's node shows.
    async fn shown(&self) -> Option<DataValue> {
        self.handle
            .read(|state| {
                let field = state.field(&field("made"))?;
                field.gate().disclosed().map(|released| DataValue::clone(released))
            })
            .await
            .expect("read")
    }

    /// Returns every value of the field that ever left, from the ledger.
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
    let mut running = start(directory.path()).await;
    let message = network(1, |_| ());
    let raw = serde_json::to_string(&message).expect("serialises");
    running
        .handle
        .execute(move |state, now| receive_network(state, message, raw, now))
        .await
        .expect("arrived");
    for (place, way) in WAYS.into_iter().enumerate() {
        // 17, 117, 217, ...: each leaves as the ten above it.
        let number = place as u64 * 100 + 17;
        running.bring_undecided(way, number).await;
        assert_eq!(running.shown().await, None, "{way:?}: nothing is decided");
        running.open(way.source()).await;
        let before = running.left().await.len();
        running.bring(way, number).await;
        let expected =
            if matches!(way, Way::LostSource) { Variant::Null } else { Variant::from(number + 3) };
        let is_shown = || async {
            let shown = running.shown().await;
            let is_it = shown.as_ref().is_some_and(|shown| shown.value == expected);
            if is_it { Ok(()) } else { Err(format!("{shown:?}")) }
        };
        let arrival = format!("{way:?} arrives");
        testkit::wait::eventually(&arrival, DEADLINE, is_shown).await.expect("it arrives");
        let is_reported = || async {
            let count = running.left().await.len();
            if count > before { Ok(()) } else { Err(format!("{count} reports")) }
        };
        let report = format!("{way:?} is reported");
        testkit::wait::eventually(&report, DEADLINE, is_reported).await.expect("it is reported");
        let left = running.left().await;
        // Restored from the store, the gate shows what it showed, and nothing else leaves.
        running.stop().await;
        running = start(directory.path()).await;
        assert_eq!(
            running.shown().await.map(|shown| shown.value),
            Some(expected),
            "{way:?}: after a restart"
        );
        let after = running.left().await;
        assert!(
            after.iter().all(|value| left.contains(value)),
            "{way:?}: a restart let {after:?} leave"
        );
        decide_field(&running.handle, field("made"), DecisionCommand::LeavePending).await;
    }
    for value in running.left().await {
        let number = value["Body"].as_str().and_then(|text| text.parse::<u64>().ok());
        assert!(
            value["Type"] != 9 || number.is_some_and(|number| number % 10 == 0),
            "finer than the step: {value}"
        );
    }
    running.stop().await;
}

impl Gateway {
    /// Brings a value for a field that is open for nobody.
    async fn bring_undecided(&self, way: Way, number: u64) {
        let value = DataValue::good(number, now());
        match way {
            Way::Mapping | Way::LostSource => self.bring(Way::Mapping, number).await,
            Way::OpcUaWrite => {
                let user = TwinUser { name: "client".into(), role: twin::Role::Engineer };
                let status = CoordinatorWriter(self.handle.clone())
                    .write(&field("made"), value, &user)
                    .await;
                assert_eq!(status, StatusCode::BAD_NOT_WRITABLE);
            }
            Way::TypedValue => {
                let taken =
                    self.handle.write_value(field("made"), ValueSource::Manual, value).await;
                assert_eq!(taken, Ok(WriteOutcome::Rejected(StatusCode::BAD_NOT_WRITABLE)));
            }
            Way::OperatorsPage => self.bring(Way::OperatorsPage, number).await,
        }
    }
}
