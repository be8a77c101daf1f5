//! Offers of standing rules: the decision that rules would take about a field.

use std::sync::Arc;

use asi_model::{DateTime, FieldKey, messages::ValueSource};
use disclosure::{
    DisclosurePolicy, DocumentId, DocumentVersion, Rule, RuleAction, RuleOutcome, outcome,
};
use mapping::Mapping;

use super::{alike::Acceptance, effective_policy, variables_of, withholding_faults};
use crate::{ConnectorState, Field, operator::OperationKey};

/// The decision that standing rules offer for a field.
#[derive(Debug, Clone, PartialEq)]
pub struct RuleOffer {
    /// The action; `ACCEPT` becomes `PREFILL` without a known source of values, and beside a field
    /// alike.
    pub action: RuleAction,
    /// The rules with their names; the first one gives reason and source.
    pub rules: Vec<(DocumentVersion, String)>,
    pub disclosure: Arc<DisclosurePolicy>,
    /// The named policy of the rules, where they agree on one: when it becomes stricter, so does
    /// what was accepted. When it becomes less strict, an engineer has to decide again, for the
    /// consent was for the precision of then.
    pub policy_id: Option<DocumentId>,
    pub value_source: Option<ValueSource>,
    /// The mapping, with the source `MAPPING`.
    pub mapping: Option<Mapping>,
    /// Reason of a refusal, for the partner.
    pub reason: Option<String>,
    /// True where `ACCEPT` became `PREFILL` since a field alike is or was open: the recipients would
    /// get more values than the policy allows.
    pub is_second_gate: bool,
}

impl RuleOffer {
    /// Returns true where the rules decide without an engineer.
    #[must_use]
    pub fn decides(&self) -> bool {
        self.action != RuleAction::Prefill
    }
}

/// Returns the offer of the enabled rules for a field, whatever was decided about it.
#[must_use]
pub fn rule_offer(state: &ConnectorState, key: &FieldKey, now: DateTime) -> Option<RuleOffer> {
    let rules = state.policies.enabled_rules().map(|rule| (&rule.key, &rule.document));
    offer_of(state, state.field(key)?, rules, now)
}

/// Returns the offers of one rule, enabled or not, sorted by field.
#[must_use]
pub fn rule_preview(
    state: &ConnectorState,
    rule: &Rule,
    now: DateTime,
) -> Vec<(FieldKey, RuleOffer)> {
    let draft = DocumentVersion { id: "draft".parse().expect("an id"), version: 0 };
    let offer = |field: &Field| {
        let offer = offer_of(state, field, std::iter::once((&draft, rule)), now)?;
        Some((field.key().clone(), offer))
    };
    let mut offers: Vec<(FieldKey, RuleOffer)> = state.fields.iter().filter_map(offer).collect();
    offers.sort_by(|left, right| left.0.cmp(&right.0));
    offers
}

fn offer_of<'r>(
    state: &ConnectorState,
    field: &Field,
    rules: impl Iterator<Item = (&'r DocumentVersion, &'r Rule)>,
    now: DateTime,
) -> Option<RuleOffer> {
    let (_, request) = state.request(&field.key().request)?;
    let named = |id: &DocumentId| {
        state.policies.applicable(id).map(|policy| policy.document.disclosure.clone())
    };
    let found: RuleOutcome<'_, DocumentVersion> =
        outcome(rules, named, request, field.definition())?;
    let (_, first) = found.rules.first()?;
    let value_source = first.value_source.filter(|_| found.action != RuleAction::Refuse);
    let mapping =
        (value_source == Some(ValueSource::Mapping)).then(|| known_mapping(state, field)).flatten();
    let is_sourceless = value_source == Some(ValueSource::Mapping) && mapping.is_none();
    let mut named = found.rules.iter().filter_map(|(_, rule)| rule.policy_id.as_ref());
    let policy_id = named
        .next()
        .filter(|first| found.action != RuleAction::Refuse && named.all(|next| next == *first));
    let (policy, _) = effective_policy(state, field, &found.disclosure, policy_id);
    let variables = mapping.as_ref().map(|mapping| variables_of(&mapping.inputs));
    let variables = variables.unwrap_or_default();
    let acceptance = Acceptance { state, field, policy: &policy, variables, now };
    let is_second_gate = found.action == RuleAction::Accept && acceptance.is_second_gate();
    let action = match found.action {
        RuleAction::Accept
            if is_sourceless || is_second_gate || !can_hold(state, field, &found.disclosure) =>
        {
            RuleAction::Prefill
        }
        action => action,
    };
    let rules = found.rules.iter().map(|(key, rule)| ((*key).clone(), rule.name.clone()));
    Some(RuleOffer {
        action,
        policy_id: policy_id.cloned(),
        rules: rules.collect(),
        value_source,
        mapping,
        reason: first.reason.clone().filter(|_| action == RuleAction::Refuse),
        disclosure: found.disclosure,
        is_second_gate,
    })
}

/// Returns true where a policy makes sense for a field.
fn can_hold(state: &ConnectorState, field: &Field, policy: &DisclosurePolicy) -> bool {
    policy.faults(field.definition().field_type.0, field.is_array()).is_empty()
        && withholding_faults(state, field.key(), policy).is_empty()
}

/// Returns the mapping that a field had, or that of an equal field of the same operation.
fn known_mapping(state: &ConnectorState, field: &Field) -> Option<Mapping> {
    let definition = field.definition();
    let is_alike = |mapping: &Mapping| {
        mapping.target_type.0 == definition.field_type.0
            && mapping.target_unit == definition.unit
            && mapping.target_value_rank == definition.value_rank
    };
    let own = field.decision().mapping.as_deref().filter(|mapping| is_alike(mapping));
    let equal = || {
        let operation = state.operation(&OperationKey::of(field.key()))?;
        operation.dynamic_data_request_list.iter().find_map(|request| {
            let mut other = field.key().clone();
            other.request.dynamic_data_request_id = request.dynamic_data_request_id.clone();
            let other = state.field(&other)?;
            let is_equal = other.definition().semantic == definition.semantic
                && other.decision().is_open_for(ValueSource::Mapping);
            other.decision().mapping.as_deref().filter(|mapping| is_equal && is_alike(mapping))
        })
    };
    let mut mapping = own.or_else(equal)?.clone();
    mapping.mapping_id = field.mapping_id();
    mapping.target = field.key().clone();
    Some(mapping)
}
