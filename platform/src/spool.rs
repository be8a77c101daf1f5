//! Outgoing messages of the store as the spool that the link reads.

use async_trait::async_trait;
use messaging::{Backlog, Envelope, Fetch, RowId, RowOutcome, SpoolError, SpoolRow, SpoolStore};

use crate::store::Store;

/// The platform's outgoing messages as a spool.
#[derive(Debug, Clone)]
pub struct StoredSpool(Store);

impl StoredSpool {
    /// Makes the link's view of this store.
    #[must_use]
    pub const fn new(store: Store) -> Self {
        Self(store)
    }
}

#[async_trait]
impl SpoolStore for StoredSpool {
    /// Messages of the platform are not signed: plants trust the broker that they signed in to.
    fn sign(&self, _: &mut Envelope) {}

    async fn fetch(&self, fetch: Fetch) -> Result<Vec<SpoolRow>, SpoolError> {
        Ok(self.0.reserved_reader().read().await?.outgoing().fetch(fetch).await?)
    }

    async fn record(&self, outcomes: Vec<RowOutcome>) -> Result<(), SpoolError> {
        let mut work = self.0.begin().await?;
        work.outgoing().record(&outcomes).await?;
        Ok(work.commit().await?)
    }

    async fn last_row(&self) -> Result<RowId, SpoolError> {
        Ok(self.0.reserved_reader().read().await?.outgoing().last_row().await?)
    }

    async fn backlog(&self) -> Result<Backlog, SpoolError> {
        Ok(self.0.reserved_reader().read().await?.outgoing().backlog().await?)
    }
}
