//! Requests and fields as pages show them.

use disclosure::DecisionBasis;
use std::time::Duration;

use asi_model::{
    DateTime, FieldKey, RequestKey,
    messages::{MappingState, OperationNetworkMessage},
    network::{DynamicDataRequest, Operation},
};
use serde::Serialize;
use utoipa::ToSchema;

use crate::{
    books::{Books, Field, Network, RuleOffer},
    values::ShownValue,
};
use disclosure::{DisclosurePolicy, DocumentVersion, RuleAction, Statement, StatementPart};

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
    /// A page of at most `limit` items; a full one may have another behind it, which begins after
    /// the last item.
    pub fn of(items: Vec<T>, limit: u32, cursor: impl Fn(&T) -> String) -> Self {
        let is_full = items.len() >= limit as usize;
        let next_cursor = items.last().filter(|_| is_full).map(cursor);
        Self { items, next_cursor }
    }

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
    pub mapping_state: asi_model::messages::MappingState,
    /// `MAPPING`, `MANUAL` or `EXTERNAL`, while mapped.
    pub value_source: Option<asi_model::messages::ValueSource>,
    /// How values are coarsened at least, as decided.
    pub disclosure: DisclosurePolicy,
    /// How they are coarsened: the strictest of that, of the named policy and of the recipients'
    /// policies.
    pub effective_disclosure: DisclosurePolicy,
    /// The named policy and the rules on whose grounds it was decided.
    pub grounds: DecisionBasis,
    /// What the standing rules offer for an undecided field.
    pub offer: Option<RuleOfferView>,
    /// Nothing leaves at present: the policy withholds the present state, or one that is not known.
    pub is_withheld: bool,
    /// The same in words, as the partner is told.
    pub disclosure_statement: Option<String>,
    /// The same as codes with parameters; none while undecided.
    pub disclosure_parts: Vec<StatementPart>,
    /// Why it was decided so.
    pub decision_reason: Option<String>,
    /// Who decided.
    pub decided_by: Option<String>,
    /// When.
    pub decision_time: Option<DateTime>,
    /// The newest disclosed value: what the partner has.
    pub value: Option<ShownValue>,
    /// The mapping in force, or the one to offer again.
    pub mapping: Option<mapping_engine::Mapping>,
    /// The number of the newest version of the mapping; none before the first.
    pub mapping_version: Option<u32>,
    /// A mapping is on trial beside the published one.
    pub has_shadow: bool,
}

impl FieldView {
    /// As it stands.
    pub fn new(books: &Books, key: FieldKey, field: &Field) -> Self {
        let (definition, decision) = (&field.definition, &field.decision);
        let told = decision
            .is_mapped()
            .then(|| Statement::of(field.gate.policy(), definition.unit.as_deref()));
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
            effective_disclosure: (**field.gate.policy()).clone(),
            grounds: decision.grounds.clone(),
            offer: (decision.mapping_state == asi_model::messages::MappingState::Pending)
                .then(|| books.rule_offer(&key))
                .flatten()
                .map(|offer| RuleOfferView::new(&offer, field)),
            is_withheld: decision.is_mapped() && field.gate.is_withheld(),
            disclosure_statement: told.as_ref().map(|told| told.statement.clone()),
            disclosure_parts: told.map(|told| told.statement_parts).unwrap_or_default(),
            decision_reason: decision.reason.clone(),
            decided_by: decision.decided_by.clone(),
            decision_time: decision.decided_at,
            value: field.gate.disclosed().map(ShownValue::from),
            mapping: decision.mapping.as_deref().cloned(),
            mapping_version: (field.shelf.version > 0).then_some(field.shelf.version),
            has_shadow: field.shelf.shadow.is_some(),
            key,
        }
    }
}

/// What standing rules say about a field.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct RuleOfferView {
    /// What they come to.
    pub action: RuleAction,
    /// The rules, the one that gives reason and source first.
    pub rules: Vec<RuleReference>,
    /// The precision.
    pub disclosure: DisclosurePolicy,
    /// The same in words.
    #[serde(flatten)]
    pub told: Statement,
    /// Where values would come from.
    pub value_source: Option<asi_model::messages::ValueSource>,
    /// The mapping, with the source `MAPPING`.
    pub mapping: Option<mapping_engine::Mapping>,
    /// What the partner would be told.
    pub reason: Option<String>,
}

/// A rule by name.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct RuleReference {
    /// Which, in which version.
    #[serde(flatten)]
    pub key: DocumentVersion,
    /// What it is called.
    pub name: String,
}

impl RuleOfferView {
    /// For a field.
    pub fn new(offer: &RuleOffer, field: &Field) -> Self {
        Self {
            action: offer.action,
            rules: offer
                .rules
                .iter()
                .map(|(key, name)| RuleReference { key: key.clone(), name: name.clone() })
                .collect(),
            disclosure: (*offer.disclosure).clone(),
            told: Statement::of(&offer.disclosure, field.definition.unit.as_deref()),
            value_source: offer.value_source,
            mapping: offer.mapping.clone(),
            reason: offer.reason.clone(),
        }
    }
}

/// A request of a partner.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct RequestView {
    /// Its address.
    pub key: RequestKey,
    /// The operation it asks about, without its requests.
    #[schema(value_type = Object)]
    pub operation: serde_json::Value,
    /// What the network is called.
    pub network_name: Option<String>,
    /// Who asks.
    pub requester_id: String,
    /// Who may see the answers.
    pub recipient_list: Vec<asi_model::OrganisationId>,
    /// What for.
    pub purpose: String,
    /// More about it.
    pub description: Option<String>,
    /// How often the partner wants to hear, as the time between two reports in milliseconds.
    pub update_interval_ms: Option<u64>,
    /// From when values are asked for.
    pub valid_from: Option<DateTime>,
    /// Until when.
    pub valid_until: Option<DateTime>,
    /// That time is over: nothing leaves any more.
    pub has_ended: bool,
    /// When this revision came.
    pub received_at: DateTime,
    /// Since when it waits for an engineer, while a field of it is undecided.
    pub open_since: Option<DateTime>,
    /// It has waited for more than a day.
    pub is_overdue: bool,
    /// What the report is called.
    pub report_name: String,
    /// Its DataSetWriter.
    pub data_set_writer_id: Option<u16>,
    /// Its fields.
    pub fields: Vec<FieldView>,
}

/// How long a request may lie open before the inbox reminds of it: a working day.
pub const REMIND_AFTER: Duration = Duration::from_secs(24 * 3600);

/// Every request of a network, in document order.
pub fn requests(
    books: &Books,
    network: &asi_model::OperationNetworkId,
    now: DateTime,
) -> Vec<RequestView> {
    let Some((network, message)) =
        books.networks.get(network).and_then(|n| n.message.as_ref().map(|m| (n, m)))
    else {
        return Vec::new();
    };
    let requests = message.operation_network.requests();
    requests
        .map(|(key, operation, request)| {
            RequestView::new(books, network, message, key, operation, request, now)
        })
        .collect()
}

impl RequestView {
    /// One of an active network; none where nobody asks, or no more.
    pub fn of(books: &Books, key: &RequestKey, now: DateTime) -> Option<Self> {
        let network = books.networks.get(&key.operation_network_id)?;
        let message = network.message.as_ref()?;
        let (key, operation, request) =
            message.operation_network.requests().find(|(known, ..)| known == key)?;
        Some(Self::new(books, network, message, key, operation, request, now))
    }

    /// As it stands.
    pub fn new(
        books: &Books,
        network: &Network,
        message: &OperationNetworkMessage,
        key: RequestKey,
        operation: &Operation,
        request: &DynamicDataRequest,
        now: DateTime,
    ) -> Self {
        let mut short = operation.clone();
        short.dynamic_data_request_list.clear();
        let fields: Vec<FieldView> = books
            .fields_in(&key, request)
            .map(|(key, field)| FieldView::new(books, key, field))
            .collect();
        let is_open = fields.iter().any(|field| field.mapping_state == MappingState::Pending);
        let has_ended = request.valid_until.is_some_and(|until| until <= now);
        let open_since = Some(network.received_at).filter(|_| is_open && !has_ended);
        Self {
            operation: serde_json::to_value(&short).unwrap_or_default(),
            network_name: message.operation_network.name.clone(),
            requester_id: request.requester_id.to_string(),
            recipient_list: request.recipient_list.clone(),
            purpose: request.purpose.clone(),
            description: request.description.clone(),
            update_interval_ms: request
                .update_interval()
                .map(|interval| u64::try_from(interval.as_millis()).unwrap_or(u64::MAX)),
            valid_from: request.valid_from,
            valid_until: request.valid_until,
            has_ended,
            received_at: network.received_at,
            open_since,
            is_overdue: open_since.is_some_and(|since| now.since(since) >= REMIND_AFTER),
            report_name: request.report_data_format.report_name.clone(),
            data_set_writer_id: books.writer_of.get(&key).copied(),
            fields,
            key,
        }
    }
}
