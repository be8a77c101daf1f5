//! Writing of users and second factors, beside the connector's transactions.

use std::path::PathBuf;

use daemon::web::Problem;

use crate::store::{Store, StoreError, StoreSession};

/// Writes into the store of a folder, each time with a connection and a thread of its own.
#[derive(Clone)]
pub struct StoreWriter {
    directory: PathBuf,
}

/// Failure to write.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The store failed.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// The thread broke off.
    #[error("writing broke off")]
    Broken(#[source] tokio::task::JoinError),
}

impl StoreWriter {
    /// Returns a writer of the store in this folder.
    pub const fn new(directory: PathBuf) -> Self {
        Self { directory }
    }

    /// Runs work on a connection and a thread of its own.
    ///
    /// # Errors
    /// [`WriteError`].
    pub async fn write<T, W, F>(&self, work: W) -> Result<T, WriteError>
    where
        T: Send + 'static,
        W: FnOnce(StoreSession) -> F + Send + 'static,
        F: Future<Output = Result<T, StoreError>>,
    {
        let (directory, runtime) = (self.directory.clone(), tokio::runtime::Handle::current());
        let done = tokio::task::spawn_blocking(move || {
            runtime.block_on(async { work(Store::connect(&directory).await?).await })
        });
        Ok(done.await.map_err(WriteError::Broken)??)
    }
}

impl From<WriteError> for Problem {
    fn from(error: WriteError) -> Self {
        Self::internal(&error)
    }
}
