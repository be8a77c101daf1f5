//! Accounts and sessions in the platform's store, as the web server reads them.

use async_trait::async_trait;
use daemon::web::session::{Accounts, AccountsError, PasswordHash, SessionId, StoredSession};

use crate::{
    clock::Clock,
    principal::Principal,
    store::{Store, StoreError, User},
};

/// Users and sessions in the platform's store.
#[derive(Debug, Clone)]
pub struct StoredAccounts {
    store: Store,
    clock: Clock,
}

impl StoredAccounts {
    /// Returns accounts over this store.
    #[must_use]
    pub const fn new(store: Store, clock: Clock) -> Self {
        Self { store, clock }
    }

    async fn user(&self, user_name: &str) -> Result<Option<(User, PasswordHash)>, StoreError> {
        self.store.read().await?.users().lookup(user_name).await
    }
}

#[async_trait]
impl Accounts for StoredAccounts {
    type Principal = Principal;

    async fn password_hash(&self, user_name: &str) -> Result<Option<PasswordHash>, AccountsError> {
        let found = self.user(user_name).await.map_err(AccountsError::new)?;
        Ok(found.map(|(_, hash)| hash))
    }

    async fn principal(&self, user_name: &str) -> Result<Option<Principal>, AccountsError> {
        let found = self.user(user_name).await.map_err(AccountsError::new)?;
        Ok(found.map(|(user, _)| Principal { user }))
    }

    async fn put_session(&self, session: &StoredSession) -> Result<(), AccountsError> {
        let put = async {
            let mut work = self.store.begin().await?;
            work.users().put_session(session, self.clock.now()).await?;
            work.commit().await
        };
        put.await.map_err(AccountsError::new)
    }

    async fn session(&self, id: &SessionId) -> Result<Option<StoredSession>, AccountsError> {
        let session = async { self.store.read().await?.users().session(id).await };
        session.await.map_err(AccountsError::new)
    }

    async fn delete_session(&self, id: &SessionId) -> Result<(), AccountsError> {
        let delete = async {
            let mut work = self.store.begin().await?;
            work.users().delete_session(id).await?;
            work.commit().await
        };
        delete.await.map_err(AccountsError::new)
    }
}
