//! Who is signed in, and what part of the partners' data that opens.

use asi_model::OrganisationId;
use async_trait::async_trait;
use daemon::web::session::{Accounts, AccountsError, PasswordHash, SessionId, StoredSession};

use crate::{
    clock::Clock,
    store::{Role, Scope, Store, StoreError, User},
};

/// Whoever asks the API.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Principal {
    /// The user.
    pub user: User,
}

impl Principal {
    /// What the principal may see.
    #[must_use]
    pub fn scope(&self) -> Scope {
        match (self.user.role, &self.user.organisation_id) {
            (Role::Administrator, organisation) => {
                Scope::Administration { looking_for: organisation.clone() }
            }
            (_, Some(organisation)) => Scope::Organisation(organisation.clone()),
            // A user of no organisation who runs nothing sees nothing: no organisation has such an
            // id.
            (_, None) => Scope::Nothing,
        }
    }

    /// Runs the platform.
    #[must_use]
    pub fn is_administrator(&self) -> bool {
        self.user.role == Role::Administrator
    }

    /// May change networks and requests.
    #[must_use]
    pub fn may_plan(&self) -> bool {
        self.user.role != Role::Viewer
    }

    /// For whom the principal acts.
    #[must_use]
    pub const fn organisation(&self) -> Option<&OrganisationId> {
        self.user.organisation_id.as_ref()
    }
}

/// Users and sessions in the platform's store.
#[derive(Debug, Clone)]
pub struct StoredAccounts {
    store: Store,
    clock: Clock,
}

impl StoredAccounts {
    /// Over this store.
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
