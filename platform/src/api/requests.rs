//! Single dynamic data requests.

use asi_model::{
    DynamicDataRequestId, OperationId, OperationNetworkId, network::DynamicDataRequest,
};
use axum::{Json, extract::State};
use daemon::web::{ApiJson, ApiPath, Problem, session::SignedIn};

use super::{
    networks::{Changed, commit},
    problems::ChangeProblems,
};
use crate::{
    application::Application,
    networks::{Author, add_request, remove_request},
    principal::Principal,
};

/// Adds a dynamic data request to an operation: a new revision goes to its factory.
#[utoipa::path(post, operation_id = "addDynamicDataRequest", path = "/operation-networks/{operationNetworkId}/operations/{operationId}/requests",
    tag = "networks", security(("session" = [])),
    params(("operationNetworkId" = String, Path), ("operationId" = String, Path)),
    request_body = DynamicDataRequest,
    responses((status = 200, body = Changed), ChangeProblems))]
pub async fn add(
    State(app): State<Application>,
    who: SignedIn<Principal>,
    ApiPath((network, operation)): ApiPath<(OperationNetworkId, OperationId)>,
    ApiJson(request): ApiJson<DynamicDataRequest>,
) -> Result<Json<Changed>, Problem> {
    let author = Author::user(&who.principal, app.clock.now());
    let id = request.dynamic_data_request_id.clone();
    let mut work = app.store.begin(&who.principal, "addDynamicDataRequest").await?;
    let outcome =
        add_request(&mut work, &network, &operation, request, &author, app.resend_after()).await?;
    let path = format!("operation-networks/{network}/operations/{operation}/requests/{id}");
    Ok(Json(commit(&app, work, path, outcome).await?))
}

/// Removes a dynamic data request of the own organisation: nodes and mappings go at the factory,
/// the history stays.
#[utoipa::path(delete, operation_id = "removeDynamicDataRequest",
    path = "/operation-networks/{operationNetworkId}/operations/{operationId}/requests/{dynamicDataRequestId}",
    tag = "networks", security(("session" = [])),
    params(("operationNetworkId" = String, Path), ("operationId" = String, Path),
        ("dynamicDataRequestId" = String, Path)),
    responses((status = 200, body = Changed), ChangeProblems))]
pub async fn remove(
    State(app): State<Application>,
    who: SignedIn<Principal>,
    ApiPath((network, operation, request)): ApiPath<(
        OperationNetworkId,
        OperationId,
        DynamicDataRequestId,
    )>,
) -> Result<Json<Changed>, Problem> {
    let author = Author::user(&who.principal, app.clock.now());
    let mut work = app.store.begin(&who.principal, "removeDynamicDataRequest").await?;
    let outcome =
        remove_request(&mut work, &network, &operation, &request, &author, app.resend_after())
            .await?;
    let path = format!("operation-networks/{network}/operations/{operation}/requests/{request}");
    Ok(Json(commit(&app, work, path, outcome).await?))
}
