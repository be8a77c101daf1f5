//! One requested report field: its definition, the decision about it, and its gate.

use std::sync::Arc;

use asi_model::{
    DataValue, DateTime, FieldKey,
    messages::{DisclosureStatement, MappingState, ValueSource},
    network::ReportField,
};
use disclosure::{
    DecisionBasis, DisclosurePolicy, DocumentId, Gate, GateState, disclosure_statement,
    gate_to_json,
};
use mapping::{Mapping, MappingId, PublishRequest, TargetKey, TransformState};

use super::{DisclosureRate, MappingVersions, Validity};
use crate::{
    effects::EngineCommand,
    writes::{FieldRow, FieldValueRow},
};

/// A report field that a partner requested.
#[derive(Debug)]
pub struct Field {
    key: FieldKey,
    id: i64,
    pub(super) definition: ReportField,
    pub(super) decision: FieldDecision,
    /// Changed by [`FieldRegistry::through_gate`](super::FieldRegistry::through_gate), which reports
    /// what it releases, and closed where a consent ends or begins.
    pub(super) gate: Gate,
    pub(super) rate: DisclosureRate,
    pub(super) validity: Validity,
    pub(super) newest: Option<DataValue>,
    /// The candidate that is offered once the request begins.
    pub(super) kept: Option<DataValue>,
    pub(super) transform: Option<TransformState>,
    pub(super) versions: MappingVersions,
    writer: u16,
}

/// Stored parts of a field beside its key and definition.
pub(crate) struct StoredField {
    pub(crate) decision: FieldDecision,
    pub(crate) versions: MappingVersions,
    /// The policy in force.
    pub(crate) policy: Arc<DisclosurePolicy>,
    pub(crate) gate: GateState,
    pub(crate) transform: Option<TransformState>,
}

/// The decision about a field.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FieldDecision {
    /// Pending, mapped or refused.
    pub mapping_state: MappingState,
    /// Source of the values; present exactly while mapped.
    pub value_source: Option<ValueSource>,
    /// The reason as the partner reads it.
    pub reason: Option<String>,
    /// Name of the user, or of the standing rules.
    pub decided_by: Option<String>,
    /// Time of the decision, by a clock that never goes back.
    pub decided_at: Option<DateTime>,
    /// The mapping in force, or the one to suggest again.
    pub mapping: Option<Arc<Mapping>>,
    /// The coarsening that was consented to. The gate's policy may be stricter.
    pub policy: Arc<DisclosurePolicy>,
    /// Named policies and rules that the decision rests on.
    pub basis: DecisionBasis,
    /// Number of the consent, counted per field.
    pub version: u32,
}

impl FieldDecision {
    /// Returns true while values flow.
    #[must_use]
    pub fn is_mapped(&self) -> bool {
        self.mapping_state == MappingState::Mapped
    }

    /// Returns the named policy that applies to the field by this decision, while it is mapped.
    #[must_use]
    pub fn named_policy(&self) -> Option<&DocumentId> {
        self.basis.policy_id.as_ref().filter(|_| self.is_mapped())
    }

    /// Returns true while values flow from this source.
    #[must_use]
    pub fn is_open_for(&self, source: ValueSource) -> bool {
        self.is_mapped() && self.value_source == Some(source)
    }

    /// Takes the decision back: the field is pending again, with this reason, decided by nobody.
    pub(crate) fn reopen(&mut self, reason: &str, now: DateTime) {
        self.mapping_state = MappingState::Pending;
        self.value_source = None;
        self.basis = DecisionBasis::default();
        self.reason = Some(reason.to_owned());
        self.decided_by = None;
        self.follow(now);
    }

    /// Numbers and dates the decision that was just taken. None is dated before the one that it follows, also by a
    /// clock that was set back: the platform goes by the latest date.
    pub(crate) fn follow(&mut self, now: DateTime) {
        self.decided_at = self.decided_at.max(Some(now));
        self.version += 1;
    }
}

impl Field {
    /// Makes an undecided field of a request.
    pub(crate) fn new(
        (id, key): (i64, FieldKey),
        definition: ReportField,
        validity: Validity,
        writer: u16,
        now: DateTime,
    ) -> Self {
        let decision = FieldDecision::default();
        let (policy, field_type) = (Arc::clone(&decision.policy), definition.field_type.0);
        Self {
            key,
            id,
            gate: Gate::new(policy, field_type, GateState::default(), now),
            definition,
            decision,
            rate: DisclosureRate::new(now),
            validity,
            newest: None,
            kept: None,
            transform: None,
            versions: MappingVersions::default(),
            writer,
        }
    }

    /// Takes over what was stored about the field.
    pub(crate) fn with_stored(self, stored: StoredField, now: DateTime) -> Self {
        let StoredField { decision, versions, policy, gate, transform } = stored;
        let gate = Gate::new(policy, self.definition.field_type.0, gate, now);
        Self { decision, versions, gate, transform, ..self }
    }

    /// Returns the field's key.
    #[must_use]
    pub const fn key(&self) -> &FieldKey {
        &self.key
    }

    /// Returns the candidate that is kept until the request begins.
    pub(crate) const fn kept(&self) -> Option<&DataValue> {
        self.kept.as_ref()
    }

    /// Returns the number within this store; candidates, mappings and store rows refer to it.
    #[must_use]
    pub const fn id(&self) -> i64 {
        self.id
    }

    /// Returns the field as its request states it.
    #[must_use]
    pub const fn definition(&self) -> &ReportField {
        &self.definition
    }

    /// Returns the decision in force.
    #[must_use]
    pub const fn decision(&self) -> &FieldDecision {
        &self.decision
    }

    /// Returns the gate, which lets values out as the policy in force says.
    #[must_use]
    pub const fn gate(&self) -> &Gate {
        &self.gate
    }

    /// Returns candidates and released values per hour.
    #[must_use]
    pub const fn rate(&self) -> &DisclosureRate {
        &self.rate
    }

    /// Returns the time span in which the request asks for values.
    #[must_use]
    pub const fn validity(&self) -> Validity {
        self.validity
    }

    /// Returns the newest candidate, before the gate; lost at a restart.
    #[must_use]
    pub const fn newest(&self) -> Option<&DataValue> {
        self.newest.as_ref()
    }

    /// Returns the state of the mapping's functions.
    #[must_use]
    pub const fn transform(&self) -> Option<&TransformState> {
        self.transform.as_ref()
    }

    /// Returns the versions of the mapping, and its shadow mapping.
    #[must_use]
    pub const fn versions(&self) -> &MappingVersions {
        &self.versions
    }

    /// Returns the DataSetWriterId of the field's request.
    #[must_use]
    pub const fn writer(&self) -> u16 {
        self.writer
    }

    /// Returns the mapping's id in the engine.
    #[must_use]
    pub fn mapping_id(&self) -> MappingId {
        MappingId::new(format!("field-{}", self.id)).expect("short and without control characters")
    }

    /// Returns the key that candidates of the mapping in force bring.
    #[must_use]
    pub const fn target_key(&self) -> TargetKey {
        TargetKey { field: self.id, version: self.versions.of_decision() }
    }

    /// Returns the shadow mapping's id in the engine.
    #[must_use]
    pub fn shadow_id(&self) -> MappingId {
        MappingId::new(format!("field-{}.shadow", self.id))
            .expect("short and without control characters")
    }

    /// Returns true until a rule or an engineer decides, also after a revision reopened the field.
    #[must_use]
    pub fn is_undecided(&self) -> bool {
        self.decision.mapping_state == MappingState::Pending && self.decision.decided_by.is_none()
    }

    /// Returns true for a field with array values.
    #[must_use]
    pub const fn is_array(&self) -> bool {
        self.definition.value_rank >= 0
    }

    /// States the precision for the partner, while the field is mapped.
    #[must_use]
    pub fn statement(&self) -> Option<DisclosureStatement> {
        let unit = self.definition.unit.as_deref();
        self.decision.is_mapped().then(|| disclosure_statement(self.gate.policy(), unit))
    }

    /// Returns the state with which another mapping would continue.
    #[must_use]
    pub fn state_for(&self, mapping: &Mapping) -> Option<TransformState> {
        let before = self.decision.mapping.as_ref()?;
        Some(self.transform.as_ref()?.carried_over(&before.steps, &mapping.steps))
    }

    /// Returns the field with its decision as stored.
    #[must_use]
    pub fn row(&self) -> FieldRow {
        let decision = &self.decision;
        FieldRow {
            id: self.id,
            key: self.key.clone(),
            mapping_state: decision.mapping_state,
            value_source: decision.value_source,
            reason: decision.reason.clone(),
            decided_by: decision.decided_by.clone(),
            decided_at: decision.decided_at,
            mapping: decision.mapping.as_deref().map(mapping_json),
            policy: policy_json(&decision.policy),
            basis: basis_json(&decision.basis),
            consent_version: decision.version,
        }
    }

    /// Returns the states of gate and transform as stored.
    #[must_use]
    pub fn value_row(&self) -> FieldValueRow {
        FieldValueRow {
            gate: gate_to_json(&self.gate.state()),
            transform: self.transform.as_ref().map(|state| {
                serde_json::to_string(state)
                    .expect("transform states have text keys and finite numbers")
            }),
        }
    }

    /// Publishes the mapping in force, with the state that its functions had.
    pub(crate) fn publish_mapping(&self) -> Option<EngineCommand> {
        let mapping = Arc::clone(self.decision.mapping.as_ref()?);
        let request = PublishRequest::new(mapping, self.target_key());
        Some(EngineCommand::Put(PublishRequest { state: self.transform.clone(), ..request }))
    }

    /// Publishes or removes the shadow mapping. It starts with the published mapping's state, so
    /// that the results of both can be compared.
    pub(crate) fn publish_shadow(&self) -> EngineCommand {
        match &self.versions.shadow {
            Some(shadow) => EngineCommand::Put(PublishRequest {
                state: self.state_for(&shadow.mapping),
                is_shadow: true,
                ..PublishRequest::new(shadow.mapping.clone(), self.target_key())
            }),
            None => EngineCommand::Remove(self.shadow_id()),
        }
    }
}

pub(crate) fn mapping_json(mapping: &Mapping) -> String {
    serde_json::to_string(mapping).expect("mappings have text keys and finite numbers")
}

pub(crate) fn policy_json(policy: &DisclosurePolicy) -> String {
    serde_json::to_string(policy).expect("policies have text keys and finite numbers")
}

/// Serialises a decision's basis; `None` where it is empty.
pub(crate) fn basis_json(basis: &DecisionBasis) -> Option<String> {
    (!basis.is_empty())
        .then(|| serde_json::to_string(basis).expect("bases have text keys and whole numbers"))
}
