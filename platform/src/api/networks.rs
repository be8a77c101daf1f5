//! Operation networks.

use access_log::AccessKind;
use asi_model::{
    CollaborationId, FactoryId, OperationNetworkId, network::OperationNetwork,
    validation::parse_network,
};
use axum::{
    Json,
    extract::State,
    http::{HeaderMap, HeaderValue, header},
};
use daemon::web::{ApiJson, ApiPath, ApiQuery, Problem, session::SignedIn};
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;
use utoipa::ToSchema;

use super::{
    page::{Page, PageQuery},
    problems::{ChangeProblems, ReadProblems, faulty},
};
use crate::{
    application::Application,
    audit::RecordedWork,
    networks::{self, Author, ChangeOutcome, NetworkView, PutNetwork},
    principal::Principal,
    store::{AuditFact, AuditFactKind, AuditOutcome, AuditSubject, NetworkSummary},
};

/// A network to put in place.
#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct PutBody {
    collaboration_id: CollaborationId,
    /// The network as the author sees it (wire contract `operation-network`), each operation with
    /// `owningFactoryId`.
    #[schema(value_type = asi_model::network::OperationNetwork)]
    operation_network: Box<RawValue>,
}

impl PutBody {
    /// Reads the network by the wire contract.
    pub(super) fn network(&self) -> Result<OperationNetwork, Problem> {
        parse_network(self.operation_network.get().as_bytes())
            .map_err(|rejection| faulty(rejection.faults, "/operationNetwork"))
    }
}

/// Result of a change.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct Changed {
    /// The revision in effect.
    revision: u64,
    /// False where nothing differed.
    is_changed: bool,
    /// The factories that were sent something, as far as the author may know of them.
    sent_to: Vec<FactoryId>,
}

/// Lists the networks of which the viewer sees anything, by id.
#[utoipa::path(get, operation_id = "listOperationNetworks", path = "/operation-networks", tag = "networks", security(("session" = [])), params(PageQuery),
    responses((status = 200, body = Page<NetworkSummary>), ReadProblems))]
pub async fn list(
    State(app): State<Application>,
    who: SignedIn<Principal>,
    ApiQuery(page): ApiQuery<PageQuery>,
) -> Result<Json<Page<NetworkSummary>>, Problem> {
    let after = page.cursor.clone().unwrap_or_default();
    let networks = app
        .store
        .read()
        .await?
        .networks()
        .list(&who.principal.scope(), &after, page.limit())
        .await?;
    Ok(Json(Page::new(networks, page.limit(), |network| network.operation_network_id.to_string())))
}

/// Shows what the viewer sees of a network: operations, parts, progress and fields. Its own
/// operations, those it drew and those of which a field is open to it are whole; those it asks about are
/// shown in part, its neighbours as stubs.
#[utoipa::path(get, operation_id = "showOperationNetwork", path = "/operation-networks/{operationNetworkId}", tag = "networks", security(("session" = [])),
    params(("operationNetworkId" = String, Path)), responses((status = 200, body = NetworkView), ReadProblems))]
pub async fn show(
    State(app): State<Application>,
    who: SignedIn<Principal>,
    ApiPath(id): ApiPath<OperationNetworkId>,
) -> Result<(HeaderMap, Json<NetworkView>), Problem> {
    // Asked before the view is read, so that a client that follows from this id may see a change
    // twice but never misses one.
    let last_event_id = app.live.newest_id();
    let mut work = app.store.read().await?;
    let view = networks::view(&mut work, &who.principal.scope(), &id, last_event_id).await?;
    drop(work);
    let view = view.ok_or_else(|| Problem::not_found(format_args!("operation network {id}")))?;
    let reader = who.principal.reader();
    let view = app.accesses.disclose(reader.as_ref(), AccessKind::Looked, view).await?;
    let mut headers = HeaderMap::new();
    if let Ok(tag) = HeaderValue::from_str(&format!("\"{}\"", view.revision)) {
        headers.insert(header::ETAG, tag);
    }
    Ok((headers, Json(view)))
}

/// Puts a network in place of what the author sees of it; each factory whose part differs is sent
/// it. What is hidden stays as it is, and what belongs to others must come back as it was shown: it
/// is compared member by member. `If-Match` with the revision guards against overwriting another
/// author's change. The same network again changes nothing.
#[utoipa::path(put, operation_id = "putOperationNetwork", path = "/operation-networks/{operationNetworkId}", tag = "networks", security(("session" = [])),
    params(("operationNetworkId" = String, Path), ("If-Match" = Option<String>, Header)), request_body = PutBody,
    responses((status = 200, body = Changed), ChangeProblems))]
pub async fn put(
    State(app): State<Application>,
    who: SignedIn<Principal>,
    ApiPath(id): ApiPath<OperationNetworkId>,
    headers: HeaderMap,
    ApiJson(body): ApiJson<PutBody>,
) -> Result<Json<Changed>, Problem> {
    let network = body.network()?;
    if network.operation_network_id != id {
        return Err(Problem::bad_request(
            "OTHER_ID",
            "The document's operationNetworkId differs from the path's.",
        ));
    }
    let change = PutNetwork {
        collaboration_id: body.collaboration_id,
        network,
        expected_revision: expected_revision(&headers)?,
    };
    let author = Author::user(&who.principal, app.clock.now());
    let mut work = app.store.begin(&who.principal, "putOperationNetwork").await?;
    let outcome =
        networks::put(&mut work, change, &author, app.resend_after()).await.map_err(with_prefix)?;
    Ok(Json(commit(&app, work, format!("operation-networks/{id}"), outcome).await?))
}

/// Withdraws a network of the own organisation: its nodes and mappings go at every factory.
#[utoipa::path(delete, operation_id = "withdrawOperationNetwork", path = "/operation-networks/{operationNetworkId}", tag = "networks", security(("session" = [])),
    params(("operationNetworkId" = String, Path)), responses((status = 200, body = Changed), ChangeProblems))]
pub async fn withdraw(
    State(app): State<Application>,
    who: SignedIn<Principal>,
    ApiPath(id): ApiPath<OperationNetworkId>,
) -> Result<Json<Changed>, Problem> {
    let author = Author::user(&who.principal, app.clock.now());
    let mut work = app.store.begin(&who.principal, "withdrawOperationNetwork").await?;
    let outcome = networks::withdraw(&mut work, &id, &author, app.resend_after()).await?;
    Ok(Json(commit(&app, work, format!("operation-networks/{id}"), outcome).await?))
}

/// Commits a change with its record, publishes it to pages and link, and returns the answer.
pub(super) async fn commit(
    app: &Application,
    mut work: RecordedWork,
    path: String,
    outcome: ChangeOutcome,
) -> Result<Changed, Problem> {
    work.describe([AuditFact::new(AuditFactKind::Revision, outcome.revision)]);
    let result = AuditOutcome::of(outcome.is_changed);
    work.commit(AuditSubject::shared(path), result).await?;
    app.broker_access.wake_link();
    app.live.publish(outcome.notifications);
    let ChangeOutcome { revision, is_changed, sent_to, .. } = outcome;
    Ok(Changed { revision, is_changed, sent_to })
}

fn with_prefix(error: networks::ChangeError) -> Problem {
    match error {
        networks::ChangeError::Faulty(faults) => faulty(faults, "/operationNetwork"),
        other => other.into(),
    }
}

fn expected_revision(headers: &HeaderMap) -> Result<Option<u64>, Problem> {
    let Some(value) = headers.get(header::IF_MATCH) else { return Ok(None) };
    let revision = value.to_str().ok().and_then(|text| text.trim_matches('"').parse().ok());
    let detail = "If-Match must be the revision in quotes, as \"3\".";
    revision.map(Some).ok_or_else(|| Problem::bad_request("INVALID_IF_MATCH", detail))
}
