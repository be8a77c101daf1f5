//! What partners ask.

use asi_model::{
    DateTime, FieldKey, OperationNetworkId, RequestKey,
    difference::{NetworkDifference, difference},
    messages::MappingState,
    network::{DynamicDataRequest, Operation, OperationNetwork},
};
use axum::{Json, extract::State};
use daemon::web::{ApiPath, ApiQuery, Problem};
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};

use super::{
    Api,
    problems::Problems,
    view::{Page, REMIND_AFTER, RequestView, requests},
};
use crate::{books::Books, desk::now, store::revisions};

/// Requests per page, and most that a page may ask for.
const PAGE: usize = 200;
/// Longest text to look for, in characters.
const SEARCH_CHARS_MAX: usize = 200;

/// Which requests, and which page of them.
#[derive(Deserialize, IntoParams)]
#[serde(rename_all = "camelCase")]
#[into_params(parameter_in = Query)]
pub struct InboxQuery {
    /// `nextCursor` of the page before.
    cursor: Option<usize>,
    /// Requests per page, at most 200.
    limit: Option<usize>,
    /// Requests with a field in this state: `PENDING`, `MAPPED` or `REFUSED`.
    #[param(value_type = Option<String>)]
    state: Option<asi_model::messages::MappingState>,
    /// Requests of this requester.
    partner: Option<String>,
    /// Requests of this network.
    operation_network_id: Option<String>,
    /// Requests in whose ids, names, purpose, fields or partners all these words occur.
    search: Option<String>,
    /// Requests that have been open for longer than the time after which the inbox reminds.
    #[serde(default)]
    is_overdue: bool,
}

/// A page of the inbox, and how many there are.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct InboxPage {
    /// The requests.
    items: Vec<RequestView>,
    /// Where the next page begins; none on the last.
    next_cursor: Option<String>,
    /// Requests that the query means.
    count: usize,
    /// All requests and fields, whatever the query.
    totals: InboxTotals,
}

/// How the fields of all active networks stand.
#[derive(Serialize, ToSchema, Default)]
#[serde(rename_all = "camelCase")]
pub struct InboxTotals {
    /// Requests.
    requests: usize,
    /// Requests with an undecided field.
    open_requests: usize,
    /// Of them, those that have been open for longer than the time after which the inbox reminds.
    overdue_requests: usize,
    /// Requests whose validity has ended.
    ended_requests: usize,
    /// Undecided fields.
    pending: usize,
    /// Fields whose values flow.
    mapped: usize,
    /// Refused fields.
    refused: usize,
}

/// Lists the requests of all active networks with their fields, filtered, in pages.
#[utoipa::path(get, path = "/inbox", tag = "inbox", security(("session" = [])), params(InboxQuery),
    responses((status = 200, body = InboxPage), Problems))]
pub async fn list(State(api): State<Api>, ApiQuery(query): ApiQuery<InboxQuery>) -> Result<Json<InboxPage>, Problem> {
    if query.search.as_ref().is_some_and(|text| text.chars().count() > SEARCH_CHARS_MAX) {
        return Err(Problem::bad_request("INVALID_SEARCH", "A search has at most 200 characters."));
    }
    let now = now();
    Ok(Json(api.desk.read(move |books| page(books, &query, now)).await?))
}

/// Everything is looked at, but only what is on the page is written out.
fn page(books: &Books, query: &InboxQuery, now: DateTime) -> InboxPage {
    let words: Vec<String> = query.search.as_deref().unwrap_or("").split_whitespace().map(str::to_lowercase).collect();
    let from = query.cursor.unwrap_or(0);
    let limit = query.limit.unwrap_or(PAGE).clamp(1, PAGE);
    let mut page = InboxPage { items: Vec::new(), next_cursor: None, count: 0, totals: InboxTotals::default() };
    for (network, message) in books.networks.values().filter_map(|n| n.message.as_ref().map(|message| (n, message))) {
        let is_network = |wanted: &String| message.operation_network.operation_network_id.as_str() == wanted;
        for (key, operation, request) in message.operation_network.requests() {
            let standing = Standing::of(books, &key, request, network.received_at, now);
            standing.add_to(&mut page.totals);
            let is_meant = query.state.is_none_or(|state| standing.count(state) > 0)
                && (!query.is_overdue || standing.is_overdue)
                && query.partner.as_ref().is_none_or(|partner| request.requester_id.as_str() == partner)
                && query.operation_network_id.as_ref().is_none_or(is_network)
                && has_words(&words, message.operation_network.name.as_deref(), &key, operation, request);
            if !is_meant {
                continue;
            }
            if page.count >= from && page.items.len() < limit {
                page.items.push(RequestView::new(books, network, message, key, operation, request, now));
            }
            page.count += 1;
        }
    }
    page.next_cursor = (page.count > from + page.items.len()).then(|| (from + page.items.len()).to_string());
    page
}

/// How the fields of a request stand.
struct Standing {
    pending: usize,
    mapped: usize,
    refused: usize,
    is_overdue: bool,
    has_ended: bool,
}

impl Standing {
    fn of(books: &Books, key: &RequestKey, request: &DynamicDataRequest, received_at: DateTime, now: DateTime) -> Self {
        let (mut pending, mut mapped, mut refused) = (0, 0, 0);
        for (_, field) in books.fields_in(key, request) {
            match field.decision.mapping_state {
                MappingState::Pending => pending += 1,
                MappingState::Mapped => mapped += 1,
                MappingState::Refused => refused += 1,
            }
        }
        let has_ended = request.valid_until.is_some_and(|until| until <= now);
        let is_overdue = pending > 0 && !has_ended && now.since(received_at) >= REMIND_AFTER;
        Self { pending, mapped, refused, is_overdue, has_ended }
    }

    const fn count(&self, state: MappingState) -> usize {
        match state {
            MappingState::Pending => self.pending,
            MappingState::Mapped => self.mapped,
            MappingState::Refused => self.refused,
        }
    }

    fn add_to(&self, totals: &mut InboxTotals) {
        totals.requests += 1;
        totals.open_requests += usize::from(self.pending > 0 && !self.has_ended);
        totals.overdue_requests += usize::from(self.is_overdue);
        totals.ended_requests += usize::from(self.has_ended);
        totals.pending += self.pending;
        totals.mapped += self.mapped;
        totals.refused += self.refused;
    }
}

fn has_words(
    words: &[String],
    network_name: Option<&str>,
    key: &RequestKey,
    operation: &Operation,
    request: &DynamicDataRequest,
) -> bool {
    if words.is_empty() {
        return true;
    }
    let mut text = format!(
        "{}\n{}\n{}\n{}\n{}\n{}\n{}",
        key.operation_network_id,
        key.operation_id,
        key.dynamic_data_request_id,
        network_name.unwrap_or(""),
        operation.name.as_deref().unwrap_or(""),
        request.requester_id,
        request.purpose,
    );
    for field in &request.report_data_format.report_field_list {
        text.push('\n');
        text.push_str(field.name.as_str());
    }
    for recipient in &request.recipient_list {
        text.push('\n');
        text.push_str(recipient.as_str());
    }
    let text = text.to_lowercase();
    words.iter().all(|word| text.contains(word.as_str()))
}

/// A network in short.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct NetworkSummary {
    operation_network_id: String,
    name: Option<String>,
    collaboration_id: Option<String>,
    revision: u64,
    is_withdrawn: bool,
    #[schema(value_type = String, format = "date-time")]
    received_at: asi_model::DateTime,
    request_count: usize,
    field_count: usize,
    pending_count: usize,
}

/// Lists all networks, withdrawn ones included.
#[utoipa::path(get, path = "/operation-networks", tag = "inbox", security(("session" = [])),
    responses((status = 200, body = Page<NetworkSummary>), Problems))]
pub async fn networks(State(api): State<Api>) -> Result<Json<Page<NetworkSummary>>, Problem> {
    let items = api
        .desk
        .read(|books| {
            let summary = |(id, network): (&OperationNetworkId, &crate::books::Network)| {
                let document = network.message.as_ref().map(|message| &message.operation_network);
                let fields = || document.into_iter().flat_map(|document| document.fields());
                let is_pending = |key: &FieldKey| {
                    books.field(key).is_some_and(|field| field.decision.mapping_state == MappingState::Pending)
                };
                NetworkSummary {
                    operation_network_id: id.to_string(),
                    name: network.message.as_ref().and_then(|message| message.operation_network.name.clone()),
                    collaboration_id: network.message.as_ref().map(|message| message.collaboration_id.to_string()),
                    revision: network.revision,
                    is_withdrawn: network.message.is_none(),
                    received_at: network.received_at,
                    request_count: document.map_or(0, |document| document.requests().count()),
                    field_count: fields().count(),
                    pending_count: fields().filter(|(key, ..)| is_pending(key)).count(),
                }
            };
            books.networks.iter().map(summary).collect()
        })
        .await?;
    Ok(Json(Page::whole(items)))
}

/// A network with its requests.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct NetworkView {
    /// The message as received; none once withdrawn.
    #[schema(value_type = Option<Object>)]
    message: Option<serde_json::Value>,
    /// Its revision.
    revision: u64,
    /// Its requests.
    requests: Vec<RequestView>,
}

/// Shows a network as received, and how its fields stand.
#[utoipa::path(get, path = "/operation-networks/{operationNetworkId}", tag = "inbox", security(("session" = [])),
    params(("operationNetworkId" = String, Path)), responses((status = 200, body = NetworkView), Problems))]
pub async fn network(
    State(api): State<Api>,
    ApiPath(id): ApiPath<OperationNetworkId>,
) -> Result<Json<NetworkView>, Problem> {
    let wanted = id.clone();
    let view = api
        .desk
        .read(move |books| {
            books.networks.get(&wanted).map(|network| NetworkView {
                message: network.message.as_ref().and_then(|message| serde_json::to_value(&**message).ok()),
                revision: network.revision,
                requests: requests(books, &wanted, now()),
            })
        })
        .await?;
    view.map(Json).ok_or_else(|| Problem::not_found(format_args!("operation network {id}")))
}

/// What the revision in force changed.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct NetworkNews {
    /// The revision in force.
    revision: u64,
    /// The one before it, where there was one.
    previous_revision: Option<u64>,
    /// What differs: operations, relations, requests, and each field with the reasons and with what became of its mapping
    /// and of the consent.
    #[schema(value_type = Object)]
    difference: NetworkDifference,
}

/// What is new in a network against the revision before.
#[utoipa::path(get, path = "/operation-networks/{operationNetworkId}/news", tag = "inbox", security(("session" = [])),
    params(("operationNetworkId" = String, Path)), responses((status = 200, body = NetworkNews), Problems))]
pub async fn news(
    State(api): State<Api>,
    ApiPath(id): ApiPath<OperationNetworkId>,
) -> Result<Json<NetworkNews>, Problem> {
    let found = revisions(&api.readers, &id).await?;
    let found = found.ok_or_else(|| Problem::not_found(format_args!("operation network {id}")))?;
    let nothing = OperationNetwork {
        operation_network_id: id,
        name: None,
        description: None,
        operation_list: Vec::new(),
        operation_relation_list: Vec::new(),
    };
    let before = found.previous.as_ref().map_or(&nothing, |message| &message.operation_network);
    Ok(Json(NetworkNews {
        revision: found.current.revision,
        previous_revision: found.previous.as_ref().map(|message| message.revision),
        difference: difference(before, &found.current.operation_network),
    }))
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::*;
    use crate::books::tests::{arrive, at, books};

    /// Twenty networks with a hundred requests of ten fields each.
    fn large() -> Books {
        let mut books = books();
        for network in 0..20 {
            let requests: Vec<Value> = (0..100)
                .map(|request| {
                    let fields: Vec<Value> =
                        (0..10).map(|field| json!({ "name": format!("field{field}"), "type": 11 })).collect();
                    json!({ "dynamicDataRequestId": format!("R{request}"), "requesterId": format!("org{}", request % 7),
                        "recipientList": [format!("org{}", request % 7)], "purpose": format!("Plan {request}"),
                        "reportDataFormat": { "reportName": "Progress", "reportFieldList": fields } })
                })
                .collect();
            let message = json!({ "messageId": format!("large-{network}"), "factoryId": "F", "collaborationId": "c",
                "revision": 1, "operationNetwork": { "operationNetworkId": format!("large-{network:02}"),
                    "operationList": [{ "operationId": "op", "operationType": "PRODUCTION",
                        "dynamicDataRequestList": requests }] } });
            arrive(&mut books, serde_json::from_value(message).expect("a network"));
        }
        books
    }

    fn query(json: Value) -> InboxQuery {
        serde_json::from_value(json).expect("a query")
    }

    #[test]
    fn pages_and_filters_hold_for_two_thousand_requests() {
        let books = large();
        let first = page(&books, &query(json!({ "limit": 50 })), at(0));
        assert_eq!((first.count, first.items.len(), first.next_cursor.as_deref()), (2001, 50, Some("50")));
        assert_eq!((first.totals.requests, first.totals.pending, first.totals.overdue_requests), (2001, 20_002, 0));
        let last = page(&books, &query(json!({ "cursor": 2000 })), at(0));
        assert_eq!((last.items.len(), last.next_cursor), (1, None));
        let check = |json: Value, expected: usize| {
            assert_eq!(page(&books, &query(json.clone()), at(0)).count, expected, "{json}")
        };
        check(json!({ "operationNetworkId": "large-07" }), 100);
        check(json!({ "partner": "org3" }), 280);
        check(json!({ "search": "LARGE-07 plan field9" }), 100);
        check(json!({ "search": "note" }), 1);
        check(json!({ "state": "MAPPED" }), 0);
        check(json!({ "isOverdue": true }), 0);
        let tomorrow = page(&books, &query(json!({ "isOverdue": true, "limit": 1 })), at(25 * 3_600_000));
        assert_eq!((tomorrow.count, tomorrow.items[0].is_overdue), (2001, true));
    }
}
