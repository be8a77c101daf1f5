//! Operations of a day, as the operator's page lists them.

use std::time::Duration;

use asi_model::{
    DateTime, FieldKey,
    messages::ValueSource,
    network::{Operation, OperationState, Semantic},
    openapi::PlainValue,
};
use axum::{Json, extract::State};
use connector_state::{
    ConnectorState, Field,
    operator::{Journal, OperationKey, OperationStatus},
    queries,
};
use daemon::web::{ApiQuery, Problem};
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};

use crate::{
    api::{context::Api, problems::Problems, roles::Operator, values::ShownValue, view::Page},
    clock::now,
};

/// Length of a day if the page does not name its end.
const DAY: Duration = Duration::from_secs(86_400);

/// Day of the listed operations.
#[derive(Deserialize, IntoParams)]
#[serde(rename_all = "camelCase")]
#[into_params(parameter_in = Query)]
pub struct OperationsQuery {
    /// Begin of the day; that of the present day in UTC without it.
    from: Option<DateTime>,
    /// End of the day; 24 hours after its begin without it.
    until: Option<DateTime>,
}

/// An operation with fields for people to fill.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct OperatorOperation {
    #[serde(flatten)]
    key: OperationKey,
    name: Option<String>,
    description: Option<String>,
    network_name: Option<String>,
    /// `PRODUCTION`, `INSPECTION` or `TRANSPORTATION`.
    operation_type: &'static str,
    planned_start: Option<DateTime>,
    planned_end: Option<DateTime>,
    planned_quantity: Option<f64>,
    quantity_unit: Option<String>,
    /// Progress by the entries so far.
    #[serde(rename = "standing")]
    status: OperationStatus,
    buttons: Buttons,
    /// The fields that take entered values.
    fields: Vec<OperatorField>,
}

/// Buttons with an effect on a field. The others only inform this plant.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
#[allow(clippy::struct_excessive_bools)]
pub struct Buttons {
    start: bool,
    add_good: bool,
    add_scrap: bool,
    done: bool,
    problem: bool,
}

/// A field that takes entered values.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct OperatorField {
    key: FieldKey,
    name: String,
    #[serde(rename = "type")]
    field_type: &'static str,
    unit: Option<String>,
    semantic: Option<String>,
    description: Option<String>,
    /// True if the value follows from the buttons; it can be typed all the same.
    has_button: bool,
    /// Last entered value, before the disclosure gate.
    #[schema(value_type = PlainValue, required = false)]
    entered: Option<serde_json::Value>,
    entered_at: Option<DateTime>,
    /// Newest disclosed value, which the partner has.
    value: Option<ShownValue>,
}

/// Lists the operations of a day that have fields for people to fill, and those that are running or
/// interrupted.
#[utoipa::path(
    get,
    path = "/operator/operations",
    tag = "operator",
    params(OperationsQuery),
    responses((status = 200, body = Page<OperatorOperation>), Problems)
)]
pub async fn list_operator_operations(
    _: Operator,
    State(api): State<Api>,
    ApiQuery(query): ApiQuery<OperationsQuery>,
) -> Result<Json<Page<OperatorOperation>>, Problem> {
    let from = query.from.unwrap_or_else(|| now().floor_to(DAY));
    let until = query.until.unwrap_or_else(|| from.after(DAY));
    if until <= from {
        return Err(Problem::bad_request("INVALID_TIME", "`until` must be later than `from`."));
    }
    let mut items =
        api.coordinator.read(move |state| operations_between(state, from, until)).await?;
    items.sort_by(|a, b| (a.planned_start, &a.key).cmp(&(b.planned_start, &b.key)));
    Ok(Json(Page::whole(items)))
}

fn operations_between(
    state: &ConnectorState,
    from: DateTime,
    until: DateTime,
) -> Vec<OperatorOperation> {
    let mut items = Vec::new();
    for (network_id, network) in state.networks().iter() {
        let Some(message) = &network.message else { continue };
        for operation in
            message.operation_network.operation_list.iter().filter(|operation| !operation.stub)
        {
            let key = OperationKey {
                operation_network_id: network_id.clone(),
                operation_id: operation.operation_id.clone(),
            };
            let status = state.journal(&key).map(Journal::status).unwrap_or_default();
            let is_open =
                matches!(status.state, Some(OperationState::Running | OperationState::Interrupted));
            let is_of_the_day = operation.planned_start.is_none_or(|start| start < until)
                && operation.planned_end.is_none_or(|end| end >= from);
            if !(is_open || is_of_the_day) {
                continue;
            }
            let item = operation_view(
                state,
                key,
                operation,
                status,
                message.operation_network.name.clone(),
            );
            if !item.fields.is_empty() {
                items.push(item);
            }
        }
    }
    items
}

fn operation_view(
    state: &ConnectorState,
    key: OperationKey,
    operation: &Operation,
    status: OperationStatus,
    network_name: Option<String>,
) -> OperatorOperation {
    let fields: Vec<(FieldKey, &Field)> = queries::fields_of_operation(state, &key)
        .into_iter()
        .filter(|(_, field)| field.decision().is_open_for(ValueSource::Manual))
        .collect();
    let has_any = |semantics: &[Semantic]| {
        fields.iter().any(|(_, field)| {
            field
                .definition()
                .semantic
                .as_ref()
                .is_some_and(|semantic| semantics.contains(semantic))
        })
    };
    let buttons = Buttons {
        start: has_any(&[Semantic::OperationState, Semantic::ActualStart]),
        add_good: has_any(&[
            Semantic::ProducedQuantity,
            Semantic::GoodQuantity,
            Semantic::PercentComplete,
        ]),
        add_scrap: has_any(&[Semantic::ProducedQuantity, Semantic::ScrapQuantity]),
        done: has_any(&[Semantic::OperationState, Semantic::ActualEnd, Semantic::PercentComplete]),
        problem: has_any(&[Semantic::OperationState]),
    };
    let fields = fields
        .into_iter()
        .map(|(field, known)| field_view(state, &key, operation, field, known))
        .collect();
    OperatorOperation {
        name: operation.name.clone(),
        description: operation.description.clone(),
        network_name,
        operation_type: operation.kind.name(),
        planned_start: operation.planned_start,
        planned_end: operation.planned_end,
        planned_quantity: operation.planned_quantity,
        quantity_unit: operation.quantity_unit.clone(),
        status,
        buttons,
        fields,
        key,
    }
}

fn field_view(
    state: &ConnectorState,
    operation: &OperationKey,
    document: &Operation,
    key: FieldKey,
    field: &Field,
) -> OperatorField {
    let definition = field.definition();
    let semantic = definition.semantic.as_ref();
    let answer = state
        .journal(operation)
        .and_then(|journal| journal.answer(&key, semantic, document.planned_quantity));
    OperatorField {
        name: definition.name.to_string(),
        field_type: definition.field_type.0.name(),
        unit: definition.unit.clone(),
        semantic: semantic.map(|semantic| semantic.as_str().to_owned()),
        description: definition.description.clone(),
        has_button: semantic
            .is_some_and(|semantic| !matches!(semantic, Semantic::ExpectedEnd | Semantic::Iri(_))),
        entered: answer.as_ref().and_then(|(answer, _)| answer.json(definition.field_type.0)),
        entered_at: answer.map(|(_, at)| at),
        value: field.gate().disclosed().map(ShownValue::from),
        key,
    }
}
