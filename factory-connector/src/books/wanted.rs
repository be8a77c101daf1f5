//! What suggestions go by: what a field means, and what was decided before.

use asi_model::{
    FieldKey,
    network::{Operation, OperationKind},
};
use mapping_engine::{
    Mapping,
    suggestion::{PastDecision, WantedField},
};

use super::Books;

impl Books {
    /// What a partner wants with a field, in its own words and those around it.
    #[must_use]
    pub fn wanted(&self, key: &FieldKey) -> Option<WantedField> {
        let field = self.field(key)?;
        let (message, request) = self.request(&key.request)?;
        let network = &message.operation_network;
        let operation = network
            .operation_list
            .iter()
            .find(|operation| operation.operation_id == key.request.operation_id)?;
        let texts = [
            field.definition.description.as_deref(),
            request.description.as_deref(),
            Some(request.report_data_format.report_name.as_str()),
            operation.name.as_deref(),
            operation.description.as_deref(),
            subject(operation),
        ];
        Some(WantedField {
            name: field.definition.name.to_string(),
            value_type: field.definition.field_type.0,
            value_rank: field.definition.value_rank,
            unit: field.definition.unit.clone(),
            semantic: field.definition.semantic.clone(),
            descriptions: texts.into_iter().flatten().map(str::to_owned).collect(),
            asset: operation
                .equipment_requirement_list
                .iter()
                .find_map(|equipment| equipment.asset_id.as_ref().map(ToString::to_string)),
        })
    }

    /// The mappings of all fields, in force or proposed, in no order.
    #[must_use]
    pub fn all_mappings(&self) -> Vec<Mapping> {
        self.fields.iter().filter_map(|field| field.decision.mapping.as_deref().cloned()).collect()
    }

    /// Which variables were chosen for which fields, whether or not they still flow.
    #[must_use]
    pub fn past_decisions(&self) -> Vec<PastDecision> {
        let decided = self
            .fields
            .iter()
            .filter_map(|field| Some((&field.key, field, field.decision.mapping.as_ref()?)));
        decided
            .flat_map(|(key, field, mapping)| {
                mapping.inputs.iter().map(|input| PastDecision {
                    field_name: key.field_name.to_string(),
                    semantic: field.definition.semantic.clone(),
                    source_id: input.source_id.clone(),
                    node_id: input.node_id.clone(),
                })
            })
            .collect()
    }
}

/// What an operation is about: the product, the characteristic.
fn subject(operation: &Operation) -> Option<&str> {
    match &operation.kind {
        OperationKind::Production { product_id } => product_id.as_deref(),
        OperationKind::Inspection { characteristic, .. } => characteristic.as_deref(),
        OperationKind::Transportation { .. } => None,
    }
}
