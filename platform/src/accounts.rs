//! Accounts and sessions in the platform's store, as the web server reads them.

use async_trait::async_trait;
use daemon::web::session::{Accounts, AccountsError, PasswordHash, SessionId, StoredSession};

use crate::{
    clock::Clock,
    principal::Principal,
    store::{
        AuditAgent, AuditAgentKind, AuditOutcome, AuditSubject, NewAuditEntry, Store, StoreError,
        User, Work,
    },
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

impl StoredAccounts {
    /// Records that a person signed in or out.
    async fn record(
        &self,
        work: &mut Work,
        user_name: &str,
        operation: &str,
    ) -> Result<(), StoreError> {
        let user = work.users().lookup(user_name).await?.map(|(user, _)| user);
        let organisation_id = user.and_then(|user| user.organisation_id);
        let agent = AuditAgent {
            kind: AuditAgentKind::User,
            name: user_name.to_owned(),
            organisation_id: organisation_id.clone(),
        };
        let path = format!("users/{user_name}/session");
        let subject = AuditSubject { path, concerned: organisation_id };
        let entry = NewAuditEntry {
            recorded_at: self.clock.now(),
            agent: &agent,
            operation,
            subject: &subject,
            outcome: AuditOutcome::Done,
        };
        work.audit().add(&entry).await
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
            self.record(&mut work, &session.user_name, "signIn").await?;
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
            if let Some(session) = work.users().session(id).await? {
                work.users().delete_session(id).await?;
                self.record(&mut work, &session.user_name, "signOut").await?;
            }
            work.commit().await
        };
        delete.await.map_err(AccountsError::new)
    }
}
