//! A plant with requests of several partners.

use std::collections::BTreeMap;

use asi_model::{
    DateTime, FieldKey, OrganisationId, RequestKey,
    messages::{MappingState, ValueSource},
};
use disclosure::{
    Alliance, Cap, CapExcess, DecisionBasis, DisclosurePolicy, DocumentId, NamedPolicy, VariableKey,
};
use mapping::Mapping;
use serde_json::{Value, json};

use super::requests::{PARTNERS, Requests, Revision};
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
        rules::put_rule,
    },
};

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
    pub requests: Requests,
    ms: i64,
}

impl Default for Plant {
    fn default() -> Self {
        Self::of(Requests::of_partners())
    }
}

impl Plant {
    pub fn of(requests: Requests) -> Self {
        let mut scene = Scene::empty();
        scene.arrive(requests.message());
        Self { scene, requests, ms: 0 }
    }

    /// Receives the next revision.
    pub fn revise(&mut self, revision: &Revision) {
        let message = self.requests.revise(revision);
        self.ms += 1;
        self.scene.arrive_at(message, self.ms);
    }

    /// Stores a rule that accepts all fields of all partners from operators, with this policy.
    pub fn rule(&mut self, policy: &str) -> Result<(), DocumentError> {
        self.rule_of("MANUAL", policy)
    }

    /// Stores a rule that accepts all fields of all partners from a source, with this policy.
    pub fn rule_of(&mut self, source: &str, policy: &str) -> Result<(), DocumentError> {
        let now = self.now();
        let policy: Value = serde_json::from_str(policy).expect("a policy");
        let rule = json!({ "name": "n", "isEnabled": true, "action": "ACCEPT",
            "when": { "partners": PARTNERS }, "valueSource": source, "disclosure": policy });
        let rule = serde_json::from_value(rule).expect("a rule");
        let stored = self.scene.attempt(|state| put_rule(state, &id("r"), rule, None, "eve", now));
        stored.map(|_| ())
    }

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

    /// Returns the most bits per hour of a field that is disclosed.
    pub fn bits_per_hour(&self, name: &str) -> f64 {
        let field = self.scene.state.field(&self.key(name)).expect("a field");
        let bits = disclosure::bits_per_hour(field.definition(), field.gate().policy());
        bits.expect("bounded")
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
        let request = DecisionRequest {
            command,
            reason: None,
            decided_by: "eve".into(),
            basis,
            preview: None,
        };
        self.scene.attempt(|state| Ok(((), decide(state, &key, request, now)?)))
    }

    fn mapping(&self, name: &str, number: u32) -> Mapping {
        let field = self.scene.state.field(&self.key(name)).expect("a field");
        let target_type = field.definition().field_type.0.name();
        let mapping = json!({ "mappingId": "x", "target": self.key(name), "targetType": target_type,
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
        let message = self.requests.message();
        let former = &self.scene.pending.writes.fields.former;
        let former: BTreeMap<i64, _> = former.iter().map(|row| (row.id, row.clone())).collect();
        let writers = state
            .writers()
            .active()
            .filter_map(|id| state.writers().get(id).map(|writer| (id, writer.row())));
        Snapshot {
            networks: vec![StoredNetwork {
                operation_network_id: message.operation_network.operation_network_id.clone(),
                revision: message.revision,
                message: Some(message),
                received_at: at(0),
            }],
            fields: state.fields().iter().map(|field| (field.row(), None)).collect(),
            writers: writers.collect(),
            policies: StoredPolicies {
                named: state.policies().named().cloned().collect(),
                rules: state.policies().rules().cloned().collect(),
                ..StoredPolicies::default()
            },
            budgets: StoredBudgets {
                alliances: state.budgets().alliances().cloned().collect(),
                caps: state.budgets().caps().cloned().collect(),
            },
            former_disclosures: former.into_values().collect(),
            ..Snapshot::default()
        }
    }
}
