//! Gates of fields under policies that are not in force, and refusals of values.

use std::sync::Arc;

use asi_model::{DateTime, FieldKey, FieldName, StatusCode, messages::ValueSource};
use disclosure::{DisclosurePolicy, DraftGate, PolicyFault, WithholdCondition};

use crate::{ConnectorState, fields::is_withheld_by};

/// Makes a gate to try a policy on a field. It knows the present states that the policy looks at.
#[must_use]
pub fn draft_gate(
    state: &ConnectorState,
    key: &FieldKey,
    policy: Arc<DisclosurePolicy>,
    now: DateTime,
) -> Option<DraftGate> {
    let field = state.field(key)?;
    let field_type = field.definition().field_type.0;
    let mut gate = DraftGate::new(Arc::clone(&policy), field_type, now);
    for other in fields_named_by(&policy) {
        let watched = state.field(&key.request.field(other.clone()));
        let is_withheld = watched.and_then(|field| is_withheld_by(field, other, &policy));
        gate.on_state(now, other, is_withheld);
    }
    Some(gate)
}

/// Returns faults of the states that a policy looks at: they must be fields of the same request, with
/// values that can be in one of the states.
#[must_use]
pub fn withholding_faults(
    state: &ConnectorState,
    key: &FieldKey,
    policy: &DisclosurePolicy,
) -> Vec<PolicyFault> {
    let fault = |condition: &WithholdCondition| {
        let other = condition.field.as_ref()?;
        let watched = state.fields.get(&key.request.field(other.clone()));
        let message = match watched.map(|field| field.definition().field_type.0) {
            None => format!(
                "the request has no field {other}; name one of its fields, or none for the own \
                 value"
            ),
            Some(field_type) if !condition.fits(field_type) => {
                format!("none of these states is one of a {field_type}, as the field {other} is")
            }
            Some(_) => return None,
        };
        Some(PolicyFault { member: "withholdWhile", message })
    };
    policy.withhold_while.iter().filter_map(fault).collect()
}

/// Returns the status with which a value of this source is refused; `None` where it is accepted.
#[must_use]
pub fn write_refusal(
    state: &ConnectorState,
    key: &FieldKey,
    source: ValueSource,
    now: DateTime,
) -> Option<StatusCode> {
    match state.field(key) {
        None => Some(StatusCode::BAD_NODE_ID_UNKNOWN),
        Some(field) if !field.validity().contains(now) => Some(StatusCode::BAD_INVALID_STATE),
        Some(field) if field.decision().is_open_for(source) => None,
        Some(_) => Some(StatusCode::BAD_NOT_WRITABLE),
    }
}

/// Returns the names of other fields whose states a policy looks at.
pub(crate) fn fields_named_by(policy: &DisclosurePolicy) -> impl Iterator<Item = &FieldName> {
    policy.withhold_while.iter().filter_map(|condition| condition.field.as_ref())
}
