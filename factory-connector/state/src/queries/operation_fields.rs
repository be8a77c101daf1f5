//! Fields of all requests about an operation.

use asi_model::{FieldKey, RequestKey};

use crate::{ConnectorState, Field, operator::OperationKey};

/// Returns the fields of all requests about an operation, in the order of the requests.
#[must_use]
pub fn fields_of_operation<'s>(
    state: &'s ConnectorState,
    operation: &OperationKey,
) -> Vec<(FieldKey, &'s Field)> {
    let Some(document) = state.operation(operation) else { return Vec::new() };
    let mut fields = Vec::new();
    for request in &document.dynamic_data_request_list {
        let key = RequestKey {
            operation_network_id: operation.operation_network_id.clone(),
            operation_id: operation.operation_id.clone(),
            dynamic_data_request_id: request.dynamic_data_request_id.clone(),
        };
        for definition in &request.report_data_format.report_field_list {
            let key = key.field(definition.name.clone());
            fields.extend(state.field(&key).map(|field| (key, field)));
        }
    }
    fields
}
