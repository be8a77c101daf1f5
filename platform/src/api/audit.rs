//! Entries of who changed what.

use asi_model::DateTime;
use axum::{
    Json,
    body::Body,
    extract::State,
    http::header,
    response::{IntoResponse, Response},
};
use daemon::web::{
    ApiQuery, Problem,
    session::SignedIn,
    shares::{FurtherTurns, OwnTurns},
};
use futures::stream;

use super::{
    page::{Page, PageQuery},
    problems::ReadProblems,
};
use crate::{
    application::Application,
    principal::Principal,
    store::{AuditEntry, Scope, StoreError, StoreReader},
};

/// Media type of an export: a JSON object per line.
const JSON_LINES: &str = "application/x-ndjson";
/// Entries that are read at once for an export.
const ENTRIES_PER_READ: u32 = 1_000;

/// Lists who changed what, newest first: to planners what their organisation did and what was done to its
/// people, factories and tools, to administrators all.
#[utoipa::path(get, operation_id = "listAuditEntries", path = "/audit-entries", tag = "audit", security(("session" = [])),
    params(PageQuery), responses((status = 200, body = Page<AuditEntry>), ReadProblems))]
pub async fn list(
    State(app): State<Application>,
    who: SignedIn<Principal>,
    ApiQuery(page): ApiQuery<PageQuery>,
) -> Result<Json<Page<AuditEntry>>, Problem> {
    check(&who)?;
    let mut work = app.store.read().await?;
    let entries =
        work.audit().list(&who.principal.scope(), page.after_id().as_ref(), page.limit()).await?;
    Ok(Json(Page::new(entries, page.limit(), |entry| entry.entry_id.to_string())))
}

/// Exports the same, oldest first, as a JSON object per line.
#[utoipa::path(get, operation_id = "exportAuditEntries", path = "/audit-entries/export", tag = "audit", security(("session" = [])),
    responses((status = 200, content_type = "application/x-ndjson", body = String), ReadProblems))]
pub async fn export(
    State(app): State<Application>,
    who: SignedIn<Principal>,
    turns: OwnTurns,
) -> Result<Response, Problem> {
    check(&who)?;
    let name = format!("attachment; filename=\"audit-{}.jsonl\"", day(app.clock.now()));
    let headers =
        [(header::CONTENT_TYPE, JSON_LINES.to_owned()), (header::CONTENT_DISPOSITION, name)];
    let (store, scope) = (app.store.reader(), who.principal.scope());
    let (turn, turns) = turns.to_begin().await?;
    let first = portion(&store, &scope, 0).await?;
    drop(turn);
    let body = Body::from_stream(lines(store, turns, scope, first));
    Ok((headers, body).into_response())
}

async fn portion(
    store: &StoreReader,
    scope: &Scope,
    after: u64,
) -> Result<Vec<AuditEntry>, StoreError> {
    store.read().await?.audit().list_after(scope, after, ENTRIES_PER_READ).await
}

/// Lets those pass who answer for what their organisation does.
fn check(who: &SignedIn<Principal>) -> Result<(), Problem> {
    if who.principal.may_plan() {
        Ok(())
    } else {
        Err(Problem::forbidden("This needs a planner of an organisation, or an administrator."))
    }
}

fn day(now: DateTime) -> String {
    now.to_string().chars().take("2026-01-01".len()).collect()
}

/// Position of an export.
enum Position {
    /// Before these entries, which are read.
    Before(Vec<AuditEntry>),
    /// Behind the entry of this number.
    Behind(u64),
}

/// Returns the first entries as lines, and reads those behind them, some at a time, each time in a turn and with a
/// connection of its own: who reads slowly holds neither.
fn lines(
    store: StoreReader,
    turns: FurtherTurns,
    scope: Scope,
    first: Vec<AuditEntry>,
) -> impl futures::Stream<Item = std::io::Result<String>> + Send {
    let begin = (store, turns, scope, Position::Before(first));
    stream::try_unfold(begin, |(store, turns, scope, position)| async move {
        let entries = match position {
            Position::Before(entries) => entries,
            Position::Behind(last) => {
                let _turn = turns.to_read().await;
                portion(&store, &scope, last).await.map_err(std::io::Error::other)?
            }
        };
        let Some(last) = entries.last().map(|entry| entry.number) else { return Ok(None) };
        let mut text = String::new();
        for entry in &entries {
            text.push_str(&serde_json::to_string(entry).map_err(std::io::Error::other)?);
            text.push('\n');
        }
        Ok(Some((text, (store, turns, scope, Position::Behind(last)))))
    })
}
