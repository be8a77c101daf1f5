//! Comments of people about a network, a request or a field.

use asi_model::{
    DateTime, DynamicDataRequestId, FactoryId, FieldName, OperationNetworkId, OrganisationId,
};
use serde::Serialize;
use utoipa::ToSchema;

use super::{
    database::Connection,
    error::StoreError,
    row::{Columns, DatabaseRow},
    scope::Scope,
};
use crate::opaque_id::OpaqueId;

/// A comment to store.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NewComment {
    pub comment_id: OpaqueId,
    /// The network talked about.
    pub operation_network_id: OperationNetworkId,
    /// The factory with whose people the comments are exchanged.
    pub factory_id: FactoryId,
    /// The request that the comment is about.
    pub dynamic_data_request_id: Option<DynamicDataRequestId>,
    /// The field that the comment is about.
    pub field_name: Option<FieldName>,
    /// User name of the author; where a factory states it, with the factory: `engineer@FOR_MUC`.
    pub author_id: String,
    /// True if it came from the factory's connector.
    pub is_from_factory: bool,
    pub text: String,
    /// Time of arrival at the platform.
    pub created_at: DateTime,
}

/// A comment as those who take part see it: about a request its requester and the factory, about the
/// network its drawer and the factory.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct CommentEntry {
    pub comment_id: OpaqueId,
    /// The factory with whose people the comments are exchanged.
    pub factory_id: FactoryId,
    /// The request that the comment is about.
    pub dynamic_data_request_id: Option<DynamicDataRequestId>,
    /// The field that the comment is about.
    pub field_name: Option<FieldName>,
    /// User name of the author; where a factory states it, with the factory: `engineer@FOR_MUC`.
    pub author_id: String,
    /// True if it came from the factory's connector.
    pub is_from_factory: bool,
    pub text: String,
    /// Time of arrival at the platform.
    pub created_at: DateTime,
}

/// Condition on a row `c` of `comment`: it is on the network `$2`, and the viewer `$1` may read it.
macro_rules! readable {
    () => {
        "c.operation_network_id = $2 AND (CAST($1 AS TEXT) IS NULL OR EXISTS (
             SELECT 1 FROM comment_reader r WHERE r.comment_id = c.comment_id AND r.organisation_id = $1))"
    };
}

/// Repository of comments.
pub struct Comments<'w>(pub(super) &'w mut Connection);

impl Comments<'_> {
    /// Stores a comment.
    ///
    /// # Errors
    /// [`StoreError::Statement`], as for an unknown network.
    pub async fn add(&mut self, comment: &NewComment) -> Result<(), StoreError> {
        let sql = "INSERT INTO comment (operation_network_id, factory_id, dynamic_data_request_id, field_name,
                       author_id, is_from_factory, text, created_at, opaque_id)
                   VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9)";
        sqlx::query(sql)
            .bind(comment.operation_network_id.as_str())
            .bind(comment.factory_id.as_str())
            .bind(comment.dynamic_data_request_id.as_ref().map(DynamicDataRequestId::as_str))
            .bind(comment.field_name.as_ref().map(FieldName::as_str))
            .bind(&comment.author_id)
            .bind(i64::from(comment.is_from_factory))
            .bind(&comment.text)
            .bind(comment.created_at.ticks())
            .bind(comment.comment_id.as_str())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("store a comment"))?;
        Ok(())
    }

    /// Returns the comments on a network that the viewer may read, oldest first, those that came after
    /// `after`. One that the viewer may not read is like one that never came: it restricts nothing.
    /// Administrators read what their organisation may.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn list(
        &mut self,
        scope: &Scope,
        network: &OperationNetworkId,
        after: Option<&OpaqueId>,
        limit: u32,
    ) -> Result<Vec<CommentEntry>, StoreError> {
        let sql = concat!(
            "SELECT c.* FROM comment c WHERE ",
            readable!(),
            " AND c.comment_id > COALESCE(
                  (SELECT c.comment_id FROM comment c WHERE c.opaque_id = $3 AND ",
            readable!(),
            "), 0) ORDER BY c.comment_id LIMIT $4"
        );
        let rows = sqlx::query(sql)
            .bind(scope.recipient())
            .bind(network.as_str())
            .bind(after.map(OpaqueId::as_str))
            .bind(i64::from(limit))
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during("list comments"))?;
        rows.iter().map(read).collect()
    }

    /// Lists the organisations that may read a comment, by id.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn readers(&mut self, comment: &OpaqueId) -> Result<Vec<OrganisationId>, StoreError> {
        let sql = "SELECT r.organisation_id FROM comment_reader r
                   JOIN comment c ON c.comment_id = r.comment_id WHERE c.opaque_id = $1
                   ORDER BY r.organisation_id";
        let rows = sqlx::query(sql)
            .bind(comment.as_str())
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during("list the readers of a comment"))?;
        rows.iter().map(|row| row.parsed("organisation_id")).collect()
    }
}

fn read(row: &DatabaseRow) -> Result<CommentEntry, StoreError> {
    Ok(CommentEntry {
        comment_id: row.parsed("opaque_id")?,
        factory_id: row.parsed("factory_id")?,
        dynamic_data_request_id: row.parsed_option("dynamic_data_request_id")?,
        field_name: row.parsed_option("field_name")?,
        author_id: row.column("author_id")?,
        is_from_factory: row.unsigned::<u8>("is_from_factory")? != 0,
        text: row.column("text")?,
        created_at: row.time("created_at")?,
    })
}
