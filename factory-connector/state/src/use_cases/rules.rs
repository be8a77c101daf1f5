//! Standing rules: stored, applied to undecided fields, and their decisions undone.

use asi_model::{DateTime, FieldKey, OperationNetworkId};
use disclosure::{DecisionBasis, DocumentId, DocumentVersion, Rule, RuleAction, RuleFault};

use super::decide::{Course, DecisionCommand, DecisionError, DecisionRequest, decide_in};
use crate::{
    ChangeSet, ConnectorState, DocumentError, Field, LogRecord, effects::ConnectorEvent,
    queries::rule_offer, writes::RuleDecisionRow,
};

/// Name under which rules decide.
const DECIDED_BY: &str = "standing rule";
/// Reason for the log where a rule leaves a field to the engineer.
const SECOND_GATE: &str = "a field alike is open to its recipients, or was a short while ago";
/// Reason that a partner reads when a decision of a rule was undone.
const UNDONE: &str = "A decision of a standing rule was taken back.";

/// Stores a new version of a rule. It applies to new fields; [`apply_rules`] applies it to present
/// ones.
///
/// # Errors
/// [`DocumentError`].
pub fn put_rule(
    state: &mut ConnectorState,
    id: &DocumentId,
    rule: Rule,
    expected: Option<u32>,
    by: &str,
    now: DateTime,
) -> Result<(DocumentVersion, ChangeSet), DocumentError> {
    let mut faults = rule.faults();
    let named = rule.policy_id.as_ref();
    if let Some(policy_id) = named.filter(|id| state.policies.applicable(id).is_none()) {
        let message = format!("There is no policy {policy_id} that could be applied.");
        faults.push(RuleFault { pointer: "/policyId".to_owned(), message });
    }
    if !faults.is_empty() {
        return Err(DocumentError::Faults(faults));
    }
    let row = state.policies.put_rule(id, rule, expected, (by, now))?;
    let mut changes = ChangeSet::default();
    let version = row.key.clone();
    changes.writes.policies.rules.push(row);
    changes.effects.events.push(ConnectorEvent::Policies);
    Ok((version, changes))
}

/// Applies the enabled rules to the undecided fields of a network, or of all networks, and returns
/// the number of decisions.
pub fn apply_rules(
    state: &mut ConnectorState,
    network: Option<&OperationNetworkId>,
    now: DateTime,
) -> (usize, ChangeSet) {
    let mut changes = ChangeSet::default();
    let count = apply_rules_in(state, &mut changes, network, now);
    (count, changes)
}

/// Applies the enabled rules within a larger use case.
pub(super) fn apply_rules_in(
    state: &mut ConnectorState,
    changes: &mut ChangeSet,
    network: Option<&OperationNetworkId>,
    now: DateTime,
) -> usize {
    if state.policies.enabled_rules().next().is_none() {
        return 0;
    }
    // A field that an engineer left open stays with the engineer.
    let undecided = |field: &&Field| field.is_undecided();
    let mut keys: Vec<FieldKey> = match network {
        None => state.fields.iter().filter(undecided).map(|field| field.key().clone()).collect(),
        Some(network) => {
            let message = state.networks.get(network).and_then(|known| known.message.as_ref());
            let requested = message.iter().flat_map(|message| message.operation_network.fields());
            let fields = requested.filter_map(|(key, ..)| state.fields.get(&key));
            fields.filter(undecided).map(|field| field.key().clone()).collect()
        }
    };
    keys.sort();
    let mut course = Course::new(state, now);
    keys.into_iter().filter(|key| apply_offer(state, changes, key, &mut course, now)).count()
}

fn apply_offer(
    state: &mut ConnectorState,
    changes: &mut ChangeSet,
    key: &FieldKey,
    course: &mut Course,
    now: DateTime,
) -> bool {
    let Some(offer) = rule_offer(state, key, now) else { return false };
    if offer.is_second_gate {
        let (field, reason) = (key.clone(), SECOND_GATE.to_owned());
        changes.effects.log.push(LogRecord::RuleNotApplied { field, reason });
        return false;
    }
    let rules: Vec<DocumentVersion> = offer.rules.into_iter().map(|(rule, _)| rule).collect();
    let command = match (offer.action, offer.value_source) {
        (RuleAction::Refuse, _) => DecisionCommand::Refuse,
        (RuleAction::Accept, Some(value_source)) => DecisionCommand::Map {
            value_source,
            mapping: offer.mapping.map(Box::new),
            policy: (*offer.disclosure).clone(),
        },
        _ => return false,
    };
    let request = DecisionRequest {
        command,
        reason: offer.reason,
        decided_by: DECIDED_BY.to_owned(),
        basis: DecisionBasis {
            policy_id: offer.policy_id,
            rules: rules.clone(),
            ..DecisionBasis::default()
        },
        preview: None,
    };
    if let Err(error) = decide_in(state, changes, key, request, course, now) {
        let reason = error.to_string();
        changes.effects.log.push(LogRecord::RuleNotApplied { field: key.clone(), reason });
        return false;
    }
    changes.effects.decisions.rule_count += 1;
    changes.writes.policies.rule_decisions.push(RuleDecisionRow {
        id: state.policies.next_rule_decision(),
        field: key.clone(),
        action: offer.action,
        rules,
        consent_version: state.field(key).map_or(0, |field| field.decision().version),
        decided_at: now,
    });
    true
}

/// Undoes a decision of a rule, as long as no other decision was taken since. The field waits for
/// an engineer from then on.
///
/// # Errors
/// [`DecisionError`].
pub fn undo_rule_decision(
    state: &mut ConnectorState,
    id: i64,
    key: &FieldKey,
    consent_version: u32,
    by: &str,
    now: DateTime,
) -> Result<ChangeSet, DecisionError> {
    let field = state.field(key).ok_or(DecisionError::UnknownField)?;
    if field.decision().version != consent_version || field.decision().basis.rules.is_empty() {
        return Err(DecisionError::DecidedSince);
    }
    let mut changes = ChangeSet::default();
    let request = DecisionRequest {
        command: DecisionCommand::LeavePending,
        reason: Some(UNDONE.to_owned()),
        decided_by: by.to_owned(),
        basis: DecisionBasis::default(),
        preview: None,
    };
    decide_in(state, &mut changes, key, request, &mut Course::of_ending(), now)?;
    changes.writes.policies.undone_rule_decisions.push((id, by.to_owned(), now));
    Ok(changes)
}
