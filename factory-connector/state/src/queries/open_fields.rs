//! Open fields of each partner, for the leak budget.

use std::{collections::BTreeMap, sync::Arc};

use asi_model::{DateTime, FieldKey, OrganisationId, RequestKey};
use disclosure::{DisclosurePolicy, OpenField};

use super::caps::{Suppositions, variables_under};
use crate::ConnectorState;

/// A field that is regarded as open with this policy.
pub type Supposition<'s> = (&'s FieldKey, &'s Arc<DisclosurePolicy>);

/// Returns the open fields of each requester and recipient; the supposed field counts as open.
#[must_use]
pub fn open_fields<'s>(
    state: &'s ConnectorState,
    now: DateTime,
    supposition: Option<Supposition<'s>>,
) -> BTreeMap<&'s OrganisationId, Vec<OpenField<'s>>> {
    let mut open: BTreeMap<&OrganisationId, Vec<OpenField<'_>>> = BTreeMap::new();
    let nothing_supposed = Suppositions::new();
    let networks = state.networks.active().map(|message| &message.operation_network);
    let operations = networks.flat_map(|network| {
        network.operation_list.iter().map(|operation| (&network.operation_network_id, operation))
    });
    for (network_id, operation) in operations {
        for request in &operation.dynamic_data_request_list {
            let request_key = RequestKey {
                operation_network_id: network_id.clone(),
                operation_id: operation.operation_id.clone(),
                dynamic_data_request_id: request.dynamic_data_request_id.clone(),
            };
            let mut partners: Vec<&OrganisationId> = request.recipient_list.iter().collect();
            if !partners.contains(&&request.requester_id) {
                partners.push(&request.requester_id);
            }
            for definition in &request.report_data_format.report_field_list {
                let Some(field) = state.field(&request_key.field(definition.name.clone())) else {
                    continue;
                };
                let supposed =
                    supposition.filter(|(key, _)| *key == field.key()).map(|(_, policy)| policy);
                let in_force = || field.decision().is_mapped().then(|| field.gate().policy());
                let Some(policy) = supposed.or_else(in_force) else { continue };
                let measured = field.rate().measured(now).into();
                let variables = variables_under(state, field, policy, &nothing_supposed);
                let entry = OpenField {
                    key: field.key(),
                    definition,
                    operation,
                    policy,
                    variables: variables.into_iter().collect(),
                    measured,
                };
                for partner in &partners {
                    open.entry(partner).or_default().push(entry.clone());
                }
            }
        }
    }
    open
}
