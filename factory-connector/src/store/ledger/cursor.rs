//! Walk through all chains in their order, for an export.

use std::collections::VecDeque;

use sqlx::SqliteConnection;

use super::{
    entries::{self, LedgerRow},
    heads,
    precision::Precisions,
    selection::{EntryRange, LedgerFilter},
};
use crate::store::error::StoreError;

/// Entries read at once. A ledger does not fit into memory.
const BLOCK: u32 = 1000;

/// Position of an export in the chains.
#[derive(Default)]
pub struct LedgerCursor {
    filter: LedgerFilter,
    /// Chains that are not exported yet; `None` before the first entry.
    chains: Option<VecDeque<String>>,
    /// Number of the last exported entry of the first chain.
    last: u64,
    precisions: Precisions,
}

impl LedgerCursor {
    /// Begins before the first entry that the filter selects.
    #[must_use]
    pub fn new(filter: LedgerFilter) -> Self {
        Self { filter, ..Self::default() }
    }

    pub(super) async fn next(
        &mut self,
        connection: &mut SqliteConnection,
    ) -> Result<Vec<LedgerRow>, StoreError> {
        let chains = match (&mut self.chains, &self.filter.recipient) {
            (Some(chains), _) => chains,
            (unknown, Some(recipient)) => unknown.insert([recipient.to_string()].into()),
            (unknown, None) => unknown.insert(heads::recipients(connection).await?.into()),
        };
        while let Some(recipient) = chains.front() {
            let window = EntryRange::After(crate::store::row::signed(self.last));
            let precisions = &mut self.precisions;
            let rows =
                entries::read(connection, recipient, &self.filter, window, BLOCK, precisions)
                    .await?;
            if let Some(row) = rows.last() {
                self.last = row.number;
                return Ok(rows);
            }
            self.last = 0;
            chains.pop_front();
        }
        Ok(Vec::new())
    }
}
