//! Comments on networks.

use asi_model::{
    DynamicDataRequestId, FactoryId, FieldName, OperationNetworkId,
    messages::{Comment, PlatformMessage},
};
use axum::{Json, extract::State, http::StatusCode};
use daemon::web::{ApiJson, ApiPath, ApiQuery, Problem, session::SignedIn};
use serde::Deserialize;
use utoipa::ToSchema;

use super::{
    page::{Page, PageQuery},
    problems::{ChangeProblems, ReadProblems, unknown_reference},
};
use crate::{
    application::Application,
    clock::new_message_id,
    live::LiveEvent,
    networks::outgoing,
    principal::Principal,
    store::{CommentEntry, NewComment, Scope},
};

/// A comment to add.
#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct AddComment {
    /// The factory to talk to; one that has a part in the network.
    factory_id: FactoryId,
    /// The request that the comment is about.
    dynamic_data_request_id: Option<DynamicDataRequestId>,
    /// The field that the comment is about.
    field_name: Option<FieldName>,
    /// Text, 1 to 10000 characters.
    text: String,
}

/// Lists the comments on a network, oldest first.
#[utoipa::path(get, operation_id = "listComments", path = "/operation-networks/{operationNetworkId}/comments", tag = "networks",
    security(("session" = [])), params(("operationNetworkId" = String, Path), PageQuery),
    responses((status = 200, body = Page<CommentEntry>), ReadProblems))]
pub async fn list(
    State(app): State<Application>,
    who: SignedIn<Principal>,
    ApiPath(id): ApiPath<OperationNetworkId>,
    ApiQuery(page): ApiQuery<PageQuery>,
) -> Result<Json<Page<CommentEntry>>, Problem> {
    let scope = who.principal.scope();
    let mut work = app.store.read().await?;
    let known = work.networks().lookup(&scope, &id).await?;
    known.ok_or_else(|| Problem::not_found(format_args!("operation network {id}")))?;
    let comments =
        work.comments().list(&scope, &id, page.after().unwrap_or(0), page.limit()).await?;
    Ok(Json(Page::new(comments, page.limit(), |comment| comment.comment_id.to_string())))
}

/// Adds a comment; it is sent to the factory.
#[utoipa::path(post, operation_id = "addComment", path = "/operation-networks/{operationNetworkId}/comments", tag = "networks",
    security(("session" = [])), params(("operationNetworkId" = String, Path)), request_body = AddComment,
    responses((status = 201, body = CommentEntry), ChangeProblems))]
pub async fn add(
    State(app): State<Application>,
    who: SignedIn<Principal>,
    ApiPath(id): ApiPath<OperationNetworkId>,
    ApiJson(body): ApiJson<AddComment>,
) -> Result<(StatusCode, Json<CommentEntry>), Problem> {
    let now = app.clock.now();
    let length = body.text.chars().count();
    if !(1..=10_000).contains(&length) {
        return Err(Problem::unprocessable(
            "INVALID_TEXT",
            "A comment has 1 to 10000 characters.",
            Vec::new(),
        ));
    }
    let mut work = app.store.begin().await?;
    let network = work.networks().lookup(&who.principal.scope(), &id).await?;
    let network =
        network.ok_or_else(|| Problem::not_found(format_args!("operation network {id}")))?;
    if !who.principal.may_plan() {
        return Err(Problem::forbidden("This needs the role of a planner."));
    }
    if !work.parts().of_network(&id).await?.iter().any(|part| part.factory_id == body.factory_id) {
        return Err(unknown_reference("/factoryId", "part of that factory in the network"));
    }
    let comment = NewComment {
        operation_network_id: id.clone(),
        factory_id: body.factory_id.clone(),
        dynamic_data_request_id: body.dynamic_data_request_id.clone(),
        field_name: body.field_name.clone(),
        author_id: who.principal.user.user_name.clone(),
        is_from_factory: false,
        text: body.text.clone(),
        created_at: now,
    };
    let comment_id = work.comments().add(&comment).await?;
    let message = PlatformMessage::Comment(Comment {
        message_id: new_message_id(),
        factory_id: body.factory_id.clone(),
        operation_network_id: id.clone(),
        dynamic_data_request_id: body.dynamic_data_request_id,
        field_name: body.field_name,
        author_id: comment.author_id.clone(),
        text: body.text,
    });
    work.outgoing().add(&outgoing(&body.factory_id, &message, now)).await?;
    let collaboration =
        work.collaborations().lookup(&Scope::Platform, &network.collaboration_id).await?;
    work.commit().await?;
    app.broker_access.wake_link();
    let members = collaboration.map(|collaboration| collaboration.members).unwrap_or_default();
    app.live.publish([LiveEvent::Comment { operation_network_id: id, comment_id }.to(members)]);
    let entry = CommentEntry {
        comment_id,
        factory_id: comment.factory_id,
        dynamic_data_request_id: comment.dynamic_data_request_id,
        field_name: comment.field_name,
        author_id: comment.author_id,
        is_from_factory: false,
        text: comment.text,
        created_at: now,
    };
    Ok((StatusCode::CREATED, Json(entry)))
}
