//! Live notifications.

use std::sync::Arc;

use access_log::AccessKind;
use axum::{extract::State, http::HeaderMap, response::Response};
use daemon::web::{
    ApiQuery,
    events::{ServerSentEvent, StreamEnd, last_event_id},
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
    /// Counterpart of the header `Last-Event-ID`, for the first connection of a page: `lastEventId`
    /// of the view it shows.
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
    let viewer = Arc::new((who.principal.reader(), who.principal));
    let reset = ServerSentEvent::of(&LiveEvent::Reset {});
    let accesses = app.accesses.clone();
    app.live.stream(after.as_deref(), reset, app.shutdown.clone(), move |notification| {
        let (viewer, accesses) = (Arc::clone(&viewer), accesses.clone());
        async move {
            let (reader, principal) = &*viewer;
            let organisation = principal.organisation();
            let event = notification.shown_to(organisation, principal.is_administrator());
            let Some(event) = event else { return Ok(None) };
            // The page reconnects and asks for the same event again.
            let shown = accesses.show(reader.as_ref(), AccessKind::Streamed, event).await;
            shown.map(|event| Some(ServerSentEvent::of(event))).map_err(|error| {
                tracing::warn!(%error, "A live stream ends.");
                StreamEnd
            })
        }
    })
}
