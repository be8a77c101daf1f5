//! Live notifications.

use axum::{extract::State, http::HeaderMap, response::Response};
use daemon::web::{
    ApiQuery,
    events::{ServerSentEvent, last_event_id},
    session::SignedIn,
};
use serde::Deserialize;
use utoipa::IntoParams;

use super::problems::ReadProblems;
use crate::{application::Application, live::LiveEvent, principal::Principal};

/// Id of the event after which the stream begins.
#[derive(Deserialize, IntoParams)]
#[serde(rename_all = "camelCase")]
#[into_params(parameter_in = Query)]
pub struct LiveQuery {
    /// As the header `Last-Event-ID`, for the first connection of a page: `lastEventId` of the view
    /// it shows.
    last_event_id: Option<String>,
}

/// Streams server-sent events (HTML living standard §9.2). Of each event, the schema's `event` is
/// the line `event:`, and its `data` is the JSON of the line `data:`.
#[utoipa::path(get, operation_id = "streamLive", path = "/live", tag = "live", security(("session" = [])), params(LiveQuery),
    responses((status = 200, content_type = "text/event-stream", body = LiveEvent), ReadProblems))]
pub async fn stream(
    State(app): State<Application>,
    who: SignedIn<Principal>,
    ApiQuery(query): ApiQuery<LiveQuery>,
    headers: HeaderMap,
) -> Response {
    let after = last_event_id(&headers).map(str::to_owned).or(query.last_event_id);
    let principal = who.principal;
    let reset = ServerSentEvent::of(&LiveEvent::Reset {});
    app.live.stream(after.as_deref(), reset, app.shutdown.clone(), move |notification| {
        notification.shown_to(principal.organisation(), principal.is_administrator())
    })
}
