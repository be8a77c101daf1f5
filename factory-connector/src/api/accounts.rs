//! Users and sessions. Users are in the store; sessions are in memory and end with the connector.
//!
//! A session is valid for the password that it began with: a new password ends it, no matter who set
//! it, on a page or on the command line. The one exception is the session in which a person changes
//! the own password.

use std::{collections::HashMap, path::PathBuf, sync::Arc, time::SystemTime};

use asi_model::DateTime;
use async_trait::async_trait;
use daemon::web::session::{
    AccountChange, Accounts, AccountsError, PasskeyUse, PasswordHash, SessionId, StoredPasskey,
    StoredSecondFactor, StoredSession,
};
use parking_lot::Mutex;
use tokio::sync::Notify;

use super::store_writer::StoreWriter;
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
    writer: StoreWriter,
    /// Wakes the twin after a change of users.
    users_changed: Arc<Notify>,
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
    /// Returns accounts that read the store with these connections, and write it in its folder.
    #[must_use]
    pub fn new(readers: Readers, directory: PathBuf, users_changed: Arc<Notify>) -> Self {
        Self {
            readers,
            writer: StoreWriter::new(directory),
            users_changed,
            sessions: Arc::default(),
            changing: Arc::default(),
        }
    }

    pub(super) const fn writer(&self) -> &StoreWriter {
        &self.writer
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

    async fn set_password(
        &self,
        user_name: &str,
        password: &PasswordHash,
        kept: &SessionId,
    ) -> Result<(), AccountsError> {
        let _change = self.change().await;
        let user = self.user(user_name).await.map_err(AccountsError::new)?;
        // Removed meanwhile, and the session with it.
        let Some(user) = user else { return Ok(()) };
        self.extend_to(kept, password.as_str());
        let changed = User { password_hash: password.as_str().to_owned(), ..user };
        let write = self
            .writer
            .write(move |mut session| async move { session.users().put(&changed, now()).await });
        write.await.map_err(AccountsError::new)?;
        self.end_sessions_of(user_name, Some(kept));
        self.users_changed.notify_one();
        Ok(())
    }

    async fn sessions_of(&self, user_name: &str) -> Result<Vec<StoredSession>, AccountsError> {
        let Some(user) = self.user(user_name).await.map_err(AccountsError::new)? else {
            return Ok(Vec::new());
        };
        let sessions = self.sessions.lock();
        let own = sessions.values().filter(|active| {
            active.session.user_name == user_name && active.valid_for.contains(&user.password_hash)
        });
        Ok(own.map(|active| active.session.clone()).collect())
    }

    async fn touch_session(&self, id: &SessionId, at: SystemTime) -> Result<(), AccountsError> {
        if let Some(active) = self.sessions.lock().get_mut(id) {
            active.session.last_used_at = at;
        }
        Ok(())
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

    async fn delete_session(
        &self,
        id: &SessionId,
        _: Option<AccountChange<'_>>,
    ) -> Result<(), AccountsError> {
        self.sessions.lock().remove(id);
        Ok(())
    }

    async fn second_factor(
        &self,
        user_name: &str,
    ) -> Result<Option<StoredSecondFactor>, AccountsError> {
        let factor =
            async { self.readers.session().await?.second_factors().lookup(user_name).await };
        factor.await.map_err(AccountsError::new)
    }

    async fn put_second_factor(
        &self,
        user_name: &str,
        factor: &StoredSecondFactor,
        _: AccountChange<'_>,
    ) -> Result<(), AccountsError> {
        let (name, factor) = (user_name.to_owned(), factor.clone());
        let write = self.writer.write(move |mut session| async move {
            session.second_factors().put(&name, &factor).await
        });
        write.await.map_err(AccountsError::new)?;
        self.users_changed.notify_one();
        Ok(())
    }

    async fn delete_second_factor(
        &self,
        user_name: &str,
        _: AccountChange<'_>,
    ) -> Result<bool, AccountsError> {
        let name = user_name.to_owned();
        let write = self.writer.write(move |mut session| async move {
            let had_passkeys = session.passkeys().remove_all(&name).await?;
            Ok(session.second_factors().remove(&name).await? || had_passkeys)
        });
        write.await.map_err(AccountsError::new)
    }

    async fn use_time_step(&self, user_name: &str, step: u64) -> Result<bool, AccountsError> {
        let name = user_name.to_owned();
        let write = self.writer.write(move |mut session| async move {
            session.second_factors().use_time_step(&name, step).await
        });
        write.await.map_err(AccountsError::new)
    }

    async fn use_recovery_code(
        &self,
        user_name: &str,
        digest: &str,
    ) -> Result<bool, AccountsError> {
        let (name, digest) = (user_name.to_owned(), digest.to_owned());
        let write = self.writer.write(move |mut session| async move {
            session.second_factors().use_recovery_code(&name, &digest).await
        });
        write.await.map_err(AccountsError::new)
    }

    async fn passkeys(&self, user_name: &str) -> Result<Vec<StoredPasskey>, AccountsError> {
        let passkeys = async { self.readers.session().await?.passkeys().of(user_name).await };
        passkeys.await.map_err(AccountsError::new)
    }

    async fn add_passkey(
        &self,
        user_name: &str,
        passkey: &StoredPasskey,
        recovery_digests: Option<&[String]>,
        _: AccountChange<'_>,
    ) -> Result<bool, AccountsError> {
        let (name, passkey) = (user_name.to_owned(), passkey.clone());
        let digests = recovery_digests.map(<[String]>::to_vec);
        let write = self.writer.write(move |mut session| async move {
            session.passkeys().add(&name, &passkey, digests.as_deref()).await
        });
        let is_added = write.await.map_err(AccountsError::new)?;
        self.users_changed.notify_one();
        Ok(is_added)
    }

    async fn use_passkey(&self, user_name: &str, used: &PasskeyUse) -> Result<bool, AccountsError> {
        let (name, used) = (user_name.to_owned(), used.clone());
        let write = self.writer.write(move |mut session| async move {
            session.passkeys().note_use(&name, &used).await
        });
        write.await.map_err(AccountsError::new)
    }

    async fn delete_passkey(
        &self,
        user_name: &str,
        passkey_id: &str,
        _: AccountChange<'_>,
    ) -> Result<bool, AccountsError> {
        let (name, id) = (user_name.to_owned(), passkey_id.to_owned());
        let write = self
            .writer
            .write(move |mut session| async move { session.passkeys().remove(&name, &id).await });
        write.await.map_err(AccountsError::new)
    }
}
