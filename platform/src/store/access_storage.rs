//! The store as the place to which accesses are recorded.

use access_log::AccessLogKey;
use asi_model::DateTime;
use async_trait::async_trait;

use crate::{
    accesses::{AccessStorage, NotRecorded, Reading},
    clock::new_access_id,
    store::{connection::Store, error::StoreError},
};

/// Most logs that get a checkpoint in one transaction.
const CHECKPOINTS_PER_WORK_MAX: u32 = 1_000;

#[async_trait]
impl AccessStorage for Store {
    async fn append(&self, readings: &[Reading], now: DateTime) -> Result<(), NotRecorded> {
        let append = async {
            let mut work = self.begin().await?;
            work.accesses().append(readings, now, new_access_id).await?;
            work.commit().await
        };
        append.await.map_err(failed)
    }

    async fn sign_checkpoints(&self, key: &AccessLogKey) -> Result<(), NotRecorded> {
        let sign = async {
            let mut work = self.begin().await?;
            work.accesses().sign_checkpoints(key, CHECKPOINTS_PER_WORK_MAX).await?;
            work.commit().await
        };
        sign.await.map_err(failed)
    }
}

fn failed(error: StoreError) -> NotRecorded {
    NotRecorded::Storage(Box::new(error))
}
