//! Sessions of a person, at the pages and at the OPC UA server.

use std::cmp::Reverse;

use asi_model::DateTime;
use daemon::web::{
    Problem,
    session::{AccountChange, SessionId, SessionSummary},
};
use serde::Serialize;
use twin::TwinSession;
use utoipa::ToSchema;

use super::context::Api;

/// Beginning of the names of sessions at the OPC UA server; those of the pages are hexadecimal digits.
const OPC_UA_PREFIX: &str = "opcua-";

/// Session of a person, shown to its owner or to an engineer.
#[derive(Debug, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct PersonSession {
    /// Name by which the session is ended; nobody can use the session with it.
    session_id: String,
    kind: SessionKind,
    /// True for the session that asks.
    is_present: bool,
    /// Address from which the person signed in; empty if the OPC UA server had opened the connection.
    address: String,
    /// Browser or OPC UA client as it calls itself.
    user_agent: String,
    /// Subject of the OPC UA client's certificate; none at the pages, and without protection.
    client_certificate: Option<String>,
    started_at: DateTime,
    /// Last use, at the pages to the minute. An open page uses its session.
    last_used_at: DateTime,
}

/// Place of a session.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum SessionKind {
    /// The pages, or a tool that uses their API.
    Page,
    /// The OPC UA server.
    OpcUa,
}

impl From<SessionSummary> for PersonSession {
    fn from(session: SessionSummary) -> Self {
        Self {
            session_id: session.session_id,
            kind: SessionKind::Page,
            is_present: session.is_present,
            address: session.address,
            user_agent: session.user_agent,
            client_certificate: None,
            started_at: session.started_at.into(),
            last_used_at: session.last_used_at.into(),
        }
    }
}

impl From<TwinSession> for PersonSession {
    fn from(session: TwinSession) -> Self {
        Self {
            session_id: format!("{OPC_UA_PREFIX}{}", session.number),
            kind: SessionKind::OpcUa,
            is_present: false,
            address: session.address.map(|address| address.to_string()).unwrap_or_default(),
            user_agent: session.application_name,
            client_certificate: session.certificate_subject,
            started_at: session.started_at,
            last_used_at: session.last_used_at,
        }
    }
}

/// Lists the sessions of a person, the one used last first; `present` is the one that asks.
pub(super) async fn list(
    api: &Api,
    user_name: &str,
    present: &SessionId,
) -> Result<Vec<PersonSession>, Problem> {
    let at_pages = api.sessions.list(user_name, present).await?.items;
    let mut sessions: Vec<PersonSession> = at_pages.into_iter().map(Into::into).collect();
    sessions.extend(api.twin.sessions_of(user_name).into_iter().map(PersonSession::from));
    sessions.sort_by_key(|session| Reverse(session.last_used_at));
    Ok(sessions)
}

/// Ends a session of a person.
pub(super) async fn end(
    api: &Api,
    user_name: &str,
    session_id: &str,
    change: AccountChange<'_>,
) -> Result<(), Problem> {
    let Some(number) = session_id.strip_prefix(OPC_UA_PREFIX) else {
        return api.sessions.end(user_name, session_id, change).await;
    };
    let number = number.parse::<u32>().map_err(|_| Problem::not_found("such session"))?;
    if !api.twin.end_session_of(user_name, number).await {
        return Err(Problem::not_found("such session"));
    }
    tracing::info!(user.name = user_name, by = change.by, "An OPC UA session was ended.");
    Ok(())
}
