//! Accounts and sessions in the platform's store, as the web server reads them.

use std::time::SystemTime;

use asi_model::DateTime;
use async_trait::async_trait;
use daemon::web::session::{
    Accounts, AccountsError, PasswordHash, SessionId, StoredSecondFactor, StoredSession,
};

use crate::{
    clock::Clock,
    principal::Principal,
    store::{Store, StoreError, User},
};

/// Runs one statement of a repository in a transaction.
macro_rules! in_transaction {
    ($accounts:ident, $work:ident => $change:expr) => {{
        let done = async {
            let mut $work = $accounts.store.begin().await?;
            let done = $change.await?;
            $work.commit().await?;
            Ok::<_, StoreError>(done)
        };
        done.await.map_err(AccountsError::new)
    }};
}

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

    async fn set_password(
        &self,
        user_name: &str,
        password: &PasswordHash,
        kept: &SessionId,
    ) -> Result<(), AccountsError> {
        in_transaction!(self, work => work.users().set_password(user_name, password, kept))
    }

    async fn put_session(&self, session: &StoredSession) -> Result<(), AccountsError> {
        let now = self.clock.now();
        in_transaction!(self, work => work.users().put_session(session, now))
    }

    async fn sessions_of(&self, user_name: &str) -> Result<Vec<StoredSession>, AccountsError> {
        let sessions = async { self.store.read().await?.users().sessions_of(user_name).await };
        sessions.await.map_err(AccountsError::new)
    }

    async fn touch_session(&self, id: &SessionId, at: SystemTime) -> Result<(), AccountsError> {
        in_transaction!(self, work => work.users().touch_session(id, DateTime::from(at)))
    }

    async fn session(&self, id: &SessionId) -> Result<Option<StoredSession>, AccountsError> {
        let session = async { self.store.read().await?.users().session(id).await };
        session.await.map_err(AccountsError::new)
    }

    async fn delete_session(&self, id: &SessionId) -> Result<(), AccountsError> {
        in_transaction!(self, work => work.users().delete_session(id))
    }

    async fn second_factor(
        &self,
        user_name: &str,
    ) -> Result<Option<StoredSecondFactor>, AccountsError> {
        let factor = async { self.store.read().await?.second_factors().lookup(user_name).await };
        factor.await.map_err(AccountsError::new)
    }

    async fn put_second_factor(
        &self,
        user_name: &str,
        factor: &StoredSecondFactor,
    ) -> Result<(), AccountsError> {
        in_transaction!(self, work => work.second_factors().put(user_name, factor))
    }

    async fn delete_second_factor(&self, user_name: &str) -> Result<bool, AccountsError> {
        in_transaction!(self, work => work.second_factors().remove(user_name))
    }

    async fn use_time_step(&self, user_name: &str, step: u64) -> Result<bool, AccountsError> {
        in_transaction!(self, work => work.second_factors().use_time_step(user_name, step))
    }

    async fn use_recovery_code(
        &self,
        user_name: &str,
        digest: &str,
    ) -> Result<bool, AccountsError> {
        in_transaction!(self, work => work.second_factors().use_recovery_code(user_name, digest))
    }
}
