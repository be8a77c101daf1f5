//! Comments about networks, requests and fields, of this factory and of its partners.

use asi_model::{DateTime, DynamicDataRequestId, FieldName, OperationNetworkId};
use rusqlite::Connection;
use sqlx::{SqliteConnection, sqlite::SqliteRow};

use super::{
    CommentRow,
    error::StoreError,
    query::{all, query},
    row::Columns as _,
    statement::write_rows,
};

/// A comment as it was made.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct StoredComment {
    /// Number of the comment at this connector, counting up in the order of arrival.
    pub id: i64,
    /// The request it is about; none for the whole network.
    pub dynamic_data_request_id: Option<String>,
    /// The field it is about; none for the whole request.
    pub field_name: Option<String>,
    pub author_id: String,
    /// True if it was made at this factory.
    pub is_own: bool,
    pub text: String,
    pub written_at: DateTime,
}

/// Repository of comments.
pub struct Comments<'c>(pub(super) &'c mut SqliteConnection);

impl Comments<'_> {
    /// Reads the last thousand comments about a network, oldest first.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn of_network(
        &mut self,
        network: &OperationNetworkId,
    ) -> Result<Vec<StoredComment>, StoreError> {
        let sql =
            "SELECT id, dynamic_data_request_id, field_name, author_id, is_own, text, written_at
                   FROM (SELECT * FROM comment WHERE operation_network_id = ?
                         ORDER BY id DESC LIMIT 1000)
                   ORDER BY id";
        all(self.0, query(sql).bind(network.as_str()), "read the comments", comment).await
    }
}

fn comment(row: &SqliteRow) -> Result<StoredComment, StoreError> {
    Ok(StoredComment {
        id: row.column("id")?,
        dynamic_data_request_id: row.column("dynamic_data_request_id")?,
        field_name: row.column("field_name")?,
        author_id: row.column("author_id")?,
        is_own: row.flag("is_own")?,
        text: row.column("text")?,
        written_at: row.time("written_at")?,
    })
}

/// Stores comments; one that is stored already is left as it is.
pub(super) fn write(connection: &Connection, comments: &[CommentRow]) -> rusqlite::Result<()> {
    write_rows(
        connection,
        "INSERT OR IGNORE INTO comment (message_id, operation_network_id, dynamic_data_request_id,
             field_name, author_id, is_own, text, written_at)
         VALUES (?, ?, ?, ?, ?, ?, ?, ?)",
        comments,
        |row| {
            let comment = &row.comment;
            (
                comment.message_id.as_str(),
                comment.operation_network_id.as_str(),
                comment.dynamic_data_request_id.as_ref().map(DynamicDataRequestId::as_str),
                comment.field_name.as_ref().map(FieldName::as_str),
                &comment.author_id,
                row.is_own,
                &comment.text,
                row.written_at.unix_micros(),
            )
        },
    )
}
