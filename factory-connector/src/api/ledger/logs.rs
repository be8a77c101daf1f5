//! Logs of the chains with what the platform has countersigned of them, and the decision about a
//! conflict with it.

use asi_model::{DateTime, OrganisationId};
use axum::{Json, extract::State};
use connector_state::use_cases::witness::NewLogDecision;
use daemon::web::{ApiJson, ApiPath, Problem};
use ledger::{CosignedCheckpoint, Hash, Log, LogConflict};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::{
    api::{
        context::Api,
        problems::Problems,
        roles::{Engineer, Viewer},
        view::Page,
    },
    ledger_key::{self, LEDGER_KEY_FILE},
};

/// Longest reason for a new log, in characters.
const REASON_CHARS_MAX: usize = 1000;

/// Log of a chain, which others check with one checkpoint that they kept.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct LogView {
    /// Organisation of the chain.
    recipient_id: OrganisationId,
    /// Number of the log among those that replaced each other, from 1.
    epoch: u32,
    /// Name of the log (C2SP tlog-checkpoint).
    origin: String,
    /// Number of leaves: the entries, and one for the beginning.
    size: u64,
    /// The key of the log, for the recipient to note: name, id and key.
    verifier_key: Option<String>,
    /// The last checkpoint that the platform has countersigned; none before the first.
    witnessed: Option<WitnessedView>,
    /// Other history that the platform holds; nothing is disclosed until it is settled.
    conflict: Option<LogConflict>,
}

/// A checkpoint with the signature of the platform.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct WitnessedView {
    /// Number of leaves that the platform holds; 0 where it has lost them.
    size: u64,
    /// The checkpoint, a C2SP signed note.
    checkpoint: String,
    /// The platform's key as a witness: name, id and key.
    witness_key: String,
    cosigned_at: DateTime,
}

/// Decision to begin a new log.
#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct NewLogBody {
    /// Reason, which stands in the new log for the recipient to read.
    reason: String,
}

impl NewLogBody {
    /// Returns the reason; a problem where none is given.
    pub(in crate::api) fn reason(&self) -> Result<String, Problem> {
        let reason = self.reason.trim();
        if reason.is_empty() || reason.chars().nth(REASON_CHARS_MAX).is_some() {
            let detail = format!("Give a reason of 1 to {REASON_CHARS_MAX} characters.");
            return Err(Problem::bad_request("NO_REASON", detail));
        }
        Ok(reason.to_owned())
    }
}

impl LogView {
    fn new(log: &Log, public_key: Option<&Hash>) -> Self {
        let (start, witnessing) = (log.start(), log.witnessing());
        let size = witnessing.witnessed().end();
        let view = |cosigned: &CosignedCheckpoint| WitnessedView {
            size,
            checkpoint: cosigned.note.clone(),
            witness_key: cosigned.witness_key.clone(),
            cosigned_at: cosigned.cosigned_at,
        };
        let verifier = public_key.and_then(|key| start.verifier(key).ok());
        Self {
            recipient_id: start.recipient.clone(),
            epoch: start.epoch,
            origin: start.origin(),
            size: log.leaves().end(),
            verifier_key: verifier.map(|key| key.to_string()),
            witnessed: witnessing.cosigned().map(view),
            conflict: witnessing.conflict().cloned(),
        }
    }
}

/// Lists the logs of all chains, by their recipients.
#[utoipa::path(
    get,
    path = "/ledger/logs",
    tag = "ledger",
    responses((status = 200, body = Page<LogView>), Problems)
)]
pub async fn list_ledger_logs(
    _: Viewer,
    State(api): State<Api>,
) -> Result<Json<Page<LogView>>, Problem> {
    let path = api.instance.data_directory.join(LEDGER_KEY_FILE);
    let key = ledger_key::public_half(&path).map_err(|error| Problem::internal(&error))?;
    let views = api.coordinator.read(move |state| {
        state.ledger().logs().map(|log| LogView::new(log, key.as_ref())).collect()
    });
    Ok(Json(Page::whole(views.await?)))
}

/// Begins a new log in place of one of which the platform holds another history. It has all entries
/// that the store has; what the platform holds of the former log stays there for the recipient.
/// Values leave again.
#[utoipa::path(
    post,
    path = "/ledger/logs/{recipientId}/successor",
    tag = "ledger",
    params(("recipientId" = String, Path)),
    request_body = NewLogBody,
    responses((status = 200, body = LogView), Problems)
)]
pub async fn begin_ledger_log(
    user: Engineer,
    State(api): State<Api>,
    ApiPath(recipient): ApiPath<OrganisationId>,
    ApiJson(body): ApiJson<NewLogBody>,
) -> Result<Json<LogView>, Problem> {
    let reason = body.reason()?;
    let decided_by = user.principal.user_name.clone();
    let decision = NewLogDecision { recipient: recipient.clone(), decided_by, reason };
    if !api.coordinator.begin_log(decision).await? {
        return Err(Problem::conflict(
            "NO_CONFLICT",
            "The platform holds no other history of this log; there is nothing to decide.",
        ));
    }
    let path = api.instance.data_directory.join(LEDGER_KEY_FILE);
    let key = ledger_key::public_half(&path).map_err(|error| Problem::internal(&error))?;
    let asked = recipient.clone();
    let view = api
        .coordinator
        .read(move |state| state.ledger().log(&asked).map(|log| LogView::new(log, key.as_ref())));
    let view = view.await?;
    view.map(Json).ok_or_else(|| Problem::not_found(format_args!("log of {recipient}")))
}
