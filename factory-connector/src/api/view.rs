//! Views of requests and fields.

use std::time::Duration;

use asi_model::{
    DateTime, FieldKey, RequestKey,
    messages::{MappingState, OperationNetworkMessage},
    network::{DynamicDataRequest, Operation},
};
use connector_state::{ConnectorState, Field, Network, queries, queries::RuleOffer};
use disclosure::{
    DecisionBasis, DisclosurePolicy, DocumentVersion, RuleAction, Statement, StatementPart,
};
use serde::Serialize;
use utoipa::ToSchema;

use super::{roles::BeforeGate, values::ShownValue};
use crate::clock::now;

/// A page of a list.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct Page<T> {
    pub items: Vec<T>,
    /// Cursor of the next page; none on the last.
    pub next_cursor: Option<String>,
}

impl<T> Page<T> {
    /// Returns a page of at most `limit` items. A full one has the cursor of its last item, since
    /// another page may follow.
    pub fn of(items: Vec<T>, limit: u32, cursor: impl Fn(&T) -> String) -> Self {
        let is_full = items.len() >= limit as usize;
        let next_cursor = items.last().filter(|_| is_full).map(cursor);
        Self { items, next_cursor }
    }

    /// Returns a whole list as its only page.
    pub const fn whole(items: Vec<T>) -> Self {
        Self { items, next_cursor: None }
    }
}

/// A requested field with its decision and value.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct FieldView {
    pub key: FieldKey,
    pub name: String,
    /// Name of the built-in type.
    #[serde(rename = "type")]
    pub field_type: String,
    /// -1 scalar, 1 array.
    pub value_rank: i32,
    /// Unit in the words of the request.
    pub unit: Option<String>,
    /// Meaning: a well-known name or an IRI.
    pub semantic: Option<String>,
    pub description: Option<String>,
    /// `PENDING`, `MAPPED` or `REFUSED`.
    pub mapping_state: asi_model::messages::MappingState,
    /// `MAPPING`, `MANUAL` or `EXTERNAL`, while mapped.
    pub value_source: Option<asi_model::messages::ValueSource>,
    /// Coarsening of values as decided.
    pub disclosure: DisclosurePolicy,
    /// Coarsening in effect: the strictest of that, of the named policy and of the recipients'
    /// policies.
    pub effective_disclosure: DisclosurePolicy,
    /// Named policy and rules that the decision is based on.
    #[serde(rename = "grounds")]
    pub basis: DecisionBasis,
    /// Decision that the standing rules offer for a pending field.
    pub offer: Option<RuleOfferView>,
    /// True while no value leaves: the policy withholds the present state, or an unknown one. For
    /// operators and engineers only, since it says which state it is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub is_withheld: Option<bool>,
    /// Coarsening in effect in words, as in the statement to the partner.
    pub disclosure_statement: Option<String>,
    /// Coarsening in effect as codes with parameters; none while pending.
    pub disclosure_parts: Vec<StatementPart>,
    pub decision_reason: Option<String>,
    /// Name of the person or rule that decided.
    pub decided_by: Option<String>,
    pub decision_time: Option<DateTime>,
    /// Newest disclosed value, which the partner has.
    pub value: Option<ShownValue>,
    /// Published mapping, or the former one of a field that is not mapped.
    pub mapping: Option<mapping_engine::Mapping>,
    /// Number of the newest version of the mapping; none before the first.
    pub mapping_version: Option<u32>,
    /// True while a shadow mapping runs beside the published one.
    pub has_shadow: bool,
    /// Tag of what a decision rests on: differs after each decision and each change of the request.
    pub shown_tag: Option<String>,
}

impl FieldView {
    /// Returns the view of a field at present.
    pub fn new(
        state: &ConnectorState,
        key: FieldKey,
        field: &Field,
        before_gate: Option<BeforeGate>,
    ) -> Self {
        let (definition, decision) = (field.definition(), field.decision());
        let statement = decision
            .is_mapped()
            .then(|| Statement::of(field.gate().policy(), definition.unit.as_deref()));
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
            effective_disclosure: (**field.gate().policy()).clone(),
            basis: decision.basis.clone(),
            offer: (decision.mapping_state == asi_model::messages::MappingState::Pending)
                .then(|| queries::rule_offer(state, &key, now()))
                .flatten()
                .map(|offer| RuleOfferView::new(&offer, field)),
            is_withheld: before_gate.map(|_| decision.is_mapped() && field.gate().is_withheld()),
            disclosure_statement: statement.as_ref().map(|stated| stated.statement.clone()),
            disclosure_parts: statement.map(|stated| stated.statement_parts).unwrap_or_default(),
            decision_reason: decision.reason.clone(),
            decided_by: decision.decided_by.clone(),
            decision_time: decision.decided_at,
            value: field.gate().disclosed().map(ShownValue::from),
            mapping: decision.mapping.as_deref().cloned(),
            mapping_version: (field.versions().newest > 0).then_some(field.versions().newest),
            has_shadow: field.versions().shadow.is_some(),
            shown_tag: queries::shown_tag(state, &key),
            key,
        }
    }
}

/// Decision about a field that standing rules offer.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct RuleOfferView {
    pub action: RuleAction,
    /// Rules, the one that gives reason and source first.
    pub rules: Vec<RuleReference>,
    /// Coarsening of values.
    pub disclosure: DisclosurePolicy,
    /// Coarsening in words and as codes.
    #[serde(flatten)]
    pub statement: Statement,
    /// `MAPPING`, `MANUAL` or `EXTERNAL`.
    pub value_source: Option<asi_model::messages::ValueSource>,
    /// Mapping, with the source `MAPPING`.
    pub mapping: Option<mapping_engine::Mapping>,
    /// Reason that the partner would read.
    pub reason: Option<String>,
}

/// A version of a rule, with its name.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct RuleReference {
    #[serde(flatten)]
    pub key: DocumentVersion,
    pub name: String,
}

impl RuleOfferView {
    /// Returns the view of an offer for a field.
    pub fn new(offer: &RuleOffer, field: &Field) -> Self {
        Self {
            action: offer.action,
            rules: offer
                .rules
                .iter()
                .map(|(key, name)| RuleReference { key: key.clone(), name: name.clone() })
                .collect(),
            disclosure: (*offer.disclosure).clone(),
            statement: Statement::of(&offer.disclosure, field.definition().unit.as_deref()),
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
    pub key: RequestKey,
    /// Operation that it is about, without requests.
    pub operation: Operation,
    pub network_name: Option<String>,
    /// Organisation that asks.
    pub requester_id: String,
    /// Organisations that get the values.
    pub recipient_list: Vec<asi_model::OrganisationId>,
    /// Purpose in the requester's words.
    pub purpose: String,
    pub description: Option<String>,
    /// Requested time between two reports, in milliseconds.
    pub update_interval_ms: Option<u64>,
    /// Begin of the requested period.
    pub valid_from: Option<DateTime>,
    /// End of the requested period.
    pub valid_until: Option<DateTime>,
    /// True after that period: no value leaves any more.
    pub has_ended: bool,
    /// Arrival of this revision of the network.
    pub received_at: DateTime,
    /// Time since which it waits for an engineer; none if no field is pending.
    pub open_since: Option<DateTime>,
    /// True after a day of waiting.
    pub is_overdue: bool,
    pub report_name: String,
    /// DataSetWriter of its reports; none before the first decision.
    pub data_set_writer_id: Option<u16>,
    pub fields: Vec<FieldView>,
}

/// Time after which the inbox reminds of an open request: a day.
pub const REMIND_AFTER: Duration = Duration::from_secs(24 * 3600);

/// Returns every request of a network, in the order of the document.
pub fn requests(
    state: &ConnectorState,
    network: &asi_model::OperationNetworkId,
    now: DateTime,
    before_gate: Option<BeforeGate>,
) -> Vec<RequestView> {
    let Some((network, message)) =
        state.networks().get(network).and_then(|n| n.message.as_ref().map(|m| (n, m)))
    else {
        return Vec::new();
    };
    let requests = message.operation_network.requests();
    requests
        .map(|(key, operation, request)| {
            RequestView::new(state, (network, message), (key, operation, request), now, before_gate)
        })
        .collect()
}

impl RequestView {
    /// Returns the view of a request of an active network; none if there is no such request.
    pub fn of(
        state: &ConnectorState,
        key: &RequestKey,
        now: DateTime,
        before_gate: Option<BeforeGate>,
    ) -> Option<Self> {
        let network = state.networks().get(&key.operation_network_id)?;
        let message = network.message.as_ref()?;
        let (key, operation, request) =
            message.operation_network.requests().find(|(known, ..)| known == key)?;
        Some(Self::new(state, (network, message), (key, operation, request), now, before_gate))
    }

    /// Returns the view of a request at `now`.
    pub fn new(
        state: &ConnectorState,
        (network, message): (&Network, &OperationNetworkMessage),
        (key, operation, request): (RequestKey, &Operation, &DynamicDataRequest),
        now: DateTime,
        before_gate: Option<BeforeGate>,
    ) -> Self {
        let mut short = operation.clone();
        short.dynamic_data_request_list.clear();
        let fields: Vec<FieldView> = state
            .fields_in(&key, request)
            .map(|(key, field)| FieldView::new(state, key, field, before_gate))
            .collect();
        let is_open = fields.iter().any(|field| field.mapping_state == MappingState::Pending);
        let has_ended = request.valid_until.is_some_and(|until| until <= now);
        let open_since = Some(network.received_at).filter(|_| is_open && !has_ended);
        Self {
            operation: short,
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
            data_set_writer_id: state.writers().id_of(&key),
            fields,
            key,
        }
    }
}
