//! A small plant for tests: one network with one request of two fields, `made` and `note`.

use asi_model::{
    DataValue, DateTime, FieldKey, RequestKey, Variant,
    messages::{OperationNetworkMessage, ValueSource},
    pubsub::json::Encoding,
};
use disclosure::{DecisionBasis, DisclosurePolicy, GateOutcome};
use ledger::{LedgerKey, SALT_BYTES};
use serde_json::{Value, json};

use crate::{
    ChangeSet, ConnectorState, Effects, IdSource, Snapshot, StateConfig, Writes,
    transaction::{self, DeliveryState},
    use_cases::{
        decide::{DecisionCommand, DecisionError, DecisionRequest, decide},
        revise, values,
    },
};

/// Start of all test times, in microseconds since 1970.
const START: i64 = 1_800_000_000_000_000;

/// Returns a time, in milliseconds after the start.
#[must_use]
pub fn at(ms: i64) -> DateTime {
    DateTime::from_unix_micros(START + ms * 1_000)
}

/// Returns the key of a field of the request.
///
/// # Panics
/// When the name is none.
#[must_use]
pub fn field(name: &str) -> FieldKey {
    let request = RequestKey {
        operation_network_id: "n".parse().expect("an id"),
        operation_id: "op".parse().expect("an id"),
        dynamic_data_request_id: "R1".parse().expect("an id"),
    };
    request.field(name.parse().expect("a name"))
}

/// Returns the network in a revision, with a changed request.
///
/// # Panics
/// When the change leaves no valid network.
pub fn network(revision: u64, change: impl FnOnce(&mut Value)) -> OperationNetworkMessage {
    let mut request = json!({ "dynamicDataRequestId": "R1", "requesterId": "acme",
        "recipientList": ["acme", "hull"], "purpose": "Plan", "updateFrequency": 1,
        "updateFrequencyUnit": "HOUR", "reportDataFormat": { "reportName": "Progress",
        "reportFieldList": [
            { "name": "made", "type": 9, "unit": "PIECE", "semantic": "PRODUCED_QUANTITY" },
            { "name": "note", "type": 12 } ] } });
    change(&mut request);
    serde_json::from_value(json!({ "messageId": format!("m{revision}"), "factoryId": "F",
        "collaborationId": "c", "revision": revision, "operationNetwork": {
            "operationNetworkId": "n", "operationList": [ { "operationId": "op",
            "operationType": "PRODUCTION", "dynamicDataRequestList": [request] } ] } }))
    .expect("a network")
}

/// Makes a decision without a reason and a basis, by `eve`.
#[must_use]
pub fn decision(command: DecisionCommand) -> DecisionRequest {
    let basis = DecisionBasis::default();
    DecisionRequest { command, reason: None, decided_by: "eve".to_owned(), basis, preview: None }
}

/// State with the changes of the transaction that is being made.
pub struct Scene {
    pub state: ConnectorState,
    pub pending: ChangeSet,
}

impl Default for Scene {
    fn default() -> Self {
        let mut scene = Self::empty();
        scene.arrive(network(1, |_| ()));
        scene
    }
}

impl Scene {
    /// Makes a state without a network.
    ///
    /// # Panics
    /// Never: an empty snapshot can be read.
    #[must_use]
    pub fn empty() -> Self {
        let config =
            StateConfig { factory_id: "F".parse().expect("an id"), encoding: Encoding::Digicor };
        let ids = IdSource::new([7; 32]);
        let (state, pending) =
            ConnectorState::load(config, Snapshot::default(), ids, false, at(0)).expect("empty");
        Self { state, pending }
    }

    /// Adds the changes of a use case.
    pub fn run(&mut self, use_case: impl FnOnce(&mut ConnectorState) -> ChangeSet) {
        let changes = use_case(&mut self.state);
        self.pending.merge(changes);
    }

    /// Adds the changes of a use case, and returns its result.
    ///
    /// # Errors
    /// The error of the use case.
    pub fn attempt<T, E>(
        &mut self,
        use_case: impl FnOnce(&mut ConnectorState) -> Result<(T, ChangeSet), E>,
    ) -> Result<T, E> {
        let (result, changes) = use_case(&mut self.state)?;
        self.pending.merge(changes);
        Ok(result)
    }

    /// Receives a network.
    ///
    /// # Panics
    /// Never: networks serialise.
    pub fn arrive(&mut self, message: OperationNetworkMessage) {
        self.arrive_at(message, 0);
    }

    /// Receives a network at a time.
    ///
    /// # Panics
    /// Never: networks serialise.
    pub fn arrive_at(&mut self, message: OperationNetworkMessage, ms: i64) {
        let json = serde_json::to_string(&message).expect("serialises");
        self.run(|state| revise::receive_network(state, message, json, at(ms)));
    }

    /// Decides about a field.
    ///
    /// # Errors
    /// [`DecisionError`].
    pub fn decide(
        &mut self,
        name: &str,
        request: DecisionRequest,
        ms: i64,
    ) -> Result<(), DecisionError> {
        self.attempt(|state| Ok(((), decide(state, &field(name), request, at(ms))?)))
    }

    /// Maps a field to a source with a policy as JSON.
    ///
    /// # Panics
    /// When the decision is not taken.
    pub fn map(&mut self, name: &str, value_source: ValueSource, policy: &str) {
        let mapping = (value_source == ValueSource::Mapping).then(|| {
            let json = json!({ "mappingId": "m", "target": field(name), "targetType": "UInt64",
                "inputs": [], "steps": [] });
            serde_json::from_value(json).expect("a mapping")
        });
        let policy: DisclosurePolicy = serde_json::from_str(policy).expect("a policy");
        let command = DecisionCommand::Map { value_source, mapping, policy };
        self.decide(name, decision(command), 0).expect("decided");
    }

    /// Offers a value of a source to a field; `None` where the field does not accept it.
    pub fn candidate(
        &mut self,
        name: &str,
        source: ValueSource,
        value: impl Into<Variant>,
        ms: i64,
    ) -> Option<GateOutcome> {
        let value = DataValue::good(value, at(ms));
        let id = self.state.field(&field(name))?.id();
        values::receive_candidate(&mut self.state, id, source, value, None, at(ms))
    }

    /// Offers a value of an operator, commits, and returns the reports.
    ///
    /// # Panics
    /// When a report is not JSON.
    pub fn offer(&mut self, name: &str, value: impl Into<Variant>, ms: i64) -> Vec<Value> {
        self.candidate(name, ValueSource::Manual, value, ms);
        let (writes, _) = self.commit(ms);
        let reports = writes.reports.queued.iter();
        reports.map(|report| serde_json::from_str(&report.body).expect("JSON")).collect()
    }

    /// Commits: nothing of what was queued before was sent.
    pub fn commit(&mut self, ms: i64) -> (Writes, Effects) {
        self.commit_with(DeliveryState::default(), ms)
    }

    /// Commits with this delivery of earlier reports.
    pub fn commit_with(&mut self, delivery: DeliveryState, ms: i64) -> (Writes, Effects) {
        let key = LedgerKey::from_secret(&[3; 32]);
        let state = &mut self.state;
        transaction::refresh(state, std::mem::take(&mut self.pending))
            .take_back(state, delivery, &key, at(ms))
            .report(state, at(ms), || [7; SALT_BYTES])
            .sign(state, &key)
    }
}
