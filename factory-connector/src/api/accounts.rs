//! Users and sessions. Users are in the store; sessions are in memory and end with the connector.
//!
//! A session is valid for the password that it began with: a new password ends it, no matter who set
//! it, on a page or on the command line. The one exception is the session in which a person changes
//! the own password.

use std::{collections::HashMap, sync::Arc};

use asi_model::DateTime;
use async_trait::async_trait;
use daemon::web::session::{Accounts, AccountsError, PasswordHash, SessionId, StoredSession};
use parking_lot::Mutex;

use crate::{
    clock::now,
    store::{Readers, Role, StoreError, User},
};

/// Most sessions at the same time. One more replaces the session that would end first.
const SESSIONS_MAX: usize = 10_000;

/// Person who sent a request.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Principal {
    pub user_name: String,
    pub role: Role,
}

/// Users of the store, sessions in memory.
#[derive(Clone)]
pub struct StoredAccounts {
    readers: Readers,
    sessions: Arc<Mutex<HashMap<SessionId, ActiveSession>>>,
    changing: Arc<tokio::sync::Mutex<()>>,
}

/// A session, and the password hashes of its user for which it is valid.
#[derive(Clone)]
struct ActiveSession {
    session: StoredSession,
    valid_for: Vec<String>,
}

impl StoredAccounts {
    /// Returns accounts that read the store with these connections.
    #[must_use]
    pub fn new(readers: Readers) -> Self {
        Self { readers, sessions: Arc::default(), changing: Arc::default() }
    }

    async fn user(&self, user_name: &str) -> Result<Option<User>, StoreError> {
        self.readers.session().await?.users().lookup(user_name).await
    }

    /// Waits until no other request changes users. What is read of them stays true until the guard is
    /// dropped.
    pub(super) async fn change(&self) -> tokio::sync::MutexGuard<'_, ()> {
        self.changing.lock().await
    }

    /// Ends a person's sessions, except the one from which it is done.
    pub(super) fn end_sessions_of(&self, user_name: &str, except: Option<&SessionId>) {
        self.sessions
            .lock()
            .retain(|id, active| active.session.user_name != user_name || Some(id) == except);
    }

    /// Keeps a session valid while its user changes the own password.
    pub(super) fn extend_to(&self, session: &SessionId, password_hash: &str) {
        if let Some(active) = self.sessions.lock().get_mut(session) {
            // The hash that is stored now, and the one that is about to be.
            active.valid_for.truncate(1);
            active.valid_for.insert(0, password_hash.to_owned());
        }
    }
}

#[async_trait]
impl Accounts for StoredAccounts {
    type Principal = Principal;

    async fn password_hash(&self, user_name: &str) -> Result<Option<PasswordHash>, AccountsError> {
        let found = self.user(user_name).await.map_err(AccountsError::new)?;
        Ok(found.map(|user| PasswordHash::from_stored(user.password_hash)))
    }

    async fn principal(&self, user_name: &str) -> Result<Option<Principal>, AccountsError> {
        let found = self.user(user_name).await.map_err(AccountsError::new)?;
        Ok(found.map(|user| Principal { user_name: user.user_name, role: user.role }))
    }

    async fn put_session(&self, session: &StoredSession) -> Result<(), AccountsError> {
        let owner = self.user(&session.user_name).await.map_err(AccountsError::new)?;
        let valid_for = owner.into_iter().map(|user| user.password_hash).collect();
        let mut sessions = self.sessions.lock();
        let now = now();
        sessions.retain(|_, active| DateTime::from(active.session.expires_at) > now);
        if sessions.len() >= SESSIONS_MAX
            && let Some(first) = sessions
                .values()
                .map(|active| &active.session)
                .min_by_key(|session| session.expires_at)
        {
            let first = first.id.clone();
            sessions.remove(&first);
        }
        sessions.insert(session.id.clone(), ActiveSession { session: session.clone(), valid_for });
        Ok(())
    }

    async fn session(&self, id: &SessionId) -> Result<Option<StoredSession>, AccountsError> {
        let Some(ActiveSession { session, valid_for }) = self.sessions.lock().get(id).cloned()
        else {
            return Ok(None);
        };
        let owner = self.user(&session.user_name).await.map_err(AccountsError::new)?;
        Ok(owner.is_some_and(|user| valid_for.contains(&user.password_hash)).then_some(session))
    }

    async fn delete_session(&self, id: &SessionId) -> Result<(), AccountsError> {
        self.sessions.lock().remove(id);
        Ok(())
    }
}
