//! Inbox: requests of partners.

use asi_model::{
    DateTime, RequestKey,
    messages::MappingState,
    network::{DynamicDataRequest, Operation},
};
use axum::{Json, extract::State};
use connector_state::ConnectorState;
use daemon::web::{ApiPath, ApiQuery, Problem};
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};

use super::{
    context::Api,
    paths::RequestPath,
    problems::Problems,
    roles::{BeforeGate, Viewer},
    view::{REMIND_AFTER, RequestView},
};
use crate::clock::now;

/// Requests per page, and most that a page may ask for.
const PAGE: usize = 200;
/// Longest search text, in characters.
const SEARCH_CHARS_MAX: usize = 200;

/// Filter and page of the inbox.
#[derive(Deserialize, IntoParams)]
#[serde(rename_all = "camelCase")]
#[into_params(parameter_in = Query)]
pub struct InboxQuery {
    /// `nextCursor` of the page before. Requests behind its last one follow, also if others came or
    /// went meanwhile.
    cursor: Option<String>,
    /// Requests per page, at most 200.
    limit: Option<usize>,
    /// Requests with a field in this state: `PENDING`, `MAPPED` or `REFUSED`.
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

/// A page of the inbox, and totals.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct InboxPage {
    /// Requests in the order of their addresses.
    items: Vec<RequestView>,
    /// Cursor of the next page; none on the last.
    next_cursor: Option<String>,
    /// Number of requests that pass the filter.
    count: usize,
    /// Totals over all requests and fields, without the filter.
    totals: InboxTotals,
}

/// Numbers of requests and fields of all active networks, by state.
#[derive(Serialize, ToSchema, Default)]
#[serde(rename_all = "camelCase")]
pub struct InboxTotals {
    requests: usize,
    /// Requests with an undecided field.
    open_requests: usize,
    /// Number of these that are open for longer than the time after which the inbox reminds.
    overdue_requests: usize,
    /// Requests whose validity has ended.
    ended_requests: usize,
    pending: usize,
    mapped: usize,
    refused: usize,
}

/// Lists the requests of all active networks with their fields, filtered, in pages, in the order of
/// their addresses.
#[utoipa::path(
    get,
    path = "/inbox",
    tag = "inbox",
    params(InboxQuery),
    responses((status = 200, body = InboxPage), Problems)
)]
pub async fn list_inbox(
    user: Viewer,
    State(api): State<Api>,
    ApiQuery(query): ApiQuery<InboxQuery>,
) -> Result<Json<InboxPage>, Problem> {
    if query.search.as_ref().is_some_and(|text| text.chars().count() > SEARCH_CHARS_MAX) {
        return Err(Problem::bad_request("INVALID_SEARCH", "A search has at most 200 characters."));
    }
    let after = query.cursor.as_deref().map(serde_json::from_str::<RequestKey>).transpose();
    let after = after.map_err(|_| {
        Problem::bad_request("INVALID_CURSOR", "A cursor is what the page before gave.")
    })?;
    let (now, before_gate) = (now(), user.before_gate());
    let read = move |state: &ConnectorState| page(state, &query, after.as_ref(), now, before_gate);
    Ok(Json(api.coordinator.read(read).await?))
}

/// Scans all requests for the totals, and builds views of those on the page only: the first ones
/// behind `after`.
fn page(
    state: &ConnectorState,
    query: &InboxQuery,
    after: Option<&RequestKey>,
    now: DateTime,
    before_gate: Option<BeforeGate>,
) -> InboxPage {
    let words: Vec<String> =
        query.search.as_deref().unwrap_or("").split_whitespace().map(str::to_lowercase).collect();
    let limit = query.limit.unwrap_or(PAGE).clamp(1, PAGE);
    let mut page = InboxPage {
        items: Vec::new(),
        next_cursor: None,
        count: 0,
        totals: InboxTotals::default(),
    };
    for (network, message) in state
        .networks()
        .iter()
        .map(|(_, network)| network)
        .filter_map(|n| n.message.as_ref().map(|message| (n, message)))
    {
        let is_network =
            |id: &String| message.operation_network.operation_network_id.as_str() == id;
        let mut requests: Vec<_> = message.operation_network.requests().collect();
        requests.sort_unstable_by(|(left, ..), (right, ..)| left.cmp(right));
        for (key, operation, request) in requests {
            let summary = RequestSummary::of(state, &key, request, network.received_at, now);
            summary.add_to(&mut page.totals);
            let is_selected = query.state.is_none_or(|state| summary.count(state) > 0)
                && (!query.is_overdue || summary.is_overdue)
                && query
                    .partner
                    .as_ref()
                    .is_none_or(|partner| request.requester_id.as_str() == partner)
                && query.operation_network_id.as_ref().is_none_or(is_network)
                && has_words(
                    &words,
                    message.operation_network.name.as_deref(),
                    &key,
                    operation,
                    request,
                );
            if !is_selected {
                continue;
            }
            page.count += 1;
            if after.is_some_and(|after| key <= *after) {
                continue;
            }
            if page.items.len() < limit {
                let network = (network, &**message);
                let request = (key, operation, request);
                page.items.push(RequestView::new(state, network, request, now, before_gate));
            } else if page.next_cursor.is_none() {
                let last = page.items.last().map(|last| &last.key);
                page.next_cursor =
                    last.map(|key| serde_json::to_string(key).expect("keys have text members"));
            }
        }
    }
    page
}

/// Numbers of a request's fields by state.
struct RequestSummary {
    pending: usize,
    mapped: usize,
    refused: usize,
    is_overdue: bool,
    has_ended: bool,
}

impl RequestSummary {
    fn of(
        state: &ConnectorState,
        key: &RequestKey,
        request: &DynamicDataRequest,
        received_at: DateTime,
        now: DateTime,
    ) -> Self {
        let (mut pending, mut mapped, mut refused) = (0, 0, 0);
        for (_, field) in state.fields_in(key, request) {
            match field.decision().mapping_state {
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

/// Shows one request of an active network with its fields.
#[utoipa::path(
    get,
    path = "/requests/{operationNetworkId}/{operationId}/{dynamicDataRequestId}",
    tag = "inbox",
    params(RequestPath),
    responses((status = 200, body = RequestView), Problems)
)]
pub async fn show_request(
    user: Viewer,
    State(api): State<Api>,
    ApiPath(path): ApiPath<RequestPath>,
) -> Result<Json<RequestView>, Problem> {
    let (key, before_gate) = (path.into_key(), user.before_gate());
    let view =
        api.coordinator.read(move |state| RequestView::of(state, &key, now(), before_gate)).await?;
    view.map(Json).ok_or_else(|| Problem::not_found("such request"))
}

#[cfg(test)]
mod tests {
    use asi_model::messages::OperationNetworkMessage;
    use connector_state::scene::{Scene, at};
    use serde_json::{Value, json};

    use super::*;

    /// A network with requests of `fields` fields each.
    fn network_of(
        number: u64,
        revision: u64,
        requests: &[String],
        fields: usize,
    ) -> OperationNetworkMessage {
        let requests: Vec<Value> = requests
            .iter()
            .enumerate()
            .map(|(index, id)| {
                let fields: Vec<Value> = (0..fields)
                    .map(|field| json!({ "name": format!("field{field}"), "type": 11 }))
                    .collect();
                json!({ "dynamicDataRequestId": id, "requesterId": format!("org{}", index % 7),
                    "recipientList": [format!("org{}", index % 7)], "purpose": format!("Plan {id}"),
                    "reportDataFormat": { "reportName": "Progress", "reportFieldList": fields } })
            })
            .collect();
        let message = json!({ "messageId": format!("large-{number}-{revision}"), "factoryId": "F",
            "collaborationId": "c", "revision": revision,
            "operationNetwork": { "operationNetworkId": format!("large-{number:02}"),
                "operationList": [{ "operationId": "op", "operationType": "PRODUCTION",
                    "dynamicDataRequestList": requests }] } });
        serde_json::from_value(message).expect("a network")
    }

    /// Networks with `requests` requests of `fields` fields each, and one more request.
    fn inbox(networks: u64, requests: usize, fields: usize) -> Scene {
        let mut scene = Scene::default();
        let requests: Vec<String> = (0..requests).map(|request| format!("R{request}")).collect();
        for network in 0..networks {
            scene.arrive(network_of(network, 1, &requests, fields));
        }
        scene
    }

    fn query(json: Value) -> InboxQuery {
        serde_json::from_value(json).expect("a query")
    }

    fn first(scene: &Scene, filter: Value, now: DateTime) -> InboxPage {
        page(&scene.state, &query(filter), None, now, None)
    }

    /// Every page, from the first on; `between` happens after each.
    fn pages(
        scene: &mut Scene,
        limit: usize,
        mut between: impl FnMut(&mut Scene),
    ) -> Vec<RequestKey> {
        let (mut keys, mut after) = (Vec::new(), None);
        loop {
            let found =
                page(&scene.state, &query(json!({ "limit": limit })), after.as_ref(), at(0), None);
            keys.extend(found.items.into_iter().map(|request| request.key));
            let Some(cursor) = found.next_cursor else { return keys };
            after = Some(serde_json::from_str(&cursor).expect("a cursor"));
            between(scene);
        }
    }

    #[test]
    fn pages_and_filters_hold_for_two_thousand_requests() {
        let scene = inbox(20, 100, 10);
        let found = first(&scene, json!({ "limit": 50 }), at(0));
        assert_eq!((found.count, found.items.len()), (2001, 50));
        assert_eq!(found.totals.requests, 2001);
        assert_eq!(found.totals.pending, 20_002);
        assert_eq!(found.totals.overdue_requests, 0);
        let check = |json: Value, expected: usize| {
            assert_eq!(first(&scene, json.clone(), at(0)).count, expected, "{json}")
        };
        check(json!({ "operationNetworkId": "large-07" }), 100);
        check(json!({ "partner": "org3" }), 280);
        check(json!({ "search": "LARGE-07 plan field9" }), 100);
        check(json!({ "search": "note" }), 1);
        check(json!({ "state": "MAPPED" }), 0);
        check(json!({ "isOverdue": true }), 0);
        let tomorrow = first(&scene, json!({ "isOverdue": true, "limit": 1 }), at(25 * 3_600_000));
        assert_eq!((tomorrow.count, tomorrow.items[0].is_overdue), (2001, true));
    }

    #[test]
    fn every_request_is_on_one_page() {
        let keys = pages(&mut inbox(6, 20, 1), 7, |_| {});
        assert_eq!(keys.len(), 121);
        assert!(keys.is_sorted_by(|left, right| left < right), "once each");
    }

    #[test]
    fn nothing_is_skipped_or_doubled_while_requests_come_and_go() {
        let mut scene = inbox(6, 20, 1);
        let lasting = pages(&mut scene, 200, |_| {});
        let lasting: Vec<RequestKey> = lasting
            .into_iter()
            .filter(|key| key.dynamic_data_request_id.as_str() != "R12")
            .collect();
        let mut round = 0_u64;
        let found = pages(&mut scene, 7, |scene| {
            // In the network where the page ended and in the next one, one request goes, others come
            // first, and the order of the others is reversed.
            round += 1;
            let here = round * 7 / 20;
            for network in [here, here + 1].into_iter().filter(|network| *network < 6) {
                let kept =
                    (0..20).rev().filter(|number| *number != 12).map(|number| format!("R{number}"));
                let requests: Vec<String> =
                    (0..5).map(|new| format!("New{new}-{round}")).chain(kept).collect();
                scene.arrive(network_of(network, round + 1, &requests, 1));
            }
        });
        assert!(found.is_sorted_by(|left, right| left < right), "nothing is doubled");
        let missed: Vec<&RequestKey> = lasting.iter().filter(|key| !found.contains(key)).collect();
        assert_eq!(missed, Vec::<&RequestKey>::new());
    }
}
