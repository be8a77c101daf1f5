//! The operator's page: today's operations, and what people enter about them.

use std::time::Duration;

use asi_model::{
    DateTime, FieldKey,
    messages::ValueSource,
    network::{Operation, OperationState, Semantic},
};
use axum::{Json, extract::State};
use daemon::web::{ApiJson, ApiQuery, Problem};
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};

use super::{
    Api,
    fields::Entered,
    problems::Problems,
    roles::{Operator, Viewer},
    view::Page,
};
use crate::{
    books::{Books, EntryOutcome, Field},
    desk::now,
    operator::{Action, EntryId, OperationKey, OperatorEntry, Standing},
    values::ShownValue,
};

/// Most entries delivered at once.
const ENTRIES_MAX: usize = 500;
/// Entries listed of an operation.
const LISTED_MAX: usize = 200;
/// How long a day is, where the page does not say when it begins and ends.
const DAY: Duration = Duration::from_secs(86_400);

/// Which operations.
#[derive(Deserialize, IntoParams)]
#[serde(rename_all = "camelCase")]
#[into_params(parameter_in = Query)]
pub struct OperationsQuery {
    /// When the shown day begins; the present day in UTC without it.
    from: Option<DateTime>,
    /// When it ends; a day later without it.
    until: Option<DateTime>,
}

/// An operation as the operator sees it.
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
    /// By the entries so far.
    standing: Standing,
    buttons: Buttons,
    /// The fields that take entered values.
    fields: Vec<OperatorField>,
}

/// Which buttons have an effect on a field; the others only tell this plant.
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
    /// The value follows from the buttons; it can be typed all the same.
    has_button: bool,
    /// What was entered last, as it was before the gate.
    #[schema(value_type = Option<Object>)]
    entered: Option<serde_json::Value>,
    /// When.
    entered_at: Option<DateTime>,
    /// The newest disclosed value: what the partner has.
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
    _: Viewer,
    State(api): State<Api>,
    ApiQuery(query): ApiQuery<OperationsQuery>,
) -> Result<Json<Page<OperatorOperation>>, Problem> {
    let from = query.from.unwrap_or_else(|| now().floor_to(DAY));
    let until = query.until.unwrap_or_else(|| from.after(DAY));
    if until <= from {
        return Err(Problem::bad_request("INVALID_TIME", "`until` must be later than `from`."));
    }
    let mut items = api.desk.read(move |books| shown(books, from, until)).await?;
    items.sort_by(|a, b| (a.planned_start, &a.key).cmp(&(b.planned_start, &b.key)));
    Ok(Json(Page::whole(items)))
}

fn shown(books: &Books, from: DateTime, until: DateTime) -> Vec<OperatorOperation> {
    let mut items = Vec::new();
    for (network_id, network) in &books.networks {
        let Some(message) = &network.message else { continue };
        for operation in
            message.operation_network.operation_list.iter().filter(|operation| !operation.stub)
        {
            let key = OperationKey {
                operation_network_id: network_id.clone(),
                operation_id: operation.operation_id.clone(),
            };
            let standing =
                books.journal(&key).map(crate::operator::Journal::standing).unwrap_or_default();
            let is_open = matches!(
                standing.state,
                Some(OperationState::Running | OperationState::Interrupted)
            );
            let is_of_the_day = operation.planned_start.is_none_or(|start| start < until)
                && operation.planned_end.is_none_or(|end| end >= from);
            if !(is_open || is_of_the_day) {
                continue;
            }
            let item = of_operation(
                books,
                key,
                operation,
                standing,
                message.operation_network.name.clone(),
            );
            if !item.fields.is_empty() {
                items.push(item);
            }
        }
    }
    items
}

fn of_operation(
    books: &Books,
    key: OperationKey,
    operation: &Operation,
    standing: Standing,
    network_name: Option<String>,
) -> OperatorOperation {
    let fields: Vec<(FieldKey, &Field)> = books
        .fields_of_operation(&key)
        .into_iter()
        .filter(|(_, field)| field.decision.is_open_for(ValueSource::Manual))
        .collect();
    let asks = |wanted: &[Semantic]| {
        fields.iter().any(|(_, field)| {
            field.definition.semantic.as_ref().is_some_and(|semantic| wanted.contains(semantic))
        })
    };
    let buttons = Buttons {
        start: asks(&[Semantic::OperationState, Semantic::ActualStart]),
        add_good: asks(&[
            Semantic::ProducedQuantity,
            Semantic::GoodQuantity,
            Semantic::PercentComplete,
        ]),
        add_scrap: asks(&[Semantic::ProducedQuantity, Semantic::ScrapQuantity]),
        done: asks(&[Semantic::OperationState, Semantic::ActualEnd, Semantic::PercentComplete]),
        problem: asks(&[Semantic::OperationState]),
    };
    let fields = fields
        .into_iter()
        .map(|(field, known)| of_field(books, &key, operation, field, known))
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
        standing,
        buttons,
        fields,
        key,
    }
}

fn of_field(
    books: &Books,
    operation: &OperationKey,
    document: &Operation,
    key: FieldKey,
    field: &Field,
) -> OperatorField {
    let definition = &field.definition;
    let semantic = definition.semantic.as_ref();
    let answer = books
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
        value: field.gate.disclosed().map(ShownValue::from),
        key,
    }
}

/// Whose entries.
#[derive(Deserialize, IntoParams)]
#[serde(rename_all = "camelCase")]
#[into_params(parameter_in = Query)]
pub struct EntriesQuery {
    /// The network.
    operation_network_id: asi_model::OperationNetworkId,
    /// The operation.
    operation_id: asi_model::OperationId,
}

/// Lists what was entered about an operation, newest first: the last 200 entries.
#[utoipa::path(
    get,
    path = "/operator/entries",
    tag = "operator",
    params(EntriesQuery),
    responses((status = 200, body = Page<OperatorEntry>), Problems)
)]
pub async fn list_operator_entries(
    _: Viewer,
    State(api): State<Api>,
    ApiQuery(query): ApiQuery<EntriesQuery>,
) -> Result<Json<Page<OperatorEntry>>, Problem> {
    let key = OperationKey {
        operation_network_id: query.operation_network_id,
        operation_id: query.operation_id,
    };
    let items = api
        .desk
        .read(move |books| {
            books.operation(&key)?;
            let newest = books
                .journal(&key)
                .map(|journal| journal.newest().take(LISTED_MAX).cloned().collect());
            Some(newest.unwrap_or_default())
        })
        .await?;
    items.map(|items| Json(Page::whole(items))).ok_or_else(|| Problem::not_found("such operation"))
}

/// Entries that a page kept.
#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct Delivery {
    /// The page's clock when it delivers; the entries' times are corrected by how far it is off.
    sent_at: Option<DateTime>,
    /// Up to 500, in any order.
    #[schema(value_type = Vec<NewEntry>)]
    entries: Vec<serde_json::Value>,
}

/// An entry as the page made it.
#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct NewEntry {
    /// Made by the page, 1 to 64 letters, digits, `-` or `_`; an entry that comes again has no
    /// further effect.
    entry_id: EntryId,
    #[serde(flatten)]
    operation: OperationKey,
    /// When it was made, by the page's clock.
    made_at: DateTime,
    #[serde(flatten)]
    action: Action,
}

/// What became of an entry.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct EntryResult {
    /// The entry.
    entry_id: String,
    /// `TAKEN`, `REPEATED` or `REFUSED`; in each case the page must not deliver it again.
    result: &'static str,
    /// For `REFUSED`: why, as a code.
    code: Option<&'static str>,
    /// For `REFUSED`: why, and what to do.
    message: Option<String>,
    /// Fields that took a value from it.
    fields: Vec<FieldResult>,
}

/// What became of a value of an entry.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct FieldResult {
    key: FieldKey,
    #[serde(flatten)]
    entered: Entered,
}

/// Takes entries. They are stored together when the answer comes; without an answer the page
/// delivers them again.
#[utoipa::path(
    post,
    path = "/operator/entries",
    tag = "operator",
    request_body = Delivery,
    responses((status = 200, body = Page<EntryResult>), Problems)
)]
pub async fn deliver_operator_entries(
    Operator(user): Operator,
    State(api): State<Api>,
    ApiJson(delivery): ApiJson<Delivery>,
) -> Result<Json<Page<EntryResult>>, Problem> {
    if delivery.entries.len() > ENTRIES_MAX {
        return Err(Problem::bad_request(
            "TOO_MANY",
            "At most 500 entries are taken at once; deliver them in parts.",
        ));
    }
    let now = DateTime::from_unix_micros(now().unix_micros());
    let mut results = Vec::with_capacity(delivery.entries.len());
    let (mut places, mut entries) = (Vec::new(), Vec::new());
    for json in delivery.entries {
        let entry_id = json["entryId"].as_str().unwrap_or_default().to_owned();
        match serde_json::from_value::<NewEntry>(json) {
            Ok(entry) => {
                places.push(results.len());
                results.push(result(entry_id, EntryOutcome::Repeated));
                entries.push(OperatorEntry {
                    entry_id: entry.entry_id,
                    operation: entry.operation,
                    made_at: corrected(entry.made_at, delivery.sent_at, now),
                    received_at: now,
                    made_by: user.principal.user_name.clone(),
                    action: entry.action,
                });
            }
            // One entry that cannot be read must not keep the others from ever being delivered.
            Err(error) => results.push(unreadable(entry_id, &error)),
        }
    }
    for (place, outcome) in places.into_iter().zip(api.desk.enter(entries).await?) {
        let entry_id = std::mem::take(&mut results[place].entry_id);
        results[place] = result(entry_id, outcome);
    }
    Ok(Json(Page::whole(results)))
}

fn unreadable(entry_id: String, error: &serde_json::Error) -> EntryResult {
    EntryResult {
        entry_id,
        result: "REFUSED",
        code: Some("UNREADABLE"),
        message: Some(format!("The entry cannot be read: {error}.")),
        fields: Vec::new(),
    }
}

/// A time of the page's clock by ours, in whole microseconds and never in the future.
fn corrected(made_at: DateTime, sent_at: Option<DateTime>, now: DateTime) -> DateTime {
    let sent_at = sent_at.unwrap_or(now);
    let age = sent_at.since(made_at);
    let micros = i64::try_from(age.as_micros()).unwrap_or(i64::MAX);
    DateTime::from_unix_micros(now.unix_micros().saturating_sub(micros))
}

fn result(entry_id: String, outcome: EntryOutcome) -> EntryResult {
    let (result, code, message, fields) = match outcome {
        EntryOutcome::Taken(fields) => ("TAKEN", None, None, fields),
        EntryOutcome::Repeated => ("REPEATED", None, None, Vec::new()),
        EntryOutcome::Refused(fault) => {
            let mut message = format!("{fault}.");
            if let Some(first) = message.get_mut(..1) {
                first.make_ascii_uppercase();
            }
            ("REFUSED", Some(fault.code()), Some(message), Vec::new())
        }
    };
    let fields = fields
        .into_iter()
        .map(|(key, outcome)| FieldResult { key, entered: outcome.into() })
        .collect();
    EntryResult { entry_id, result, code, message, fields }
}
