//! Sums under the caps, as they are and as they would be.

use std::{
    collections::{BTreeMap, BTreeSet},
    sync::Arc,
};

use asi_model::{DateTime, FieldKey, RequestKey, messages::ValueSource};
use disclosure::{
    Cap, CapExcess, CapUsage, DisclosurePolicy, DocumentId, DocumentVersion, Exchange, FieldUse,
    VariableKey, bits_per_hour,
};
use mapping::{Mapping, MappingInput};

use super::fields_named_by;
use crate::{BudgetRegistry, ConnectorState, DocumentError, Field};

/// A field as it would be.
#[derive(Debug, Clone, Default)]
pub(crate) struct Supposed {
    /// The policy that would be in force; the present one without it.
    pub(crate) policy: Option<Arc<DisclosurePolicy>>,
    /// The inputs of its mapping; the present ones without them.
    pub(crate) variables: Option<BTreeSet<VariableKey>>,
}

/// Fields as they would be.
pub(crate) type Suppositions = BTreeMap<FieldKey, Supposed>;

/// A field that a cap holds back, with the caps that it would exceed.
pub type HeldBack = (FieldKey, Vec<CapExcess>);

/// Returns the variables that a mapping reads.
#[must_use]
pub fn variables_of(inputs: &[MappingInput]) -> BTreeSet<VariableKey> {
    let key = |input: &MappingInput| VariableKey {
        source_id: input.source_id.clone(),
        node_id: input.node_id.clone(),
    };
    inputs.iter().map(key).collect()
}

/// Returns the variables that a field rests on under a policy: those of its mapping, and those of
/// the fields whose states withhold it.
pub(crate) fn variables_under(
    state: &ConnectorState,
    field: &Field,
    policy: &DisclosurePolicy,
    suppositions: &Suppositions,
) -> BTreeSet<VariableKey> {
    let mut variables = inputs(state, field.key(), suppositions);
    for name in fields_named_by(policy) {
        let other = field.key().request.field(name.clone());
        variables.append(&mut inputs(state, &other, suppositions));
    }
    variables
}

fn inputs(
    state: &ConnectorState,
    key: &FieldKey,
    suppositions: &Suppositions,
) -> BTreeSet<VariableKey> {
    if let Some(supposed) = suppositions.get(key).and_then(|supposed| supposed.variables.clone()) {
        return supposed;
    }
    let decision = state.field(key).map(Field::decision);
    let mapped = decision.filter(|decision| decision.is_open_for(ValueSource::Mapping));
    let mapping = mapped.and_then(|decision| decision.mapping.as_deref());
    mapping.map(|mapping| variables_of(&mapping.inputs)).unwrap_or_default()
}

/// Returns the information of a field; `None` while it is not disclosed.
fn field_use(
    state: &ConnectorState,
    field: &Field,
    suppositions: &Suppositions,
) -> Option<FieldUse> {
    let supposed = suppositions.get(field.key()).and_then(|supposed| supposed.policy.as_ref());
    let in_force = || field.decision().is_mapped().then(|| field.gate().policy());
    let policy = supposed.or_else(in_force)?;
    Some(FieldUse {
        field: field.id(),
        policy: Arc::clone(policy),
        bits_per_hour: bits_per_hour(field.definition(), policy),
        readers: state.networks.recipients(&field.key().request).to_vec(),
        variables: variables_under(state, field, policy, suppositions),
    })
}

/// Returns the information of a field at present; `None` while it is not disclosed.
pub(crate) fn use_of(state: &ConnectorState, field: &Field) -> Option<FieldUse> {
    field_use(state, field, &Suppositions::new())
}

/// Returns the sums under all caps in force, with what ended within the hour. The cost follows the
/// fields of the partners that have caps.
#[must_use]
pub fn cap_usage(state: &ConnectorState, now: DateTime) -> CapUsage {
    let mut usage = CapUsage::new(state.budgets.caps_in_force());
    if usage.is_empty() {
        return usage;
    }
    usage = usage.after(state.former.uses_of_last_hour(now));
    for field in covered(state, &usage) {
        if let Some(used) = use_of(state, field) {
            usage.add(&used);
        }
    }
    usage
}

/// Returns the mapped fields that any of the organisations under caps gets.
fn covered<'s>(state: &'s ConnectorState, usage: &CapUsage) -> Vec<&'s Field> {
    let readers = usage.readers();
    let requests = readers.into_iter().flat_map(|reader| state.networks.requests_for(reader));
    let requests: BTreeSet<&RequestKey> = requests.collect();
    let fields = requests.into_iter().flat_map(|key| state.fields_of(key).map(|(_, field)| field));
    fields.filter(|field| field.decision().is_mapped()).collect()
}

/// Returns what suppositions change, for the fields that they are about and for those that such a
/// field's state withholds.
pub(crate) fn exchanges(state: &ConnectorState, suppositions: &Suppositions) -> Vec<Exchange> {
    let mut concerned: BTreeSet<FieldKey> = suppositions.keys().cloned().collect();
    concerned.extend(suppositions.keys().flat_map(|key| state.fields.dependents_of(key)));
    let exchange = |key: &FieldKey| {
        let field = state.field(key)?;
        Some(Exchange {
            before: use_of(state, field),
            after: field_use(state, field, suppositions),
        })
    };
    concerned.iter().filter_map(exchange).collect()
}

/// Returns what a decision changes that discloses a field under this policy, from these variables.
pub(crate) fn opening(
    state: &ConnectorState,
    key: &FieldKey,
    policy: Arc<DisclosurePolicy>,
    variables: BTreeSet<VariableKey>,
) -> Vec<Exchange> {
    let supposed = Supposed { policy: Some(policy), variables: Some(variables) };
    exchanges(state, &[(key.clone(), supposed)].into())
}

/// Returns the caps that such a decision would exceed.
#[must_use]
pub fn opening_excesses(
    state: &ConnectorState,
    key: &FieldKey,
    policy: Arc<DisclosurePolicy>,
    variables: BTreeSet<VariableKey>,
    now: DateTime,
) -> Vec<CapExcess> {
    cap_usage(state, now)
        .exchange(&opening(state, key, policy, variables))
        .err()
        .unwrap_or_default()
}

/// Returns the caps that imported mappings would exceed: they read other variables.
#[must_use]
pub fn import_excesses<'m>(
    state: &ConnectorState,
    mappings: impl Iterator<Item = &'m Mapping>,
    now: DateTime,
) -> Vec<CapExcess> {
    let mut usage = cap_usage(state, now);
    if usage.is_empty() {
        return Vec::new();
    }
    let published = mappings.filter(|mapping| {
        let decision = state.field(&mapping.target).map(Field::decision);
        decision.is_some_and(|decision| decision.is_open_for(ValueSource::Mapping))
    });
    let supposed = published.map(|mapping| {
        let variables = Some(variables_of(&mapping.inputs));
        (mapping.target.clone(), Supposed { policy: None, variables })
    });
    usage.exchange(&exchanges(state, &supposed.collect())).err().unwrap_or_default()
}

/// Returns the fields that the present caps hold back, in the order of their decisions. Each field
/// is disclosed where it still fits beside those that were decided before it: so the newest give
/// way first, and one without a bound always does.
pub(crate) fn held_back(state: &ConnectorState) -> Vec<HeldBack> {
    held_back_by(state, &state.budgets)
}

fn held_back_by(state: &ConnectorState, budgets: &BudgetRegistry) -> Vec<HeldBack> {
    let mut usage = CapUsage::new(budgets.caps_in_force());
    let mut fields = covered(state, &usage);
    fields.sort_by_key(|field| (field.decision().decided_at, field.id()));
    let hold_back = |field: &Field| {
        let after = use_of(state, field);
        let excesses = usage.exchange(&[Exchange { before: None, after }]).err()?;
        Some((field.key().clone(), excesses))
    };
    fields.into_iter().filter_map(hold_back).collect()
}

/// Returns the fields that a draft of a cap would hold back. Changes nothing.
///
/// # Errors
/// [`DocumentError`] where the draft has faults.
pub fn cap_preview(
    state: &ConnectorState,
    id: &DocumentId,
    draft: Cap,
    now: DateTime,
) -> Result<Vec<HeldBack>, DocumentError> {
    let mut budgets = state.budgets.clone();
    budgets.put_cap(id, draft, None, ("", now))?;
    Ok(held_back_by(state, &budgets))
}

/// Returns the fields that wait because of each cap, sorted.
#[must_use]
pub fn fields_held_back(state: &ConnectorState) -> BTreeMap<DocumentId, Vec<FieldKey>> {
    let mut found: BTreeMap<DocumentId, Vec<FieldKey>> = BTreeMap::new();
    for field in state.fields.iter().filter(|field| !field.decision().is_mapped()) {
        for DocumentVersion { id, .. } in &field.decision().basis.caps {
            found.entry(id.clone()).or_default().push(field.key().clone());
        }
    }
    for fields in found.values_mut() {
        fields.sort();
    }
    found
}
