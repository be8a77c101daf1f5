//! Comments on networks.

use asi_model::{DynamicDataRequestId, FactoryId, FieldName, OperationNetworkId};
use axum::{Json, extract::State, http::StatusCode};
use daemon::web::{
    ApiJson, ApiPath, ApiQuery, Problem,
    session::SignedIn,
    shares::{ShareOwner, count_refusal},
};
use serde::Deserialize;
use utoipa::ToSchema;

use super::{
    page::{Page, PageQuery},
    problems::{ChangeProblems, ReadProblems, quota_exceeded, unknown_reference},
};
use crate::{
    application::Application,
    clock::new_opaque_id,
    networks::{Author, CommentError, add_comment},
    principal::Principal,
    store::{AuditFact, AuditFactKind, AuditOutcome, AuditSubject, CommentEntry, NewComment},
};

/// A comment to add.
#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct AddComment {
    /// The factory that the comment is for; one that has a part in the network.
    factory_id: FactoryId,
    /// The request that the comment is about.
    dynamic_data_request_id: Option<DynamicDataRequestId>,
    /// The field that the comment is about.
    field_name: Option<FieldName>,
    /// Text, 1 to 10000 characters.
    text: String,
}

impl AddComment {
    /// Judges the length of the text.
    pub(super) fn check(&self) -> Result<(), Problem> {
        let length = self.text.chars().count();
        if (1..=10_000).contains(&length) {
            return Ok(());
        }
        let detail = "A comment has 1 to 10000 characters.";
        Err(Problem::unprocessable("INVALID_TEXT", detail, Vec::new()))
    }
}

/// Lists the comments on a network that the viewer may read, oldest first: about a request for its
/// requester and the factory, about the network for its drawer and the factory.
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
    let after = page.after_id();
    let comments = work.comments().list(&scope, &id, after.as_ref(), page.limit()).await?;
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
    body.check()?;
    let comment = NewComment {
        comment_id: new_opaque_id(),
        operation_network_id: id,
        factory_id: body.factory_id,
        dynamic_data_request_id: body.dynamic_data_request_id,
        field_name: body.field_name,
        author_id: who.principal.user.user_name.clone(),
        is_from_factory: false,
        text: body.text,
        created_at: now,
    };
    let author = Author::user(&who.principal, now);
    let mut work = app.store.begin(&who.principal, "addComment").await?;
    let added = add_comment(&mut work, &comment, &author).await;
    let event = added.map_err(|error| refused(error, &comment))?;
    let NewComment { operation_network_id: network, comment_id, .. } = &comment;
    let path = format!("operation-networks/{network}/comments/{comment_id}");
    work.describe([AuditFact::new(AuditFactKind::Factory, &comment.factory_id)]);
    let request = comment.dynamic_data_request_id.as_ref();
    work.describe(request.map(|id| AuditFact::new(AuditFactKind::Request, id)));
    work.commit(AuditSubject::shared(path), AuditOutcome::Done).await?;
    app.broker_access.wake_link();
    app.live.publish([event]);
    let entry = CommentEntry {
        comment_id: comment.comment_id,
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

fn refused(error: CommentError, comment: &NewComment) -> Problem {
    match error {
        CommentError::NoNetwork => {
            Problem::not_found(format_args!("operation network {}", comment.operation_network_id))
        }
        CommentError::NotAllowed => Problem::forbidden(
            "This needs a planner of the organisation that asks, that drew the network, or whose factory it is.",
        ),
        CommentError::NoFactory => {
            unknown_reference("/factoryId", "part of that factory in the network")
        }
        CommentError::NoRequest => {
            unknown_reference("/dynamicDataRequestId", "such request to that factory")
        }
        CommentError::TooMany => {
            count_refusal("comments", ShareOwner::Person(&comment.author_id));
            quota_exceeded(&error.to_string())
        }
        CommentError::Store(error) => Problem::internal(&error),
    }
}
