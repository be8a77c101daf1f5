//! Accounts of a small daemon, in memory.

use std::{
    collections::HashMap,
    sync::{Arc, atomic::AtomicUsize},
    time::SystemTime,
};

use async_trait::async_trait;
use daemon::web::session::{
    AccountChange, Accounts, AccountsError, PasskeyUse, PasswordHash, SessionId, StoredPasskey,
    StoredSecondFactor, StoredSession,
};
use parking_lot::Mutex;
use tokio::sync::Semaphore;

#[derive(Clone, Default)]
pub struct Memory {
    pub users: Arc<Mutex<HashMap<String, PasswordHash>>>,
    pub sessions: Arc<Mutex<HashMap<String, StoredSession>>>,
    pub factors: Arc<Mutex<HashMap<String, StoredSecondFactor>>>,
    /// Passkeys with their users.
    pub passkeys: Arc<Mutex<Vec<(String, StoredPasskey)>>>,
    /// Endless answers that are being sent.
    pub floods: Arc<AtomicUsize>,
    pub readers: PageReaders,
}

/// Readers of a store, as few as a platform has.
#[derive(Clone)]
pub struct PageReaders(pub Arc<Semaphore>);

impl PageReaders {
    pub const COUNT: usize = 6;
}

impl Default for PageReaders {
    fn default() -> Self {
        Self(Arc::new(Semaphore::new(Self::COUNT)))
    }
}

#[async_trait]
impl Accounts for Memory {
    type Principal = String;

    /// Returns the organisation of names such as `ann@acme`.
    fn organisation(principal: &String) -> Option<&str> {
        principal.split_once('@').map(|(_, organisation)| organisation)
    }

    async fn password_hash(&self, user_name: &str) -> Result<Option<PasswordHash>, AccountsError> {
        Ok(self.users.lock().get(user_name).cloned())
    }

    async fn principal(&self, user_name: &str) -> Result<Option<String>, AccountsError> {
        Ok(self.users.lock().contains_key(user_name).then(|| user_name.to_owned()))
    }

    async fn put_session(&self, session: &StoredSession) -> Result<(), AccountsError> {
        self.sessions.lock().insert(session.id.as_str().to_owned(), session.clone());
        Ok(())
    }

    async fn session(&self, id: &SessionId) -> Result<Option<StoredSession>, AccountsError> {
        Ok(self.sessions.lock().get(id.as_str()).cloned())
    }

    async fn delete_session(
        &self,
        id: &SessionId,
        _: Option<AccountChange<'_>>,
    ) -> Result<(), AccountsError> {
        self.sessions.lock().remove(id.as_str());
        Ok(())
    }

    async fn set_password(
        &self,
        user_name: &str,
        password: &PasswordHash,
        kept: &SessionId,
    ) -> Result<(), AccountsError> {
        self.users.lock().insert(user_name.to_owned(), password.clone());
        self.sessions
            .lock()
            .retain(|_, session| session.user_name != user_name || session.id == *kept);
        Ok(())
    }

    async fn sessions_of(&self, user_name: &str) -> Result<Vec<StoredSession>, AccountsError> {
        let sessions = self.sessions.lock();
        Ok(sessions.values().filter(|session| session.user_name == user_name).cloned().collect())
    }

    async fn touch_session(&self, id: &SessionId, at: SystemTime) -> Result<(), AccountsError> {
        if let Some(session) = self.sessions.lock().get_mut(id.as_str()) {
            session.last_used_at = at;
        }
        Ok(())
    }

    async fn second_factor(
        &self,
        user_name: &str,
    ) -> Result<Option<StoredSecondFactor>, AccountsError> {
        Ok(self.factors.lock().get(user_name).cloned())
    }

    async fn put_second_factor(
        &self,
        user_name: &str,
        factor: &StoredSecondFactor,
        _: AccountChange<'_>,
    ) -> Result<(), AccountsError> {
        self.factors.lock().insert(user_name.to_owned(), factor.clone());
        Ok(())
    }

    async fn delete_second_factor(
        &self,
        user_name: &str,
        _: AccountChange<'_>,
    ) -> Result<bool, AccountsError> {
        self.passkeys.lock().retain(|(owner, _)| owner != user_name);
        Ok(self.factors.lock().remove(user_name).is_some())
    }

    async fn use_time_step(&self, user_name: &str, step: u64) -> Result<bool, AccountsError> {
        let mut factors = self.factors.lock();
        let Some(factor) = factors.get_mut(user_name) else { return Ok(false) };
        let is_new = step > factor.last_step;
        factor.last_step = factor.last_step.max(step);
        Ok(is_new)
    }

    async fn use_recovery_code(
        &self,
        user_name: &str,
        digest: &str,
    ) -> Result<bool, AccountsError> {
        let mut factors = self.factors.lock();
        let Some(factor) = factors.get_mut(user_name) else { return Ok(false) };
        let before = factor.recovery_digests.len();
        factor.recovery_digests.retain(|one| one != digest);
        Ok(factor.recovery_digests.len() < before)
    }

    async fn passkeys(&self, user_name: &str) -> Result<Vec<StoredPasskey>, AccountsError> {
        let passkeys = self.passkeys.lock();
        let own = passkeys.iter().filter(|(owner, _)| owner == user_name);
        Ok(own.map(|(_, passkey)| passkey.clone()).collect())
    }

    async fn add_passkey(
        &self,
        user_name: &str,
        passkey: &StoredPasskey,
        recovery_digests: Option<&[String]>,
        _: AccountChange<'_>,
    ) -> Result<bool, AccountsError> {
        let mut passkeys = self.passkeys.lock();
        if passkeys.iter().any(|(_, other)| other.credential_id == passkey.credential_id) {
            return Ok(false);
        }
        passkeys.push((user_name.to_owned(), passkey.clone()));
        if let Some(digests) = recovery_digests {
            let mut factors = self.factors.lock();
            let factor = factors.entry(user_name.to_owned()).or_default();
            factor.recovery_digests = digests.to_vec();
        }
        Ok(true)
    }

    async fn use_passkey(&self, user_name: &str, used: &PasskeyUse) -> Result<bool, AccountsError> {
        let mut passkeys = self.passkeys.lock();
        let found = passkeys.iter_mut().find(|(owner, passkey)| {
            owner == user_name
                && passkey.passkey_id == used.passkey_id
                && passkey.dynamic_state == used.former_state
        });
        let Some((_, passkey)) = found else { return Ok(false) };
        passkey.dynamic_state = used.dynamic_state;
        passkey.last_used_at = Some(used.at);
        Ok(true)
    }

    async fn delete_passkey(
        &self,
        user_name: &str,
        passkey_id: &str,
        _: AccountChange<'_>,
    ) -> Result<bool, AccountsError> {
        let mut passkeys = self.passkeys.lock();
        let before = passkeys.len();
        passkeys.retain(|(owner, passkey)| owner != user_name || passkey.passkey_id != passkey_id);
        let is_last = !passkeys.iter().any(|(owner, _)| owner == user_name);
        let mut factors = self.factors.lock();
        if is_last && factors.get(user_name).is_some_and(|factor| !factor.is_confirmed) {
            factors.remove(user_name);
        }
        Ok(passkeys.len() < before)
    }
}
