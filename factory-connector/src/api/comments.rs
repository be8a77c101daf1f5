//! Comments of this factory and its partners about a network.

use asi_model::{DynamicDataRequestId, FieldName, OperationNetworkId, messages::Comment};
use axum::{Json, extract::State, http::StatusCode};
use connector_state::use_cases::comments::write_comment;
use daemon::web::{ApiJson, ApiPath, Problem};
use serde::Deserialize;
use utoipa::ToSchema;

use super::{
    context::Api,
    problems::Problems,
    roles::{Operator, Viewer},
    view::Page,
};
use crate::{clock::new_message_id, store::StoredComment};

/// Longest comment, in characters.
const TEXT_CHARS_MAX: usize = 4000;

/// Lists the comments about a network, oldest first.
#[utoipa::path(
    get,
    path = "/operation-networks/{operationNetworkId}/comments",
    tag = "inbox",
    params(("operationNetworkId" = String, Path)),
    responses((status = 200, body = Page<StoredComment>), Problems)
)]
pub async fn list_comments(
    _: Viewer,
    State(api): State<Api>,
    ApiPath(id): ApiPath<OperationNetworkId>,
) -> Result<Json<Page<StoredComment>>, Problem> {
    Ok(Json(Page::whole(api.store().await?.comments().of_network(&id).await?)))
}

/// A comment to send.
#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct NewComment {
    dynamic_data_request_id: Option<DynamicDataRequestId>,
    field_name: Option<FieldName>,
    text: String,
}

impl NewComment {
    /// Returns the problem of a text that is none.
    pub(super) fn check(&self) -> Result<(), Problem> {
        if self.text.trim().is_empty() || self.text.chars().count() > TEXT_CHARS_MAX {
            return Err(Problem::bad_request(
                "INVALID_TEXT",
                "A comment has 1 to 4000 characters.",
            ));
        }
        Ok(())
    }
}

/// Sends a comment to the partners of a network.
#[utoipa::path(
    post,
    path = "/operation-networks/{operationNetworkId}/comments",
    tag = "inbox",
    params(("operationNetworkId" = String, Path)),
    request_body = NewComment,
    responses((status = 204, description = "Stored and queued"), Problems)
)]
pub async fn add_comment(
    user: Operator,
    State(api): State<Api>,
    ApiPath(id): ApiPath<OperationNetworkId>,
    ApiJson(new): ApiJson<NewComment>,
) -> Result<StatusCode, Problem> {
    new.check()?;
    let network = id.clone();
    let is_known =
        api.coordinator.read(move |state| state.networks().get(&network).is_some()).await?;
    if !is_known {
        return Err(Problem::not_found(format_args!("operation network {id}")));
    }
    let comment = Comment {
        message_id: new_message_id(),
        factory_id: api.instance.factory_id.clone(),
        operation_network_id: id,
        dynamic_data_request_id: new.dynamic_data_request_id,
        field_name: new.field_name,
        author_id: user.principal.user_name.clone(),
        text: new.text,
    };
    api.coordinator.execute(|state, now| write_comment(state, comment, now)).await?;
    Ok(StatusCode::NO_CONTENT)
}
