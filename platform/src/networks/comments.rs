//! Comments of members: who may write one is who may read it.

use asi_model::messages::{Comment, PlatformMessage};

use super::{author::Author, notifications::comment_added, parts::outgoing};
use crate::{
    clock::new_message_id,
    live::Notification,
    store::{NewComment, StoreError, Work},
};

/// Most comments of a person on one network.
const COMMENTS_PER_PERSON_MAX: u64 = 2_000;

/// Refusal of a comment.
#[derive(Debug, thiserror::Error)]
pub enum CommentError {
    /// The author sees nothing of such a network.
    #[error("there is no such network")]
    NoNetwork,
    /// The author only looks on, or may not read such comments.
    #[error("the role or the organisation does not allow it")]
    NotAllowed,
    /// The author sees no part of the factory in the network.
    #[error("the factory has no part in the network")]
    NoFactory,
    /// The author sees no such request to the factory.
    #[error("the factory is not asked by such a request")]
    NoRequest,
    /// The author wrote as many comments on the network as a person may.
    #[error(
        "you have written {COMMENTS_PER_PERSON_MAX} comments on this network, the most allowed"
    )]
    TooMany,
    #[error("the store failed")]
    Store(#[from] StoreError),
}

/// Stores a comment of a member and sends it to the factory. Returns the event to publish after
/// the commit.
///
/// # Errors
/// [`CommentError`]; then the work must be dropped.
pub async fn add_comment(
    work: &mut Work,
    comment: &NewComment,
    author: &Author,
) -> Result<Notification, CommentError> {
    let id = &comment.operation_network_id;
    let row = work.networks().lookup(&author.scope, id).await?.ok_or(CommentError::NoNetwork)?;
    if !author.may_plan {
        return Err(CommentError::NotAllowed);
    }
    let parts = work.parts().seen(&author.scope, id).await?;
    if !parts.iter().any(|seen| seen.part.factory_id == comment.factory_id) {
        return Err(CommentError::NoFactory);
    }
    if let Some(wanted) = &comment.dynamic_data_request_id {
        let is_asked = row.network.requests().any(|(key, operation, _)| {
            key.dynamic_data_request_id == *wanted
                && operation.owning_factory_id.as_ref() == Some(&comment.factory_id)
        });
        if !is_asked {
            return Err(CommentError::NoRequest);
        }
    }
    let written = work.quotas().comments_of_person(id, &comment.author_id).await?;
    if written.rows >= COMMENTS_PER_PERSON_MAX {
        return Err(CommentError::TooMany);
    }
    work.comments().add(comment).await?;
    let event = comment_added(work, id, &comment.comment_id).await?;
    let is_reader = author.organisation_id.as_ref().is_some_and(|id| event.audience.contains(id));
    if !is_reader && !author.is_administrator {
        return Err(CommentError::NotAllowed);
    }
    let message = PlatformMessage::Comment(Comment {
        message_id: new_message_id(),
        factory_id: comment.factory_id.clone(),
        operation_network_id: id.clone(),
        dynamic_data_request_id: comment.dynamic_data_request_id.clone(),
        field_name: comment.field_name.clone(),
        author_id: with_organisation(&comment.author_id, author),
        text: comment.text.clone(),
    });
    work.outgoing().add(&outgoing(&comment.factory_id, &message, author.now)).await?;
    Ok(event)
}

/// Returns a person's name with the organisation, which the platform vouches for: a plant knows the people of
/// no other company.
fn with_organisation(user: &str, author: &Author) -> String {
    match &author.organisation_id {
        Some(organisation) => format!("{user}@{organisation}"),
        None => user.to_owned(),
    }
}
