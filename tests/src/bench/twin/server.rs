//! A twin for measuring: documents without a platform, and a connector that takes everything.

use std::{
    collections::HashMap, io::Read as _, net::IpAddr, path::Path, sync::Arc, time::Duration,
};

use anyhow::Context as _;
use asi_model::{
    BuiltInType, DataValue, DateTime, FactoryId, FieldKey, StatusCode,
    messages::{MappingState, OperationNetworkMessage, PlatformMessage, ValueSource},
};
use async_trait::async_trait;
use disclosure::{Gate, GateState, Released};
use serde_json::json;
use tokio::task::JoinHandle;
use tokio_util::sync::CancellationToken;
use twin::{
    AsiDocument, Authenticator, FieldRecord, FieldWriter, Role, SignInRefusal, Twin, TwinConfig,
    TwinDecision, TwinError, TwinHandle, TwinUser,
};

/// Factory of the twin.
pub(super) const FACTORY: &str = "FOR_MUC";
/// Variables of the server that is compared, and how often all of them change.
pub(super) const VARIABLES: usize = 5000;
pub(super) const PERIOD: Duration = Duration::from_millis(100);
/// Fields of each network there.
const FIELDS_PER_NETWORK: usize = 500;

struct Taker;

#[async_trait]
impl FieldWriter for Taker {
    async fn write(&self, _: &FieldKey, _: DataValue, _: &TwinUser) -> StatusCode {
        StatusCode::GOOD
    }

    async fn decide(&self, _: &FieldKey, _: TwinDecision, _: &TwinUser) -> StatusCode {
        StatusCode::GOOD
    }
}

#[async_trait]
impl Authenticator for Taker {
    async fn authenticate(
        &self,
        _: &str,
        _: &str,
        _: Option<IpAddr>,
    ) -> Result<Role, SignInRefusal> {
        Ok(Role::Viewer)
    }
}

pub(super) struct Running {
    pub handle: TwinHandle,
    pub url: Arc<str>,
    shutdown: CancellationToken,
    task: JoinHandle<Result<(), TwinError>>,
}

impl Running {
    /// Starts a twin on a free port.
    pub async fn start(folder: &Path) -> anyhow::Result<Self> {
        let (twin, handle) = new(folder)?;
        let shutdown = CancellationToken::new();
        let task = tokio::spawn(twin.run(shutdown.clone()));
        let url = handle.ready().await?;
        Ok(Self { handle, url, shutdown, task })
    }

    /// Stops the twin and waits for its tasks.
    pub async fn stop(self) -> anyhow::Result<()> {
        self.shutdown.cancel();
        Ok(self.task.await??)
    }
}

/// Makes a twin that accepts anonymous readers, as no figure is about signing in.
pub(super) fn new(folder: &Path) -> anyhow::Result<(Twin, TwinHandle)> {
    let mut config = TwinConfig {
        listen: "127.0.0.1:0".parse()?,
        pki_directory: folder.join("twin-pki"),
        ..TwinConfig::default()
    };
    config.security.allow_anonymous_unencrypted = true;
    Ok(Twin::new(FactoryId::new(FACTORY)?, config, Arc::new(Taker), Arc::new(Taker))?)
}

/// Makes a network of one operation with one request, as the platform sends it.
pub(super) fn text(network: usize, fields: usize) -> String {
    let fields: Vec<_> = (0..fields)
        .map(|n| json!({ "name": format!("field{n}"), "type": 9, "unit": "ONE", "semantic": "PRODUCED_QUANTITY" }))
        .collect();
    json!({ "messageType": "operation-network", "messageId": uuid::Uuid::from_u128(network as u128).to_string(),
        "factoryId": FACTORY, "collaborationId": "bench", "revision": 1,
        "operationNetwork": { "operationNetworkId": format!("network-{network}"), "name": "Frame order",
            "operationList": [ { "operationId": "MakeFrame", "operationType": "PRODUCTION", "productId": "FRAME-A",
                "plannedStart": "2027-04-18T06:00:00Z", "plannedQuantity": 12, "quantityUnit": "ONE",
                "dynamicDataRequestList": [ { "dynamicDataRequestId": "Progress",
                    "dynamicDataRequestPublisherId": "ProductionMonitoring", "requesterId": "acme-aero",
                    "recipientList": [ "acme-aero" ], "purpose": "Plan the final assembly",
                    "reportDataFormat": { "reportName": "Progress", "reportFieldList": fields } } ] } ] } })
    .to_string()
}

/// Makes the document of such a message like a connector, with every field mapped.
pub(super) fn document(text: &str) -> anyhow::Result<AsiDocument> {
    let PlatformMessage::OperationNetwork(message) = serde_json::from_str(text)? else {
        anyhow::bail!("the message is an operation network")
    };
    let message: OperationNetworkMessage = message;
    let (by, how): (Arc<str>, Arc<str>) = ("anna".into(), "as it is".into());
    let record = || FieldRecord {
        mapping_state: MappingState::Mapped,
        value_source: Some(ValueSource::External),
        value: Some(released(1, now())),
        disclosure: Some(Arc::clone(&how)),
        decided_by: Some(Arc::clone(&by)),
        decision_time: Some(now()),
        ..FieldRecord::default()
    };
    let network = &message.operation_network;
    let fields = network.fields().map(|(key, _, _)| (key, record())).collect();
    let writers =
        (1..).zip(network.requests()).map(|(writer, (key, _, _))| (key, writer)).collect();
    Ok(AsiDocument { message: Arc::new(message), received_at: now(), writers, fields })
}

/// Returns the keys of a document's fields.
pub(super) fn fields(document: &AsiDocument) -> Vec<FieldKey> {
    document.message.operation_network.fields().map(|(key, _, _)| key).collect()
}

pub(super) fn node(key: &FieldKey) -> String {
    format!("{}/op/MakeFrame/req/Progress/{}", key.request.operation_network_id, key.field_name)
}

/// Lets a number through an open gate, which is the only way to show one.
pub(super) fn released(number: u64, at: DateTime) -> Released {
    let mut gate = Gate::new(Arc::default(), BuiltInType::UInt64, GateState::default(), at);
    gate.on(at, DataValue::good(number, at));
    gate.disclosed().expect("an open gate releases at once").clone()
}

pub(super) fn now() -> DateTime {
    std::time::SystemTime::now().into()
}

/// Runs the server that is compared: prints its endpoint, then changes all variables repeatedly.
pub(in crate::bench) async fn serve() -> anyhow::Result<()> {
    let folder = tempfile::tempdir()?;
    let twin = Running::start(folder.path()).await?;
    let mut keys = Vec::new();
    for network in 0..VARIABLES / FIELDS_PER_NETWORK {
        let document = document(&text(network, FIELDS_PER_NETWORK))?;
        keys.extend(fields(&document));
        twin.handle.apply(document);
    }
    let nodes: HashMap<usize, String> = keys.iter().map(node).enumerate().collect();
    let nodes: Vec<String> = (0..keys.len()).map(|n| format!("ns=3;s={}", nodes[&n])).collect();
    crate::harness::say(&json!({ "url": twin.url.as_ref(), "nodes": nodes }).to_string());
    let ended = tokio::task::spawn_blocking(|| std::io::stdin().read_to_end(&mut Vec::new()));
    let change = async {
        let mut tick = tokio::time::interval(PERIOD);
        for value in 2_u64.. {
            tick.tick().await;
            let at = now();
            twin.handle.publish_values(
                keys.iter().map(|key| (key.clone(), released(value, at))).collect(),
            );
        }
    };
    tokio::select! {
        () = change => {}
        read = ended => drop(read.context("waiting for the end")?),
    }
    twin.stop().await
}
