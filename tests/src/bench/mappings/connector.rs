//! A connector whose store is filled beforehand: enrolled, one network, one field per counter of a
//! bank, each mapped.

use std::{
    sync::atomic::{AtomicU64, Ordering},
    time::Duration,
};

use asi_model::{
    DateTime, FactoryId,
    messages::{OperationNetworkMessage, ValueSource},
    pubsub::json::Encoding,
};
use connector_state::{
    ConnectorState, IdSource, StateConfig,
    transaction::{self, DeliveryState},
    use_cases::{
        configuration::put_source,
        decide::{DecisionCommand, DecisionRequest, decide},
        revise::receive_network,
    },
    writes::SourceRow,
};
use daemon::sealing::{Sealer, SealingConfig};
use disclosure::{DecisionBasis, DisclosurePolicy};
use factory_connector::{
    ledger_key::LEDGER_KEY_FILE,
    passwords,
    store::{Enrolment, SecretHolder, Store},
};
use serde_json::{Value, json};
use tempfile::TempDir;

use super::bank::{Bank, node};
use crate::{
    bench::usage::Usage,
    harness::{Api, Daemon, DaemonCommand, binary, eventually, write_private},
};

const FACTORY: &str = "BENCH";
const PASSWORD: &str = "a long password for benchmarks";
/// Fields of each request.
const FIELDS: u32 = 500;

/// Interval of asking for progress: long enough not to be work itself.
const ASK_INTERVAL: Duration = Duration::from_millis(100);

/// Longest wait for a start to be over.
const SETTLING_MAX: Duration = Duration::from_secs(60);

/// The data directory of a connector that does not run yet.
pub(super) struct Filled {
    folder: TempDir,
}

impl Filled {
    /// Fills a store with one field per counter, mapped through these steps; undecided where they
    /// are null.
    pub async fn with(bank: &Bank, steps: &Value) -> anyhow::Result<Self> {
        let folder = tempfile::Builder::new().prefix("verbund-connector-").tempdir()?;
        fill(&folder.path().join("data"), bank, steps).await?;
        Ok(Self { folder })
    }
}

/// A running connector; it ends when this is dropped.
pub(super) struct Connector {
    daemon: Daemon,
    api: Api,
    _folder: TempDir,
}

impl Connector {
    /// Starts a connector on a store.
    pub async fn start(filled: Filled) -> anyhow::Result<Self> {
        let folder = filled.folder;
        let data = folder.path().join("data");
        let [web, twin] = free_ports::reserve()?;
        let config = folder.path().join("connector.toml");
        let text = format!(
            "data_directory = {data:?}\n\n[web]\nlisten = \"127.0.0.1:{web}\"\n\n[twin]\nlisten = \"127.0.0.1:{twin}\"\n\n\
             [reports]\npublishing_interval_ms = 1000\n\n[admin]\nuser_name = \"engineer\"\npassword = \"{PASSWORD}\"\n"
        );
        write_private(&config, &text)?;
        let mut daemon = Daemon::start(DaemonCommand {
            name: "connector".to_owned(),
            program: binary("factory-connector")?,
            arguments: vec!["run".to_owned(), "--config".to_owned(), config.display().to_string()],
            environment: Vec::new(),
            log: folder.path().join("connector.log"),
        })?;
        let base = format!("http://127.0.0.1:{web}");
        let answers = eventually("the connector answers", Duration::from_secs(60), || async {
            let mut api = Api::new(&base).map_err(|error| format!("{error:#}"))?;
            api.sign_in("engineer", PASSWORD).await.map_err(|error| format!("{error:#}"))?;
            Ok(api)
        })
        .await;
        match answers {
            Ok(api) => Ok(Self { daemon, api, _folder: folder }),
            Err(error) => {
                daemon.kill().ok();
                anyhow::bail!("{error:#}\n{}", daemon.log_tail(20));
            }
        }
    }

    /// Waits until the server monitors so many inputs.
    pub async fn until_live(&self, inputs: u32, patience: Duration) -> anyhow::Result<()> {
        self.until("live", inputs, patience).await
    }

    /// Waits until so many inputs would be found again if the server gave them other ids.
    pub async fn until_paths_are_learned(
        &self,
        inputs: u32,
        patience: Duration,
    ) -> anyhow::Result<()> {
        self.until("findable", inputs, patience).await
    }

    async fn until(&self, member: &str, inputs: u32, patience: Duration) -> anyhow::Result<()> {
        eventually(&format!("all inputs are {member}"), patience, || async {
            let status: Value =
                self.api.get("/api/v1/status").await.map_err(|error| format!("{error:#}"))?;
            let count = status["sources"][0][member].as_u64().unwrap_or_default();
            if count >= u64::from(inputs) {
                return Ok(());
            }
            tokio::time::sleep(ASK_INTERVAL).await;
            Err(format!("{count} of {inputs}"))
        })
        .await
    }

    /// Candidates that were accepted since the start.
    pub async fn candidates(&self) -> anyhow::Result<f64> {
        let metrics = self.api.text("/metrics").await?;
        let line = metrics.lines().find_map(|line| line.strip_prefix("verbund_candidates_total "));
        Ok(line.and_then(|value| value.trim().parse().ok()).unwrap_or_default())
    }

    /// Memory and processor time of the connector and its workers.
    pub fn usage(&self) -> anyhow::Result<Usage> {
        Usage::of(self.daemon.pid())
    }

    /// Returns the resident memory once it changes by less than a hundredth within a second.
    pub async fn settled_bytes(&self) -> anyhow::Result<u64> {
        let before = AtomicU64::new(0);
        eventually("the memory settles", SETTLING_MAX, || async {
            tokio::time::sleep(Duration::from_secs(1)).await;
            let now = self.usage().map_err(|error| format!("{error:#}"))?.resident_bytes;
            if now.abs_diff(before.swap(now, Ordering::Relaxed)) < now / 100 {
                Ok(now)
            } else {
                Err(format!("{now} bytes"))
            }
        })
        .await
    }

    /// Stops the connector and waits for its end.
    pub fn stop(&mut self) -> anyhow::Result<()> {
        self.daemon.stop(Duration::from_secs(20)).map(drop)
    }
}

async fn fill(data: &std::path::Path, bank: &Bank, steps: &Value) -> anyhow::Result<()> {
    daemon::data_directory::create(data, false)?;
    let now = DateTime::from(std::time::SystemTime::now());
    let factory_id: FactoryId = FACTORY.parse()?;
    let mut session = Store::connect(data).await?;
    // Nothing listens there: what is measured ends at the spool.
    let sealer = Sealer::new(&SealingConfig::default(), data);
    let sealed = passwords::seal(&sealer, &SecretHolder::Broker, "none")?;
    let enrolment = Enrolment {
        factory_id: FACTORY.to_owned(),
        broker_url: "amqp://127.0.0.1:1".to_owned(),
        profile: r#""embedded""#.to_owned(),
        user_name: FACTORY.to_owned(),
        sealed_password: Some(sealed),
        root_certificate_pem: None,
    };
    session.enrolments().put(&enrolment, now).await?;
    drop(session);
    let mut store = Store::open(data, &factory_id, now).await?;
    let config = StateConfig { factory_id, encoding: Encoding::Digicor };
    let (snapshot, ids) = (store.load().await?, IdSource::new(rand::random()));
    let (mut state, mut pending) = ConnectorState::load(config, snapshot, ids, false, now)?;
    let message: OperationNetworkMessage = serde_json::from_value(network(bank.variables))?;
    let raw = serde_json::to_string(&message)?;
    let fields: Vec<_> = message.operation_network.fields().map(|(key, ..)| key).collect();
    pending.merge(receive_network(&mut state, message, raw, now));
    for (index, key) in (0..).zip(fields).filter(|_| !steps.is_null()) {
        let mapping = json!({ "mappingId": format!("field-{}", index + 1), "target": key, "targetType": "Double",
            "inputs": [{ "name": "input", "sourceId": "bank", "nodeId": node(index), "valueType": "Int64",
                         "monitor": { "samplingIntervalMs": 0.0 } }],
            "steps": steps });
        let command = DecisionCommand::Map {
            value_source: ValueSource::Mapping,
            mapping: Some(serde_json::from_value(mapping)?),
            policy: DisclosurePolicy::default(),
        };
        let (decided_by, basis) = ("engineer".to_owned(), DecisionBasis::default());
        let request = DecisionRequest { command, reason: None, decided_by, basis, preview: None };
        pending.merge(decide(&mut state, &key, request, now)?);
    }
    let source = bank.source()?;
    let config = serde_json::to_string(&source)?;
    let source_id = source.source_id.to_string();
    pending.merge(put_source(SourceRow { source_id, config, sealed_password: None }));
    let key = factory_connector::ledger_key::open(&data.join(LEDGER_KEY_FILE))?;
    let (writes, _) = transaction::refresh(&mut state, pending)
        .take_back(&mut state, DeliveryState::default(), &key, now)
        .report(&mut state, now, rand::random)
        .sign(&mut state, &key);
    store.commit(writes).await?;
    store.close().await;
    Ok(())
}

fn network(fields: u32) -> Value {
    let requests = (0..fields.div_ceil(FIELDS)).map(|request| {
        let fields = (request * FIELDS..fields.min((request + 1) * FIELDS))
            .map(|field| json!({ "name": format!("f{field}"), "type": 11 }));
        json!({ "dynamicDataRequestId": format!("R{request}"), "requesterId": "acme", "recipientList": ["acme"],
            "purpose": "Benchmark", "updateFrequency": 1, "updateFrequencyUnit": "SECOND",
            "reportDataFormat": { "reportName": "Load", "reportFieldList": fields.collect::<Vec<_>>() } })
    });
    json!({ "messageId": "m1", "factoryId": FACTORY, "collaborationId": "bench", "revision": 1,
        "operationNetwork": { "operationNetworkId": "bench", "operationList": [ { "operationId": "op",
            "operationType": "PRODUCTION", "dynamicDataRequestList": requests.collect::<Vec<_>>() } ] } })
}
