//! Bodies of requests, read as each operation reads its own, and judged as far as that needs no store: what anybody
//! can send before anything of the platform's is looked at. For the fuzz target, and the test that replays its inputs.

use asi_model::network::{DynamicDataRequest, OperationNetwork};
use axum::{
    body::Body,
    extract::{FromRequest as _, Request},
    http::header::CONTENT_TYPE,
};
use daemon::web::{
    ApiJson, Problem,
    session::{
        NewPasskey, PasskeyBegin, PasskeyRemoval, PasswordChange, SecondFactorBegin,
        SecondFactorCode, SecondFactorRemoval, SignIn,
    },
};
use serde::de::DeserializeOwned;

use super::{
    collaborations::NewCollaboration, comments::AddComment, enrolments::Enrol,
    factories::NewFactory, leases::Handover, networks::PutBody, organisations::NewOrganisation,
    problems::faulty, tools::NewTool, users::PutUser,
};
use crate::networks::structure_faults;

/// Ids of the operations with a body.
pub const OPERATIONS: [&str; 18] = [
    "signIn",
    "enrol",
    "putOperationNetwork",
    "addDynamicDataRequest",
    "addComment",
    "addOrganisation",
    "addFactory",
    "addTool",
    "addCollaboration",
    "putUser",
    "handLeaseOver",
    "changePassword",
    "beginSecondFactor",
    "confirmSecondFactor",
    "removeSecondFactor",
    "beginPasskey",
    "addPasskey",
    "removePasskey",
];

/// Reads a body as an operation does; none for an operation without a body.
pub async fn read(operation: &str, body: Vec<u8>) -> Option<Result<(), Problem>> {
    Some(match operation {
        "signIn" => of::<SignIn>(body).await.map(drop),
        "enrol" => of::<Enrol>(body).await.and_then(|body| body.signing_key().map(drop)),
        "putOperationNetwork" => of::<PutBody>(body).await.and_then(|body| network(&body)),
        "addDynamicDataRequest" => of::<DynamicDataRequest>(body).await.and_then(request),
        "addComment" => of::<AddComment>(body).await.and_then(|body| body.check()),
        "addOrganisation" => of::<NewOrganisation>(body).await.map(drop),
        "addFactory" => of::<NewFactory>(body).await.map(drop),
        "addTool" => of::<NewTool>(body).await.map(drop),
        "addCollaboration" => of::<NewCollaboration>(body).await.map(drop),
        "putUser" => of::<PutUser>(body).await.map(drop),
        "handLeaseOver" => of::<Handover>(body).await.map(drop),
        "changePassword" => of::<PasswordChange>(body).await.map(drop),
        "beginSecondFactor" => of::<SecondFactorBegin>(body).await.map(drop),
        "confirmSecondFactor" => of::<SecondFactorCode>(body).await.map(drop),
        "removeSecondFactor" => of::<SecondFactorRemoval>(body).await.map(drop),
        "beginPasskey" => of::<PasskeyBegin>(body).await.map(drop),
        "addPasskey" => of::<NewPasskey>(body).await.and_then(|body| body.check_form()),
        "removePasskey" => of::<PasskeyRemoval>(body).await.map(drop),
        _ => return None,
    })
}

/// Extracts a body as a handler does.
async fn of<T: DeserializeOwned>(body: Vec<u8>) -> Result<T, Problem> {
    let request = Request::post("/").header(CONTENT_TYPE, "application/json");
    let request = request.body(Body::from(body)).map_err(|error| Problem::internal(&error))?;
    ApiJson::from_request(request, &()).await.map(|ApiJson(body)| body)
}

/// Judges a network that is to be drawn.
fn network(body: &PutBody) -> Result<(), Problem> {
    structure(&body.network()?, "/operationNetwork")
}

/// Judges a request as part of an operation that has no other.
fn request(request: DynamicDataRequest) -> Result<(), Problem> {
    let network = serde_json::json!({ "operationNetworkId": "Network", "operationList": [ {
        "operationId": "Operation", "operationType": "PRODUCTION", "owningFactoryId": "Factory",
        "dynamicDataRequestList": [request] } ] });
    // What was read as a request is written and read as a part of a network.
    let network = serde_json::from_value(network).map_err(|error| Problem::internal(&error))?;
    structure(&network, "")
}

fn structure(network: &OperationNetwork, prefix: &str) -> Result<(), Problem> {
    let faults = structure_faults(network);
    if faults.is_empty() { Ok(()) } else { Err(faulty(faults, prefix)) }
}
