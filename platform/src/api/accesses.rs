//! Accesses to a factory's values, for the organisation of the factory.

use access_log::{
    Access, AccessEntry, AccessRetentionEntry, access_log_verifier,
    audit::{AccessAuditLine, AccessAuditStart},
};
use asi_model::{DateTime, DynamicDataRequestId, FactoryId, OperationNetworkId, OrganisationId};
use axum::{
    Json,
    body::Body,
    extract::State,
    http::header,
    response::{IntoResponse, Response},
};
use daemon::web::{
    ApiPath, ApiQuery, Problem,
    session::SignedIn,
    shares::{FurtherTurns, OwnTurns},
};
use futures::stream;
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};

use super::{
    own_factory,
    page::{Page, limit},
    problems::ReadProblems,
};
use crate::{
    application::Application,
    principal::Principal,
    store::{AccessQuery, ListedAccess, Scope, StoreReader, StoredAccessLog},
};

/// Media type of an audit file: a JSON object per line.
const JSON_LINES: &str = "application/x-ndjson";
/// Entries that are read at once for an audit file.
const ENTRIES_PER_READ: u32 = 1_000;

/// Filter and page of accesses.
#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct AccessesQuery {
    /// Restriction to accesses of this organisation.
    viewer: Option<OrganisationId>,
    /// Restriction to values of this network.
    network: Option<OperationNetworkId>,
    /// Restriction to values of this request.
    request: Option<DynamicDataRequestId>,
    /// `nextCursor` of the page before; absent for the first page.
    #[param(value_type = Option<String>)]
    cursor: Option<u64>,
    /// Most entries wanted, 1 to 1000.
    limit: Option<u32>,
}

/// An entry of the record of who read a factory's values.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct AccessView {
    /// Number in the log, from 1 without gaps.
    number: u64,
    recorded_at: DateTime,
    #[serde(flatten)]
    access: Access,
    /// Name of the person or tool; for the own organisation's only.
    agent_name: Option<String>,
}

/// A signed statement of the size and the root of a factory's access log.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct AccessCheckpointView {
    /// The checkpoint, a C2SP signed note; absent in the first minute of a log.
    checkpoint: Option<String>,
    /// The key that signed it, as `name+id+key`. Note it once, and keep checkpoints where the
    /// platform cannot change them.
    verifier_key: String,
    /// The newest statement of the log about entries that were removed; absent before the first.
    retention: Option<AccessRetentionEntry>,
}

impl From<ListedAccess> for AccessView {
    fn from(listed: ListedAccess) -> Self {
        let AccessEntry { number, recorded_at, access, .. } = listed.entry;
        Self { number, recorded_at, access, agent_name: listed.agent_name }
    }
}

/// Lists who read values of a factory, newest first: for members of its organisation. Further reads
/// of the same values within a minute are one entry.
#[utoipa::path(get, operation_id = "listAccesses", path = "/factories/{factoryId}/accesses", tag = "accesses", security(("session" = [])),
    params(("factoryId" = String, Path), AccessesQuery), responses((status = 200, body = Page<AccessView>), ReadProblems))]
pub async fn list(
    State(app): State<Application>,
    who: SignedIn<Principal>,
    ApiPath(id): ApiPath<FactoryId>,
    ApiQuery(query): ApiQuery<AccessesQuery>,
) -> Result<Json<Page<AccessView>>, Problem> {
    let wanted = AccessQuery {
        viewer: query.viewer,
        network: query.network,
        request: query.request,
        before: query.cursor,
        limit: limit(query.limit),
    };
    let mut work = app.store.read().await?;
    own_factory::check_member(&mut work, &who.principal, &id).await?;
    let listed = work.accesses().list(&who.principal.scope(), &id, &wanted).await?;
    let views = listed.into_iter().map(AccessView::from).collect();
    Ok(Json(Page::new(views, wanted.limit, |view: &AccessView| view.number.to_string())))
}

/// Shows the newest checkpoint of a factory's access log, which covers all entries but those of the
/// last minute: for members of its organisation.
#[utoipa::path(get, operation_id = "showAccessCheckpoint", path = "/factories/{factoryId}/accesses/checkpoint", tag = "accesses", security(("session" = [])),
    params(("factoryId" = String, Path)), responses((status = 200, body = AccessCheckpointView), ReadProblems))]
pub async fn checkpoint(
    State(app): State<Application>,
    who: SignedIn<Principal>,
    ApiPath(id): ApiPath<FactoryId>,
) -> Result<Json<AccessCheckpointView>, Problem> {
    let mut work = app.store.read().await?;
    own_factory::check_member(&mut work, &who.principal, &id).await?;
    let stored = work.accesses().lookup(&id).await?;
    let retention = work.accesses().newest_retention(&id).await?;
    let key = access_log_verifier(&id, &app.accesses.key().public())
        .map_err(|error| Problem::internal(&error))?;
    let checkpoint = stored.and_then(|stored| stored.checkpoint).map(|(_, note)| note);
    Ok(Json(AccessCheckpointView { checkpoint, verifier_key: key.to_string(), retention }))
}

/// Exports a factory's access log as an audit file, a JSON object per line, which `asi access verify`
/// checks against a checkpoint that was kept elsewhere: for members of its organisation.
#[utoipa::path(get, operation_id = "exportAccesses", path = "/factories/{factoryId}/accesses/audit", tag = "accesses", security(("session" = [])),
    params(("factoryId" = String, Path)), responses((status = 200, content_type = "application/x-ndjson", body = String), ReadProblems))]
pub async fn export(
    State(app): State<Application>,
    who: SignedIn<Principal>,
    turns: OwnTurns,
    ApiPath(id): ApiPath<FactoryId>,
) -> Result<Response, Problem> {
    let (turn, turns) = turns.to_begin().await?;
    let mut work = app.store.read().await?;
    own_factory::check_member(&mut work, &who.principal, &id).await?;
    let stored = work.accesses().lookup(&id).await?;
    drop((work, turn));
    let name = format!("attachment; filename=\"accesses-{id}.jsonl\"");
    let headers =
        [(header::CONTENT_TYPE, JSON_LINES.to_owned()), (header::CONTENT_DISPOSITION, name)];
    let Some(stored) = stored else { return Ok((headers, "").into_response()) };
    let begin = AccessAuditStart::of(&stored.log, &stored.removed, app.accesses.key()).line();
    let rest = lines((app.store.reader(), turns), who.principal.scope(), id, &stored);
    let all = stream::once(std::future::ready(Ok(begin)));
    let body = Body::from_stream(futures::StreamExt::chain(all, rest));
    Ok((headers, body).into_response())
}

/// Reads the entries of a log as lines, some at a time, each time in a turn. Ends with an error where retention removes
/// some meanwhile, so that no file with a hole looks complete.
fn lines(
    (store, turns): (StoreReader, FurtherTurns),
    scope: Scope,
    factory: FactoryId,
    stored: &StoredAccessLog,
) -> impl futures::Stream<Item = std::io::Result<String>> + Send + use<> {
    let (first, last) = (stored.removed.last_number(), stored.log.last_number());
    stream::try_unfold(
        (store, turns, scope, factory, first),
        move |(store, turns, scope, factory, after)| async move {
            if after >= last {
                return Ok(None);
            }
            let limit = u32::try_from(last - after).unwrap_or(u32::MAX).min(ENTRIES_PER_READ);
            let read = async {
                let _turn = turns.to_read().await;
                store.read().await?.accesses().texts(&scope, &factory, after, limit).await
            };
            let texts = read.await.map_err(std::io::Error::other)?;
            let expected = after + 1..=after + u64::from(limit);
            if !texts.iter().map(|(number, _)| *number).eq(expected) {
                return Err(std::io::Error::other("entries were removed meanwhile"));
            }
            let lines =
                texts.into_iter().map(|(_, entry)| AccessAuditLine { entry }.line()).collect();
            Ok(Some((lines, (store, turns, scope, factory, after + u64::from(limit)))))
        },
    )
}
