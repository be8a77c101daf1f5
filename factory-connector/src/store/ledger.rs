//! The ledger: one chain of entries per recipient, with everything that proves it.

mod anchors;
mod audit;
mod basis;
mod checkpoints;
mod cursor;
mod entries;
mod heads;
mod logs;
mod precision;
mod pruning;
mod seal;
mod selection;
mod verification;
mod witnessed;

use ::ledger::{
    Anchor, Hash, Head, Heads, LedgerKey, Logs, Verification,
    audit::{AuditEntry, AuditStart},
};
use asi_model::{DateTime, FieldKey, OrganisationId};
pub use audit::LogCheckpoint;
pub(super) use checkpoints::write as write_checkpoint;
pub use checkpoints::{Checkpoints, StoredCheckpoint};
use connector_state::{FormerRetention, use_cases::retain::OldEntries};
pub use cursor::LedgerCursor;
pub use entries::LedgerRow;
pub(super) use entries::write as write_entries;
pub(super) use heads::write as write_heads;
pub(super) use logs::write as write_logs;
use precision::Precisions;
pub(super) use pruning::remove as remove_entries;
pub(super) use seal::write as write_seal;
use selection::EntryRange;
pub use selection::{LedgerFilter, LedgerSubject};
use sqlx::{QueryBuilder, Sqlite, SqliteConnection};
pub use verification::Trusted;
pub(super) use witnessed::write as write_witnessed;

use super::{error::StoreError, identity, query::all, reports, row::Columns as _};

/// Repository of the ledger.
pub struct Ledger<'c>(pub(crate) &'c mut SqliteConnection);

impl Ledger<'_> {
    /// Lists the recipients that have a chain, by their ids.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn recipients(&mut self) -> Result<Vec<String>, StoreError> {
        heads::recipients(self.0).await
    }

    /// Reads the ends of all chains.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn heads(&mut self) -> Result<Heads, StoreError> {
        heads::load(self.0).await
    }

    /// Reads the logs of all chains up to these heads, with what was countersigned of them. The log of a chain of a former version is
    /// computed from its entries.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn logs(&mut self, heads: &Heads) -> Result<Logs, StoreError> {
        let logs = logs::load(self.0, heads).await?;
        witnessed::add(self.0, logs).await
    }

    /// Returns the entry after which a pruned chain begins; the beginning of one that was not pruned.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn anchor(&mut self, recipient: &OrganisationId) -> Result<Head, StoreError> {
        logs::anchor(self.0, recipient).await
    }

    /// Reads the anchor of a pruned chain; `None` of one that was not pruned.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn stored_anchor(
        &mut self,
        recipient: &OrganisationId,
    ) -> Result<Option<Anchor>, StoreError> {
        logs::stored_anchor(self.0, recipient).await
    }

    /// Calls `take` with the text of each entry after a number of a chain, in order, and returns the
    /// last number.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn each_entry(
        &mut self,
        recipient: &OrganisationId,
        after: u64,
        take: &mut impl FnMut(&str),
    ) -> Result<u64, StoreError> {
        logs::each_entry(self.0, recipient, after, take).await
    }

    /// Reads the oldest entries of each chain that were recorded before a time, a bounded number.
    /// Entries about reports that the spool works with are not among them.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn old_entries(&mut self, before: DateTime) -> Result<Vec<OldEntries>, StoreError> {
        pruning::old_entries(self.0, before).await
    }

    /// Reads what former versions emptied and removed; `None` where the chains state it already.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn former_retention(&mut self) -> Result<Option<FormerRetention>, StoreError> {
        if !identity::must_state_retention(self.0).await? {
            return Ok(None);
        }
        let emptied = reports::emptied(self.0).await?;
        Ok(Some(FormerRetention { emptied, removed: anchors::numbers(self.0).await? }))
    }

    /// Begins an audit file of a recipient's chain; `None` without a log. Without the key its
    /// checkpoint is missing where entries are newer than the last one.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn audit_start(
        &mut self,
        recipient: &OrganisationId,
        key: Option<&LedgerKey>,
    ) -> Result<Option<AuditStart>, StoreError> {
        audit::start(self.0, recipient, key).await
    }

    /// Reads the next entries of an audit file after this number; empty at the end.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn audit_entries(
        &mut self,
        recipient: &OrganisationId,
        after: u64,
    ) -> Result<Vec<AuditEntry>, StoreError> {
        audit::entries(self.0, recipient, after).await
    }

    /// Returns the last checkpoint of a recipient's log; `None` before the first.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn log_checkpoint(
        &mut self,
        recipient: &OrganisationId,
    ) -> Result<Option<LogCheckpoint>, StoreError> {
        audit::checkpoint(self.0, recipient).await
    }

    /// Reads entries of one chain with smaller numbers than `before`, newest first.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn page(
        &mut self,
        recipient: &str,
        filter: &LedgerFilter,
        before: Option<u64>,
        limit: u32,
    ) -> Result<Vec<LedgerRow>, StoreError> {
        let before = before.map_or(i64::MAX, super::row::signed);
        let mut precisions = Precisions::default();
        let window = EntryRange::Before(before);
        entries::read(self.0, recipient, filter, window, limit, &mut precisions).await
    }

    /// Reads the next entries in the order of the chains; empty at the end.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn next(&mut self, cursor: &mut LedgerCursor) -> Result<Vec<LedgerRow>, StoreError> {
        cursor.next(self.0).await
    }

    /// Lists fields with entries in the ledger whose ids contain all these words, by their keys.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn fields(
        &mut self,
        words: &[String],
        limit: u32,
    ) -> Result<Vec<FieldKey>, StoreError> {
        let mut sql = QueryBuilder::<Sqlite>::new(
            "SELECT operation_network_id, operation_id, dynamic_data_request_id, field_name FROM (
                 SELECT operation_network_id, operation_id, dynamic_data_request_id, field_name
                 FROM carried_field
                 UNION
                 SELECT operation_network_id, operation_id, dynamic_data_request_id, field_name
                 FROM ledger_entry INDEXED BY ledger_by_field
                 WHERE operation_network_id IS NOT NULL)
             WHERE true",
        );
        for word in words {
            // Ids contain no line feed: a word is never found across two of them.
            sql.push(
                " AND instr(lower(operation_network_id || char(10) || operation_id || char(10)
                      || dynamic_data_request_id || char(10) || field_name), lower(",
            );
            sql.push_bind(word.clone()).push("))");
        }
        sql.push(" ORDER BY 1, 2, 3, 4 LIMIT ").push_bind(i64::from(limit));
        all(self.0, sql.build(), "read the ledger", |row| row.field_key()).await
    }

    /// Reads every chain from its beginning and finds any change, deletion or reordering. Every
    /// signature must be one of the trusted key, where one is given.
    ///
    /// # Errors
    /// [`StoreError`] where the tables cannot be read. A damaged entry is no error but a finding.
    pub async fn verify(&mut self, trusted_key: Option<Hash>) -> Result<Verification, StoreError> {
        self.verify_against(Trusted { key: trusted_key, checkpoints: Vec::new() }).await
    }

    /// Verifies the ledger against a key and checkpoints from outside of the store: they reveal that
    /// it was set back, shortened or signed again.
    ///
    /// # Errors
    /// [`StoreError`], as for [`verify`](Self::verify).
    pub async fn verify_against(&mut self, trusted: Trusted) -> Result<Verification, StoreError> {
        verification::verify(self.0, trusted).await
    }
}
