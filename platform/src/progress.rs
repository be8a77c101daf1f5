//! Progress of operations, derived from the *semantic* of report fields, never from their names.

use asi_model::{
    DateTime, FactoryId, OperationId,
    network::{Operation, OperationNetwork, OperationState, Semantic},
    plain_value::as_number,
    units,
};
use serde::Serialize;
use serde_json::Value;
use utoipa::ToSchema;

use crate::store::{CurrentValue, FieldRow};

/// Progress of an operation, derived from the viewer's fields.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct OperationProgress {
    pub operation_id: OperationId,
    /// The factory that carries it out.
    pub owning_factory_id: Option<FactoryId>,
    /// Its state after ISA-95.
    pub state: Option<OperationState>,
    /// True where nobody reported the state and it is concluded from quantities and times.
    pub is_state_inferred: bool,
    /// Produced quantity in `quantityUnit`; the good quantity if only that is reported.
    pub quantity: Option<f64>,
    /// Good part of the quantity.
    pub good_quantity: Option<f64>,
    /// Scrap part of the quantity.
    pub scrap_quantity: Option<f64>,
    pub planned_quantity: Option<f64>,
    /// The unit of all quantities.
    pub quantity_unit: Option<String>,
    /// Completion, 0 to 100: as reported, else derived from the quantities.
    pub percent_complete: Option<f64>,
    /// Start reported by the factory.
    pub actual_start: Option<DateTime>,
    pub actual_end: Option<DateTime>,
    /// End expected by the factory.
    pub expected_end: Option<DateTime>,
    /// Arrival of the last report about it.
    pub last_report_at: Option<DateTime>,
}

/// Derives the progress of each operation, in the order of the network. `fields` are those that the
/// viewer may see.
#[must_use]
pub(crate) fn progress(network: &OperationNetwork, fields: &[FieldRow]) -> Vec<OperationProgress> {
    network.operation_list.iter().map(|operation| of_operation(operation, fields)).collect()
}

/// Derives the progress of one operation.
#[must_use]
pub(crate) fn of_operation(operation: &Operation, fields: &[FieldRow]) -> OperationProgress {
    let newest = Newest { operation, fields };
    let quantity_of = |semantic: &Semantic| newest.quantity(semantic);
    let good_quantity = quantity_of(&Semantic::GoodQuantity);
    let quantity = quantity_of(&Semantic::ProducedQuantity).or(good_quantity);
    let from_quantities = || {
        let planned = operation.planned_quantity.filter(|planned| *planned > 0.0)?;
        Some((quantity? / planned * 100.0).clamp(0.0, 100.0))
    };
    let percent_complete = newest.number(&Semantic::PercentComplete).or_else(from_quantities);
    let (actual_start, actual_end) =
        (newest.time(&Semantic::ActualStart), newest.time(&Semantic::ActualEnd));
    let reported_state = newest.state();
    let inferred_state = || {
        if actual_end.is_some() {
            Some(OperationState::Ended)
        } else if actual_start.is_some() || quantity.is_some_and(|quantity| quantity > 0.0) {
            Some(OperationState::Running)
        } else {
            None
        }
    };
    let state = reported_state.or_else(inferred_state);
    OperationProgress {
        operation_id: operation.operation_id.clone(),
        owning_factory_id: operation.owning_factory_id.clone(),
        state,
        is_state_inferred: state.is_some() && reported_state.is_none(),
        quantity,
        good_quantity,
        scrap_quantity: quantity_of(&Semantic::ScrapQuantity),
        planned_quantity: operation.planned_quantity,
        quantity_unit: operation.quantity_unit.clone(),
        percent_complete,
        actual_start,
        actual_end,
        expected_end: newest.time(&Semantic::ExpectedEnd),
        last_report_at: newest.last_report_at(),
    }
}

/// The newest usable values of an operation, by meaning.
struct Newest<'a> {
    operation: &'a Operation,
    fields: &'a [FieldRow],
}

impl Newest<'_> {
    fn rows(&self) -> impl Iterator<Item = (&FieldRow, &CurrentValue)> {
        let id = &self.operation.operation_id;
        self.fields
            .iter()
            .filter(move |row| row.key.request.operation_id == *id)
            .filter_map(|row| Some((row, row.current.as_ref()?)))
    }

    /// Returns the newest value with this meaning, of all requests that ask for it.
    fn find(&self, semantic: &Semantic) -> Option<(&CurrentValue, Option<&str>)> {
        let mut best: Option<(&CurrentValue, Option<&str>)> = None;
        for (row, current) in self.rows() {
            let asked = self
                .operation
                .dynamic_data_request_list
                .iter()
                .filter(|request| {
                    request.dynamic_data_request_id == row.key.request.dynamic_data_request_id
                })
                .flat_map(|request| &request.report_data_format.report_field_list)
                .find(|field| {
                    field.name == row.key.field_name && field.semantic.as_ref() == Some(semantic)
                });
            let Some(field) = asked else { continue };
            let age = |value: &CurrentValue| (value.source_timestamp, value.received_at);
            if !current.status.is_bad() && best.is_none_or(|(value, _)| age(value) < age(current)) {
                best = Some((current, field.unit.as_deref()));
            }
        }
        best
    }

    fn number(&self, semantic: &Semantic) -> Option<f64> {
        as_number(&self.find(semantic)?.0.value)
    }

    /// Returns a quantity in the operation's unit; unconverted where either unit is unknown.
    fn quantity(&self, semantic: &Semantic) -> Option<f64> {
        let (current, unit) = self.find(semantic)?;
        let number = as_number(&current.value)?;
        let units = unit
            .and_then(units::lookup)
            .zip(self.operation.quantity_unit.as_deref().and_then(units::lookup));
        match units {
            Some((from, to)) => units::convert(number, &from, &to).ok(),
            None => Some(number),
        }
    }

    fn time(&self, semantic: &Semantic) -> Option<DateTime> {
        self.find(semantic)?.0.value.as_str()?.parse().ok()
    }

    fn state(&self) -> Option<OperationState> {
        match &self.find(&Semantic::OperationState)?.0.value {
            Value::String(text) => {
                OperationState::from_name(text).or_else(|| by_index(text.parse().ok()?))
            }
            Value::Number(number) => by_index(number.as_u64()?),
            _ => None,
        }
    }

    fn last_report_at(&self) -> Option<DateTime> {
        self.rows().map(|(_, current)| current.received_at).max()
    }
}

fn by_index(index: u64) -> Option<OperationState> {
    OperationState::ALL.get(usize::try_from(index).ok()?).copied()
}

#[cfg(test)]
mod tests {
    use asi_model::{OperationNetworkId, RequestKey, StatusCode, messages::MappingState};
    use serde_json::json;

    use super::*;

    fn operation(fields: Value) -> Operation {
        serde_json::from_value(json!({
            "operationId": "op", "operationType": "PRODUCTION", "plannedQuantity": 12, "quantityUnit": "PIECE",
            "dynamicDataRequestList": [{ "dynamicDataRequestId": "req", "requesterId": "a", "recipientList": ["a"],
                "purpose": "p", "reportDataFormat": { "reportName": "r", "reportFieldList": fields } }]
        }))
        .expect("an operation")
    }

    fn row(name: &str, value: Value, received_ticks: i64) -> FieldRow {
        let request = RequestKey {
            operation_network_id: OperationNetworkId::new("net").expect("valid"),
            operation_id: "op".parse().expect("valid"),
            dynamic_data_request_id: "req".parse().expect("valid"),
        };
        let key = request.field(name.parse().expect("valid"));
        let current = CurrentValue {
            key: key.clone(),
            epoch: 1,
            sequence: 1,
            value,
            built_in_type: 9,
            status: StatusCode::GOOD,
            source_timestamp: None,
            report_timestamp: None,
            received_at: DateTime::from_ticks(received_ticks),
            recipient_set: None,
        };
        FieldRow {
            key,
            factory_id: "F".parse().expect("valid"),
            mapping_state: MappingState::Mapped,
            reason: None,
            disclosure: None,
            decided_at: None,
            current: Some(current),
        }
    }

    #[test]
    fn quantities_give_the_percentage_and_a_likely_state() {
        let operation = operation(json!([
            { "name": "made", "type": 9, "unit": "PIECE", "semantic": "PRODUCED_QUANTITY" } ]));
        let progress = of_operation(&operation, &[row("made", json!("3"), 7)]);
        assert_eq!((progress.quantity, progress.percent_complete), (Some(3.0), Some(25.0)));
        assert_eq!(
            (progress.state, progress.is_state_inferred),
            (Some(OperationState::Running), true)
        );
        assert_eq!(progress.last_report_at, Some(DateTime::from_ticks(7)));
    }

    #[test]
    fn names_of_fields_have_no_effect() {
        let operation = operation(json!([{ "name": "progressStatus", "type": 9 }]));
        let progress = of_operation(&operation, &[row("progressStatus", json!("3"), 7)]);
        assert_eq!((progress.quantity, progress.state), (None, None));
    }

    #[test]
    fn a_reported_state_counts_more_than_a_conclusion() {
        let operation = operation(json!([
            { "name": "made", "type": 9, "semantic": "PRODUCED_QUANTITY" },
            { "name": "state", "type": 12, "semantic": "OPERATION_STATE" },
            { "name": "percent", "type": 11, "semantic": "PERCENT_COMPLETE" },
            { "name": "start", "type": 13, "semantic": "ACTUAL_START" } ]));
        let fields = [
            row("made", json!("3"), 1),
            row("state", json!("interrupted"), 2),
            row("percent", json!(40.5), 3),
            row("start", json!("2019-04-18T06:00:00Z"), 4),
        ];
        let progress = of_operation(&operation, &fields);
        assert_eq!(
            (progress.state, progress.is_state_inferred),
            (Some(OperationState::Interrupted), false)
        );
        assert_eq!(progress.percent_complete, Some(40.5));
        assert_eq!(
            progress.actual_start.map(|time| time.to_string()),
            Some("2019-04-18T06:00:00Z".to_owned())
        );
        let numeric = of_operation(&operation, &[row("state", json!(4), 1)]);
        assert_eq!(numeric.state, Some(OperationState::Ended));
    }

    #[test]
    fn bad_values_yield_no_progress() {
        let operation =
            operation(json!([{ "name": "made", "type": 9, "semantic": "PRODUCED_QUANTITY" }]));
        let mut bad = row("made", json!("3"), 1);
        if let Some(current) = &mut bad.current {
            current.status = StatusCode::BAD;
        }
        assert_eq!(of_operation(&operation, &[bad]).quantity, None);
    }
}
