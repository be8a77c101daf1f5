//! A plant with requests of several partners.

use asi_model::{
    DateTime, FieldKey, OrganisationId, RequestKey,
    messages::{MappingState, OperationNetworkMessage, ValueSource},
};
use disclosure::{
    Alliance, Cap, CapExcess, DecisionBasis, DisclosurePolicy, DocumentId, NamedPolicy, VariableKey,
};
use mapping::Mapping;
use serde_json::{Value, json};

use crate::{
    DocumentError, Snapshot, StoredNetwork,
    queries::validate_for_field,
    scene::{Scene, at},
    snapshot::{StoredBudgets, StoredPolicies},
    use_cases::{
        alliances::put_alliance,
        caps::put_cap,
        decide::{DecisionCommand, DecisionError, DecisionRequest, decide},
        import_mappings::{MappingImport, import_mappings},
        policies::{put_policy, set_recipient_policy},
    },
};

/// Requests with their recipients.
pub const REQUESTS: [(&str, &[&str]); 4] =
    [("a", &["acme"]), ("a2", &["acme"]), ("b", &["hull"]), ("c", &["hull", "keel"])];
pub const FIELDS: [&str; 3] = ["one", "two", "three"];

pub fn id(text: &str) -> DocumentId {
    text.parse().expect("an id")
}

/// Returns a policy that lets so many values out per hour.
pub fn hourly(values: u32) -> String {
    json!({ "rateLimits": [{ "values": values, "periodMs": 3_600_000 }] }).to_string()
}

pub fn variable(number: u32) -> VariableKey {
    let json = json!({ "sourceId": "s", "nodeId": format!("nsu=urn:x;i={number}") });
    serde_json::from_value(json).expect("a variable")
}

/// State with time that goes on with every decision.
pub struct Plant {
    pub scene: Scene,
    ms: i64,
}

impl Default for Plant {
    fn default() -> Self {
        let mut scene = Scene::empty();
        scene.arrive(network());
        Self { scene, ms: 0 }
    }
}

fn network() -> OperationNetworkMessage {
    let fields = FIELDS.map(|name| json!({ "name": name, "type": 9 }));
    let requests = REQUESTS.map(|(request, recipients)| {
        json!({ "dynamicDataRequestId": request, "requesterId": recipients[0],
            "recipientList": recipients, "purpose": "Plan", "updateFrequency": 1,
            "updateFrequencyUnit": "HOUR",
            "reportDataFormat": { "reportName": "R", "reportFieldList": fields } })
    });
    serde_json::from_value(json!({ "messageId": "m", "factoryId": "F", "collaborationId": "c",
        "revision": 1, "operationNetwork": { "operationNetworkId": "n", "operationList": [
            { "operationId": "op", "operationType": "PRODUCTION",
              "dynamicDataRequestList": requests } ] } }))
    .expect("a network")
}

impl Plant {
    /// Returns the key of a field, named by its request.
    pub fn key(&self, name: &str) -> FieldKey {
        let (request, field) = name.split_once('/').expect("a request and a field");
        let request = RequestKey {
            operation_network_id: "n".parse().expect("an id"),
            operation_id: "op".parse().expect("an id"),
            dynamic_data_request_id: request.parse().expect("an id"),
        };
        request.field(field.parse().expect("a name"))
    }

    pub fn mapping_state(&self, name: &str) -> MappingState {
        self.scene.state.field(&self.key(name)).expect("a field").decision().mapping_state
    }

    pub fn now(&mut self) -> DateTime {
        self.ms += 1;
        at(self.ms)
    }

    /// Lets time pass, in milliseconds.
    pub fn wait(&mut self, ms: i64) -> i64 {
        self.ms += ms;
        self.ms
    }

    /// Opens a field for operators, or for a mapping of the variable 9.
    pub fn open(
        &mut self,
        name: &str,
        policy: &str,
        named: Option<&str>,
    ) -> Result<(), DecisionError> {
        self.decide(name, policy, named, 9)
    }

    /// Opens a field for a mapping of a variable.
    pub fn map(&mut self, name: &str, variable: u32, policy: &str) -> Result<(), DecisionError> {
        self.decide(name, policy, None, variable)
    }

    pub fn decide(
        &mut self,
        name: &str,
        policy: &str,
        named: Option<&str>,
        variable: u32,
    ) -> Result<(), DecisionError> {
        let policy: DisclosurePolicy = serde_json::from_str(policy).expect("a policy");
        let mapping = Some(Box::new(self.mapping(name, variable)));
        let value_source = ValueSource::Mapping;
        let command = DecisionCommand::Map { value_source, mapping, policy };
        self.command(name, command, named)
    }

    pub fn command(
        &mut self,
        name: &str,
        command: DecisionCommand,
        named: Option<&str>,
    ) -> Result<(), DecisionError> {
        let (key, now) = (self.key(name), self.now());
        let basis = DecisionBasis { policy_id: named.map(id), ..DecisionBasis::default() };
        let request = DecisionRequest { command, reason: None, decided_by: "eve".into(), basis };
        self.scene.attempt(|state| Ok(((), decide(state, &key, request, now)?)))
    }

    fn mapping(&self, name: &str, number: u32) -> Mapping {
        let mapping = json!({ "mappingId": "x", "target": self.key(name), "targetType": "UInt64",
            "inputs": [{ "name": "a", "sourceId": "s",
            "nodeId": format!("nsu=urn:x;i={number}") }], "steps": [] });
        let mapping = serde_json::from_value(mapping).expect("a mapping");
        validate_for_field(&self.scene.state, mapping).expect("it fits")
    }

    pub fn import(&mut self, name: &str, variable: u32) -> Result<(), Vec<CapExcess>> {
        let now = self.now();
        let mapping = self.mapping(name, variable);
        let import = MappingImport { mapping, author: "eve".to_owned(), note: None };
        self.scene.attempt(|state| Ok(((), import_mappings(state, vec![import], now)?)))
    }

    pub fn policy(&mut self, name: &str, disclosure: &str) -> Result<u32, DocumentError> {
        let now = self.now();
        let disclosure = serde_json::from_str(disclosure).expect("a policy");
        let policy = NamedPolicy { name: "n".to_owned(), disclosure, is_retired: false };
        let version =
            self.scene.attempt(|state| put_policy(state, &id(name), policy, None, "eve", now))?;
        Ok(version.version)
    }

    pub fn set_policy(
        &mut self,
        recipient: &str,
        policy: Option<&str>,
    ) -> Result<u32, DocumentError> {
        let now = self.now();
        let recipient: OrganisationId = recipient.parse().expect("an id");
        self.scene.attempt(|state| {
            set_recipient_policy(state, &recipient, policy.map(id), None, "eve", now)
        })
    }

    pub fn alliance(
        &mut self,
        name: &str,
        members: &[&str],
        is_retired: bool,
    ) -> Result<(), DocumentError> {
        let now = self.now();
        let alliance = json!({ "name": name, "memberList": members, "isRetired": is_retired });
        let alliance: Alliance = serde_json::from_value(alliance).expect("an alliance");
        let stored =
            self.scene.attempt(|state| put_alliance(state, &id(name), alliance, None, "eve", now));
        stored.map(|_| ())
    }

    pub fn draft(&self, subject: Value, most: f64, variable: Option<VariableKey>) -> Cap {
        let mut cap = json!({ "name": "c", "subject": subject, "bitsPerHourMax": most });
        if let Some(variable) = variable {
            cap["variable"] = json!(variable);
        }
        serde_json::from_value(cap).expect("a cap")
    }

    /// Sets a cap, and returns the fields that it holds back.
    pub fn cap(
        &mut self,
        name: &str,
        subject: Value,
        most: f64,
        variable: Option<VariableKey>,
    ) -> Result<Vec<FieldKey>, DocumentError> {
        let (cap, now) = (self.draft(subject, most, variable), self.now());
        let stored =
            self.scene.attempt(|state| put_cap(state, &id(name), cap, None, "eve", now))?;
        Ok(stored.1)
    }

    /// Returns what a store would have of the state.
    pub fn snapshot(&self) -> Snapshot {
        let state = &self.scene.state;
        let message = network();
        let writers = state
            .writers()
            .active()
            .filter_map(|id| state.writers().get(id).map(|writer| (id, writer.row())));
        Snapshot {
            networks: vec![StoredNetwork {
                operation_network_id: message.operation_network.operation_network_id.clone(),
                revision: 1,
                message: Some(message),
                received_at: at(0),
            }],
            fields: state.fields().iter().map(|field| (field.row(), None)).collect(),
            writers: writers.collect(),
            policies: StoredPolicies {
                named: state.policies().named().cloned().collect(),
                ..StoredPolicies::default()
            },
            budgets: StoredBudgets {
                alliances: state.budgets().alliances().cloned().collect(),
                caps: state.budgets().caps().cloned().collect(),
            },
            ..Snapshot::default()
        }
    }
}
