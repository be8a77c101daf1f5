//! Local OPC UA servers: adding, browsing, trusting.

use asi_model::{FieldKey, NodeId};
use axum::{Json, extract::State, http::StatusCode};
use connector_state::{ConnectorState, queries, use_cases::configuration, writes::SourceRow};
use daemon::web::{ApiJson, ApiPath, ApiQuery, Problem};
use serde::{Deserialize, Serialize};
use shop_floor::{
    BrowsedNode, Identity, PeerCertificate, SourceConfig, SourceId, SourceStatus, TrustState,
};
use utoipa::{IntoParams, ToSchema};

use super::{
    context::Api,
    problems::{Problems, shop_floor},
    roles::{BeforeGate, Engineer, Viewer},
    values::ShownValue,
    view::Page,
};
use crate::{passwords, store::SecretHolder};

/// Children per page without a limit, and at most: a server may list a hundred thousand in one
/// folder.
const CHILDREN: usize = 500;
const CHILDREN_MAX: usize = 1000;

/// Fields that are named as using a source: enough for a person to see what it is about.
const FIELDS_SHOWN: usize = 20;

/// A source with its configuration and status.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct SourceView {
    /// Configuration without the password.
    #[serde(flatten)]
    config: SourceConfig,
    /// Status of the connection.
    #[serde(flatten)]
    status: SourceStatus,
}

/// Lists the stored sources with their state.
#[utoipa::path(
    get,
    path = "/sources",
    tag = "sources",
    responses((status = 200, body = Page<SourceView>), Problems)
)]
pub async fn list_sources(
    _: Viewer,
    State(api): State<Api>,
) -> Result<Json<Page<SourceView>>, Problem> {
    let configs = api.store().await?.sources().all().await?;
    let items = api
        .shop_floor
        .states()
        .into_iter()
        .filter_map(|status| {
            let row = configs.iter().find(|row| row.source_id == status.source_id.as_str())?;
            let config = serde_json::from_str(&row.config).ok()?;
            Some(SourceView { config, status })
        })
        .collect();
    Ok(Json(Page::whole(items)))
}

/// Adds a source; the connector connects to it at once.
#[utoipa::path(
    post,
    path = "/sources",
    tag = "sources",
    request_body = SourceConfig,
    responses((status = 201, body = SourceConfig), Problems)
)]
pub async fn add_source(
    _: Engineer,
    State(api): State<Api>,
    ApiJson(source): ApiJson<SourceConfig>,
) -> Result<(StatusCode, Json<SourceConfig>), Problem> {
    if api.shop_floor.states().iter().any(|status| status.source_id == source.source_id) {
        return Err(Problem::conflict("ALREADY_EXISTS", "There is a source with this id already."));
    }
    put(&api, source.clone()).await?;
    Ok((StatusCode::CREATED, Json(source)))
}

/// Changes a source; mappings that use it go on under the new settings. Without a password the stored one of the same user
/// is kept, at the same address.
#[utoipa::path(
    put,
    path = "/sources/{sourceId}",
    tag = "sources",
    params(("sourceId" = String, Path)),
    request_body = SourceConfig,
    responses((status = 200, body = SourceConfig), Problems)
)]
pub async fn change_source(
    _: Engineer,
    State(api): State<Api>,
    ApiPath(id): ApiPath<SourceId>,
    ApiJson(source): ApiJson<SourceConfig>,
) -> Result<Json<SourceConfig>, Problem> {
    if source.source_id != id {
        return Err(Problem::bad_request(
            "OTHER_ID",
            "The document's sourceId differs from the path's.",
        ));
    }
    let source = with_kept_password(&api, source).await?;
    put(&api, source.clone()).await?;
    Ok(Json(source))
}

/// Returns a source with the password that is stored for it, where the same user's is left out.
///
/// # Errors
/// 422 `PASSWORD_NEEDED` where the source is at another address than the password was given for: it would be sent to
/// whatever is there.
pub(super) async fn with_kept_password(
    api: &Api,
    mut source: SourceConfig,
) -> Result<SourceConfig, Problem> {
    let Identity::UserName { user_name, password } = &mut source.identity else {
        return Ok(source);
    };
    if !password.expose().is_empty() {
        return Ok(source);
    }
    let rows = api.store().await?.sources().all().await?;
    let Some(row) = rows.into_iter().find(|row| row.source_id == source.source_id.as_str()) else {
        return Ok(source);
    };
    let stored: SourceConfig =
        serde_json::from_str(&row.config).map_err(|error| Problem::internal(&error))?;
    let is_same_user = matches!(&stored.identity,
        Identity::UserName { user_name: known, .. } if known == user_name);
    let kept = passwords::of_source(&api.instance.sealer, &row)
        .map_err(|error| Problem::internal(error.as_ref()))?
        .filter(|kept| is_same_user && !kept.expose().is_empty());
    let Some(kept) = kept else { return Ok(source) };
    if stored.endpoint_url != source.endpoint_url {
        return Err(Problem::unprocessable(
            "PASSWORD_NEEDED",
            "The password is kept for the address that it was given for. Enter it again for another one.",
            Vec::new(),
        ));
    }
    *password = kept.expose().as_str().into();
    Ok(source)
}

async fn put(api: &Api, source: SourceConfig) -> Result<(), Problem> {
    let holder = SecretHolder::Source(source.source_id.to_string());
    let sealed_password = match &source.identity {
        Identity::UserName { password, .. } => {
            Some(passwords::seal(&api.instance.sealer, &holder, password.expose()))
        }
        Identity::Anonymous | Identity::Certificate { .. } => None,
    };
    let sealed_password = sealed_password.transpose().map_err(|error| Problem::internal(&error))?;
    let config = serde_json::to_string(&source).map_err(|error| Problem::internal(&error))?;
    let row = SourceRow { source_id: source.source_id.to_string(), config, sealed_password };
    api.shop_floor.check_source(&source).map_err(shop_floor)?;
    api.coordinator.execute(|_, _| configuration::put_source(row)).await?;
    // Connected once it is stored: what the next start does not know has never been in use.
    api.shop_floor.put_source(source).map_err(shop_floor)
}

/// Fields that are disclosed from the values of a source.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct SourceUse {
    /// Number of the fields.
    field_count: usize,
    /// The first of them, in the order of their keys.
    fields: Vec<FieldKey>,
}

/// Shows the fields that get no values any more where a source is removed.
#[utoipa::path(
    get,
    path = "/sources/{sourceId}/use",
    tag = "sources",
    params(("sourceId" = String, Path)),
    responses((status = 200, body = SourceUse), Problems)
)]
pub async fn show_source_use(
    _: Viewer,
    State(api): State<Api>,
    ApiPath(id): ApiPath<SourceId>,
) -> Result<Json<SourceUse>, Problem> {
    let query = move |state: &ConnectorState| queries::fields_of_source(state, id.as_str());
    let mut fields = api.coordinator.read(query).await?;
    let field_count = fields.len();
    fields.truncate(FIELDS_SHOWN);
    Ok(Json(SourceUse { field_count, fields }))
}

/// Removes a source; mappings that use it keep their last value with a status that says so.
#[utoipa::path(
    delete,
    path = "/sources/{sourceId}",
    tag = "sources",
    params(("sourceId" = String, Path)),
    responses((status = 204, description = "Removed"), Problems)
)]
pub async fn remove_source(
    _: Engineer,
    State(api): State<Api>,
    ApiPath(id): ApiPath<SourceId>,
) -> Result<StatusCode, Problem> {
    let source_id = id.to_string();
    api.coordinator.execute(move |_, _| configuration::remove_source(source_id)).await?;
    api.shop_floor.remove_source(&id);
    Ok(StatusCode::NO_CONTENT)
}

/// Page of a node's children.
#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct NodesQuery {
    /// Node whose children are listed; the Objects folder without it.
    parent: Option<NodeId>,
    /// `nextCursor` of the page before.
    #[param(value_type = Option<String>)]
    cursor: Option<usize>,
    /// Children per page, 500 without it, at most 1000.
    limit: Option<usize>,
}

/// Browses a source's address space.
#[utoipa::path(
    get,
    path = "/sources/{sourceId}/nodes",
    tag = "sources",
    params(("sourceId" = String, Path), NodesQuery),
    responses((status = 200, body = Page<BrowsedNode>), Problems)
)]
pub async fn browse_source(
    user: Viewer,
    State(api): State<Api>,
    ApiPath(id): ApiPath<SourceId>,
    ApiQuery(query): ApiQuery<NodesQuery>,
) -> Result<Json<Page<BrowsedNode>>, Problem> {
    let limit = query.limit.unwrap_or(CHILDREN).clamp(1, CHILDREN_MAX);
    let from = query.cursor.unwrap_or(0);
    let _turn = api.machine_turns.take(&id, &user.principal.user_name).await?;
    let browsed = api.shop_floor.browse_from(&id, query.parent.as_ref(), from, limit);
    let (items, next) = browsed.await.map_err(shop_floor)?;
    Ok(Json(Page { items, next_cursor: next.map(|next| next.to_string()) }))
}

/// Variables that one request reads.
const VARIABLES_MAX: usize = 100;

/// Variables to read.
#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct VariablesBody {
    /// Node ids of the variables, at most 100.
    nodes: Vec<NodeId>,
}

impl VariablesBody {
    /// Checks the number of variables.
    ///
    /// # Errors
    /// 422 `TOO_MANY_VARIABLES`.
    pub fn check(&self) -> Result<(), Problem> {
        if self.nodes.len() <= VARIABLES_MAX {
            return Ok(());
        }
        let detail = format!("One request reads {VARIABLES_MAX} variables at most.");
        Err(Problem::unprocessable("TOO_MANY_VARIABLES", detail, Vec::new())
            .with("most", VARIABLES_MAX))
    }
}

/// Reads variables of a source, in the order of the request and in one turn. The values are those of the machine, before
/// any policy.
#[utoipa::path(
    post,
    path = "/sources/{sourceId}/values",
    tag = "sources",
    params(("sourceId" = String, Path)),
    request_body = VariablesBody,
    responses((status = 200, body = Page<ShownValue>), Problems)
)]
pub async fn read_source_values(
    user: Engineer,
    State(api): State<Api>,
    ApiPath(id): ApiPath<SourceId>,
    ApiJson(body): ApiJson<VariablesBody>,
) -> Result<Json<Page<ShownValue>>, Problem> {
    body.check()?;
    let _turn = api.machine_turns.take(&id, &user.principal.user_name).await?;
    let values = api.shop_floor.read(&id, &body.nodes).await.map_err(shop_floor)?;
    let shown = values.iter().map(|value| ShownValue::before_gate(value, BeforeGate::from(&user)));
    Ok(Json(Page::whole(shown.collect())))
}

/// Lists the certificates that servers have shown.
#[utoipa::path(
    get,
    path = "/source-certificates",
    tag = "sources",
    responses((status = 200, body = Page<PeerCertificate>), Problems)
)]
pub async fn list_source_certificates(
    _: Viewer,
    State(api): State<Api>,
) -> Result<Json<Page<PeerCertificate>>, Problem> {
    Ok(Json(Page::whole(api.shop_floor.certificates().await.map_err(shop_floor)?)))
}

/// Approval of a server's certificate.
#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct TrustBody {
    /// True: connections to the server are allowed.
    is_trusted: bool,
}

/// Trusts or rejects a server's certificate.
#[utoipa::path(
    put,
    path = "/source-certificates/{thumbprint}",
    tag = "sources",
    params(("thumbprint" = String, Path)),
    request_body = TrustBody,
    responses((status = 200, body = PeerCertificate), Problems)
)]
pub async fn trust_source_certificate(
    _: Engineer,
    State(api): State<Api>,
    ApiPath(thumbprint): ApiPath<String>,
    ApiJson(body): ApiJson<TrustBody>,
) -> Result<Json<PeerCertificate>, Problem> {
    let trust = if body.is_trusted { TrustState::Trusted } else { TrustState::Rejected };
    Ok(Json(api.shop_floor.set_trust(&thumbprint, trust).await.map_err(shop_floor)?))
}
