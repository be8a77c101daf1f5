//! Who is signed in. Users lie in the store; sessions live in memory and end with the connector.
//!
//! A session is good for the password it was begun with: a new password ends it, whoever set it, on
//! a page or on the command line. The one exception is the session in which somebody changes the
//! own password.

use std::{collections::HashMap, sync::Arc, time::SystemTime};

use async_trait::async_trait;
use daemon::web::session::{Accounts, AccountsError, PasswordHash, SessionId, StoredSession};
use parking_lot::Mutex;

use crate::store::{Readers, Role, StoreError, User};

/// Most sessions at the same time; beyond, the one that ends first goes.
const SESSIONS_MAX: usize = 10_000;

/// Whoever asks the API.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Principal {
    /// The name signed in with.
    pub user_name: String,
    /// What the person may do.
    pub role: Role,
}

/// Users of the store, sessions in memory.
#[derive(Clone)]
pub struct StoredAccounts {
    readers: Readers,
    sessions: Arc<Mutex<HashMap<SessionId, Kept>>>,
    changing: Arc<tokio::sync::Mutex<()>>,
}

/// A session, and the password hashes of its user for which it is good.
#[derive(Clone)]
struct Kept {
    session: StoredSession,
    good_for: Vec<String>,
}

impl StoredAccounts {
    /// Over the store's reading connections.
    #[must_use]
    pub fn new(readers: Readers) -> Self {
        Self { readers, sessions: Arc::default(), changing: Arc::default() }
    }

    async fn user(&self, user_name: &str) -> Result<Option<User>, StoreError> {
        self.readers.session().await?.users().lookup(user_name).await
    }

    /// Lets nobody else change people while this is held: what was read of them is true until it is
    /// written.
    pub(super) async fn change(&self) -> tokio::sync::MutexGuard<'_, ()> {
        self.changing.lock().await
    }

    /// Ends a person's sessions, except the one from which it is done.
    pub(super) fn end_sessions_of(&self, user_name: &str, except: Option<&SessionId>) {
        self.sessions
            .lock()
            .retain(|id, kept| kept.session.user_name != user_name || Some(id) == except);
    }

    /// Somebody is about to change the own password: the session in which it is done stays good.
    pub(super) fn stay_good_for(&self, session: &SessionId, password_hash: &str) {
        if let Some(kept) = self.sessions.lock().get_mut(session) {
            // The one that is good now, and the one to come.
            kept.good_for.truncate(1);
            kept.good_for.insert(0, password_hash.to_owned());
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
        let good_for = owner.into_iter().map(|user| user.password_hash).collect();
        let mut sessions = self.sessions.lock();
        let now = SystemTime::now();
        sessions.retain(|_, kept| kept.session.expires_at > now);
        if sessions.len() >= SESSIONS_MAX
            && let Some(first) =
                sessions.values().map(|kept| &kept.session).min_by_key(|session| session.expires_at)
        {
            let first = first.id.clone();
            sessions.remove(&first);
        }
        sessions.insert(session.id.clone(), Kept { session: session.clone(), good_for });
        Ok(())
    }

    async fn session(&self, id: &SessionId) -> Result<Option<StoredSession>, AccountsError> {
        let Some(Kept { session, good_for }) = self.sessions.lock().get(id).cloned() else {
            return Ok(None);
        };
        let owner = self.user(&session.user_name).await.map_err(AccountsError::new)?;
        Ok(owner.is_some_and(|user| good_for.contains(&user.password_hash)).then_some(session))
    }

    async fn delete_session(&self, id: &SessionId) -> Result<(), AccountsError> {
        self.sessions.lock().remove(id);
        Ok(())
    }
}
