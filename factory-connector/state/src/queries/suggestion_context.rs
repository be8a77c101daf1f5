//! Input for mapping suggestions: the field's meaning and earlier decisions.

use asi_model::{
    FieldKey,
    network::{Operation, OperationKind},
};
use mapping::{
    Mapping,
    suggestion::{PastDecision, RequestedField},
};

use crate::{ConnectorState, operator::OperationKey};

/// Returns the meaning of a field in the partner's words and those around it.
#[must_use]
pub fn requested_field(state: &ConnectorState, key: &FieldKey) -> Option<RequestedField> {
    let field = state.field(key)?;
    let (_, request) = state.request(&key.request)?;
    let operation = state.operation(&OperationKey {
        operation_network_id: key.request.operation_network_id.clone(),
        operation_id: key.request.operation_id.clone(),
    })?;
    let texts = [
        field.definition().description.as_deref(),
        request.description.as_deref(),
        Some(request.report_data_format.report_name.as_str()),
        operation.name.as_deref(),
        operation.description.as_deref(),
        subject(operation),
    ];
    Some(RequestedField {
        name: field.definition().name.to_string(),
        value_type: field.definition().field_type.0,
        value_rank: field.definition().value_rank,
        unit: field.definition().unit.clone(),
        semantic: field.definition().semantic.clone(),
        descriptions: texts.into_iter().flatten().map(str::to_owned).collect(),
        asset: operation
            .equipment_requirement_list
            .iter()
            .find_map(|equipment| equipment.asset_id.as_ref().map(ToString::to_string)),
    })
}

/// Returns the mappings of all fields, in force or proposed, in no order.
#[must_use]
pub fn all_mappings(state: &ConnectorState) -> Vec<Mapping> {
    state.fields.iter().filter_map(|field| field.decision().mapping.as_deref().cloned()).collect()
}

/// Returns the variables that were chosen for fields, whether or not they are still in use.
#[must_use]
pub fn past_decisions(state: &ConnectorState) -> Vec<PastDecision> {
    let decided =
        state.fields.iter().filter_map(|field| Some((field, field.decision().mapping.as_ref()?)));
    decided
        .flat_map(|(field, mapping)| {
            mapping.inputs.iter().map(|input| PastDecision {
                field_name: field.key().field_name.to_string(),
                semantic: field.definition().semantic.clone(),
                source_id: input.source_id.clone(),
                node_id: input.node_id.clone(),
            })
        })
        .collect()
}

/// Returns the product or the characteristic that an operation is about.
fn subject(operation: &Operation) -> Option<&str> {
    match &operation.kind {
        OperationKind::Production { product_id } => product_id.as_deref(),
        OperationKind::Inspection { characteristic, .. } => characteristic.as_deref(),
        OperationKind::Transportation { .. } => None,
    }
}
