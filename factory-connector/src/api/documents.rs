//! Versioned documents: the common part of named policies, standing rules, alliances and caps.

use std::str::FromStr;

use asi_model::DateTime;
use axum::{
    Json,
    http::{HeaderMap, header},
};
use connector_state::{ChangeSet, ConnectorState, DocumentError};
use daemon::web::{Problem, problem::ProblemFault};
use disclosure::{DocumentId, Versioned};
use serde::de::DeserializeOwned;

use super::{context::Api, problems::over_cap, view::Page};
use crate::store::DocumentKind;

/// Stores a version in an engineer's name, provided that `If-Match`, if given, names the present one.
pub(super) async fn keep<T: Send + 'static>(
    api: &Api,
    author: &str,
    headers: &HeaderMap,
    keep: impl FnOnce(
        &mut ConnectorState,
        Option<u32>,
        &str,
        DateTime,
    ) -> Result<(T, ChangeSet), DocumentError>
    + Send
    + 'static,
) -> Result<T, Problem> {
    let (expected, by) = (if_match(headers)?, author.to_owned());
    api.coordinator
        .execute(move |state, now| keep(state, expected, &by, now))
        .await?
        .map_err(document_problem)
}

/// Returns every version of a document, newest first.
pub(super) async fn versions<T: DeserializeOwned>(
    api: &Api,
    kind: DocumentKind,
    id: &DocumentId,
) -> Result<Json<Page<Versioned<T>>>, Problem> {
    Ok(Json(Page::whole(api.store().await?.policy_documents().versions(kind, id).await?)))
}

/// Returns what `If-Match` names in quotes, if given: the version of a document, or the tag of a field.
pub(super) fn if_match<T: FromStr>(headers: &HeaderMap) -> Result<Option<T>, Problem> {
    let Some(value) = headers.get(header::IF_MATCH) else { return Ok(None) };
    let named = value.to_str().ok().and_then(|text| text.trim_matches('"').parse().ok());
    let detail = "If-Match must be the version in quotes, as \"3\".";
    named.map(Some).ok_or_else(|| Problem::bad_request("INVALID_IF_MATCH", detail))
}

/// Returns the problem of a document that was not stored.
pub(super) fn document_problem(error: DocumentError) -> Problem {
    match error {
        DocumentError::Unknown(id) => Problem::not_found(format_args!("policy {id}")),
        DocumentError::Changed(_) => Problem::conflict("CHANGED", format!("{error}.")),
        DocumentError::TooMany => Problem::conflict("LIMIT_REACHED", format!("{error}.")),
        DocumentError::OverCap(excesses) => over_cap(&excesses, ""),
        DocumentError::Faults(faults) => {
            let faults = faults
                .into_iter()
                .map(|fault| ProblemFault {
                    pointer: fault.pointer,
                    code: "INVALID".to_owned(),
                    message: fault.message,
                })
                .collect();
            Problem::unprocessable("INVALID_DOCUMENT", "The document has faults.", faults)
        }
    }
}
