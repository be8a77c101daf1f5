//! Sets of organisations to whom reports were released, each stored once.

use std::collections::BTreeSet;

use asi_model::OrganisationId;

use super::{
    database::Connection,
    error::StoreError,
    row::{Columns, document},
};

/// Adds the numbers of newly released reports to those of the same writer and set.
macro_rules! add_released {
    () => {
        " ON CONFLICT (factory_id, data_set_writer_id, epoch, recipient_set_id) DO UPDATE SET
              first_sequence = CASE WHEN writer_recipient_set.first_sequence < excluded.first_sequence
                  THEN writer_recipient_set.first_sequence ELSE excluded.first_sequence END,
              through_sequence = CASE WHEN writer_recipient_set.through_sequence > excluded.through_sequence
                  THEN writer_recipient_set.through_sequence ELSE excluded.through_sequence END,
              received = writer_recipient_set.received + excluded.received,
              last_report_at = CASE WHEN writer_recipient_set.last_report_at > excluded.last_report_at
                  THEN writer_recipient_set.last_report_at ELSE excluded.last_report_at END,
              operation_network_id = excluded.operation_network_id,
              dynamic_data_request_id = excluded.dynamic_data_request_id"
    };
}
pub(super) use add_released;

/// Number of a stored set.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct RecipientSetId(pub(super) i64);

/// Repository of sets of recipients.
pub struct RecipientSets<'w>(pub(super) &'w mut Connection);

impl RecipientSets<'_> {
    /// Returns the number of a set, which is stored where it is new; `None` for the empty one.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn intern(
        &mut self,
        members: &BTreeSet<OrganisationId>,
    ) -> Result<Option<RecipientSetId>, StoreError> {
        if members.is_empty() {
            return Ok(None);
        }
        let text = document(members);
        let known = sqlx::query("SELECT recipient_set_id FROM recipient_set WHERE members = $1")
            .bind(&text)
            .fetch_optional(&mut *self.0)
            .await
            .map_err(StoreError::during("look a set of recipients up"))?;
        if let Some(row) = known {
            return Ok(Some(RecipientSetId(row.column("recipient_set_id")?)));
        }
        let sql = "INSERT INTO recipient_set (members) VALUES ($1) RETURNING recipient_set_id";
        let row = sqlx::query(sql)
            .bind(&text)
            .fetch_one(&mut *self.0)
            .await
            .map_err(StoreError::during("store a set of recipients"))?;
        let id: i64 = row.column("recipient_set_id")?;
        for member in members {
            let sql = "INSERT INTO recipient_set_member (recipient_set_id, organisation_id)
                       VALUES ($1, $2)";
            sqlx::query(sql)
                .bind(id)
                .bind(member.as_str())
                .execute(&mut *self.0)
                .await
                .map_err(StoreError::during("store a member of a set of recipients"))?;
        }
        Ok(Some(RecipientSetId(id)))
    }
}
