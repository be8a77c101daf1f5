//! Requests and fields as pages show them.

use asi_model::{DateTime, FieldKey, RequestKey};
use serde::Serialize;
use utoipa::ToSchema;

use crate::{
    books::{Books, Field},
    disclosure::DisclosurePolicy,
    values::ShownValue,
};

/// A page of a list.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct Page<T> {
    /// The items.
    pub items: Vec<T>,
    /// Where the next page begins; none on the last.
    pub next_cursor: Option<String>,
}

impl<T> Page<T> {
    /// All of a list.
    pub const fn whole(items: Vec<T>) -> Self {
        Self { items, next_cursor: None }
    }
}

/// A requested field with its decision and value.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct FieldView {
    /// Its address.
    #[schema(value_type = Object)]
    pub key: FieldKey,
    /// Its name.
    pub name: String,
    /// Its built-in type by name.
    #[serde(rename = "type")]
    pub field_type: String,
    /// -1 scalar, 1 array.
    pub value_rank: i32,
    /// Its unit as requested.
    pub unit: Option<String>,
    /// What it means.
    pub semantic: Option<String>,
    /// More about it.
    pub description: Option<String>,
    /// `PENDING`, `MAPPED` or `REFUSED`.
    #[schema(value_type = String)]
    pub mapping_state: asi_model::messages::MappingState,
    /// `MAPPING`, `MANUAL` or `EXTERNAL`, while mapped.
    #[schema(value_type = Option<String>)]
    pub value_source: Option<asi_model::messages::ValueSource>,
    /// How values are coarsened.
    pub disclosure: DisclosurePolicy,
    /// The same in words, as the partner is told.
    pub disclosure_statement: Option<String>,
    /// Why it was decided so.
    pub decision_reason: Option<String>,
    /// Who decided.
    pub decided_by: Option<String>,
    /// When.
    #[schema(value_type = Option<String>, format = "date-time")]
    pub decision_time: Option<DateTime>,
    /// The newest disclosed value: what the partner has.
    pub value: Option<ShownValue>,
    /// The mapping in force, or the one to offer again.
    #[schema(value_type = Option<Object>)]
    pub mapping: Option<mapping_engine::Mapping>,
    /// The number of the newest version of the mapping; none before the first.
    pub mapping_version: Option<u32>,
    /// A mapping is on trial beside the published one.
    pub has_shadow: bool,
}

impl FieldView {
    /// As it stands.
    pub fn new(key: FieldKey, field: &Field) -> Self {
        let (definition, decision) = (&field.definition, &field.decision);
        Self {
            name: definition.name.to_string(),
            field_type: definition.field_type.0.name().to_owned(),
            value_rank: definition.value_rank,
            unit: definition.unit.clone(),
            semantic: definition.semantic.as_ref().map(|semantic| semantic.as_str().to_owned()),
            description: definition.description.clone(),
            mapping_state: decision.mapping_state,
            value_source: decision.value_source,
            disclosure: (*decision.policy).clone(),
            disclosure_statement: field.statement().map(|statement| statement.description),
            decision_reason: decision.reason.clone(),
            decided_by: decision.decided_by.clone(),
            decision_time: decision.decided_at,
            value: field.gate.disclosed().map(ShownValue::from),
            mapping: decision.mapping.clone(),
            mapping_version: (field.shelf.version > 0).then_some(field.shelf.version),
            has_shadow: field.shelf.shadow.is_some(),
            key,
        }
    }
}

/// A request of a partner.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct RequestView {
    /// Its address.
    #[schema(value_type = Object)]
    pub key: RequestKey,
    /// The operation it asks about, without its requests.
    #[schema(value_type = Object)]
    pub operation: serde_json::Value,
    /// What the network is called.
    pub network_name: Option<String>,
    /// Who asks.
    pub requester_id: String,
    /// Who may see the answers.
    #[schema(value_type = Vec<String>)]
    pub recipient_list: Vec<asi_model::OrganisationId>,
    /// What for.
    pub purpose: String,
    /// More about it.
    pub description: Option<String>,
    /// How often the partner wants to hear, as the time between two reports in milliseconds.
    pub update_interval_ms: Option<u64>,
    /// Until when.
    #[schema(value_type = Option<String>, format = "date-time")]
    pub valid_until: Option<DateTime>,
    /// When this revision came.
    #[schema(value_type = String, format = "date-time")]
    pub received_at: DateTime,
    /// What the report is called.
    pub report_name: String,
    /// Its DataSetWriter.
    pub data_set_writer_id: Option<u16>,
    /// Its fields.
    pub fields: Vec<FieldView>,
}

/// Every request of the active networks, or of one, in document order.
pub fn requests(books: &Books, network: Option<&asi_model::OperationNetworkId>) -> Vec<RequestView> {
    let mut views = Vec::new();
    for (id, entry) in &books.networks {
        let Some(message) = entry.message.as_ref().filter(|_| network.is_none_or(|wanted| wanted == id)) else {
            continue;
        };
        for (key, operation, request) in message.operation_network.requests() {
            let mut short = operation.clone();
            short.dynamic_data_request_list.clear();
            views.push(RequestView {
                operation: serde_json::to_value(&short).unwrap_or_default(),
                network_name: message.operation_network.name.clone(),
                requester_id: request.requester_id.to_string(),
                recipient_list: request.recipient_list.clone(),
                purpose: request.purpose.clone(),
                description: request.description.clone(),
                update_interval_ms: request
                    .update_interval()
                    .map(|interval| u64::try_from(interval.as_millis()).unwrap_or(u64::MAX)),
                valid_until: request.valid_until,
                received_at: entry.received_at,
                report_name: request.report_data_format.report_name.clone(),
                data_set_writer_id: books.writer_of.get(&key).copied(),
                fields: books.fields_of(&key).map(|(key, field)| FieldView::new(key, field)).collect(),
                key,
            });
        }
    }
    views
}
