//! Argon2 off the async threads, with bounds on time and memory.

use std::sync::Arc;

use parking_lot::Mutex;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};

use super::password::{HashMemory, PasswordError, PasswordHash, PasswordPolicy, nobodys_hash};
use crate::Confidential;

/// Hashes computed at once. Each takes a core and 19 MiB for some tens of milliseconds; more at once
/// are no faster where machines have few cores.
const HASHES_MAX: usize = 2;
/// Hashes that are computed or wait. At fifty in a second, the last one waits for about two.
const WAITING_MAX: usize = 96;

/// Work of hashing, shared by all who check passwords. Clones share it.
#[derive(Clone)]
pub struct PasswordHashing(Arc<HashingWork>);

struct HashingWork {
    waiting: Arc<Semaphore>,
    running: Arc<Semaphore>,
    /// At most one for each hash at once.
    memory: Mutex<Vec<HashMemory>>,
}

/// A hash was not computed.
#[derive(Debug, thiserror::Error)]
pub enum HashingError {
    /// The password is refused or could not be hashed.
    #[error(transparent)]
    Password(#[from] PasswordError),
    /// Too many wait already.
    #[error("too many passwords wait to be checked")]
    Busy,
    /// The work broke off.
    #[error("the work of hashing broke off")]
    Broken,
}

impl Default for PasswordHashing {
    fn default() -> Self {
        Self(Arc::new(HashingWork {
            waiting: Arc::new(Semaphore::new(WAITING_MAX)),
            running: Arc::new(Semaphore::new(HASHES_MAX)),
            memory: Mutex::default(),
        }))
    }
}

impl PasswordHashing {
    /// Compares a password with the hash of a user. Without a user it takes as long and is false, so
    /// that time does not tell which users exist.
    ///
    /// # Errors
    /// [`HashingError::Busy`] and [`HashingError::Broken`].
    pub async fn verify(
        &self,
        hash: Option<PasswordHash>,
        password: Confidential<String>,
    ) -> Result<bool, HashingError> {
        let is_known = hash.is_some();
        let hash = hash.unwrap_or_else(nobodys_hash);
        let is_right = self.run(move |memory| hash.is_of_with_memory(&password, memory)).await?;
        Ok(is_known && is_right)
    }

    /// Hashes a password that fulfils the policy.
    ///
    /// # Errors
    /// [`HashingError`].
    pub async fn hash(
        &self,
        password: Confidential<String>,
        policy: PasswordPolicy,
    ) -> Result<PasswordHash, HashingError> {
        Ok(self.run(move |memory| PasswordHash::with_memory(&password, policy, memory)).await??)
    }

    async fn run<T: Send + 'static>(
        &self,
        work: impl FnOnce(&mut HashMemory) -> T + Send + 'static,
    ) -> Result<T, HashingError> {
        let waiting =
            Arc::clone(&self.0.waiting).try_acquire_owned().map_err(|_| HashingError::Busy)?;
        let running = Arc::clone(&self.0.running).acquire_owned().await;
        let permits = (waiting, running.map_err(|_| HashingError::Broken)?);
        let inner = Arc::clone(&self.0);
        // The permits go along: a caller that gives up waiting does not stop the work.
        let done = tokio::task::spawn_blocking(move || inner.run(permits, work));
        done.await.map_err(|_| HashingError::Broken)
    }
}

impl HashingWork {
    fn run<T>(
        &self,
        _permits: (OwnedSemaphorePermit, OwnedSemaphorePermit),
        work: impl FnOnce(&mut HashMemory) -> T,
    ) -> T {
        let mut memory = self.memory.lock().pop().unwrap_or_default();
        let result = work(&mut memory);
        self.memory.lock().push(memory);
        result
    }
}

impl std::fmt::Debug for PasswordHashing {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("PasswordHashing")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn the_queue_is_bounded_and_memory_is_used_again() {
        let hashing = PasswordHashing::default();
        let policy = PasswordPolicy::default();
        let hash = hashing.hash("correct horse".into(), policy).await.expect("room");
        let checks = (0..WAITING_MAX + 20).map(|number| {
            let password = if number % 2 == 0 { "correct horse" } else { "wrong horse" };
            hashing.verify(Some(hash.clone()), password.into())
        });
        let outcomes = futures::future::join_all(checks).await;
        let busy = outcomes.iter().filter(|one| matches!(one, Err(HashingError::Busy))).count();
        assert_eq!(busy, 20);
        let right = outcomes.iter().filter(|one| matches!(one, Ok(true))).count();
        assert_eq!(right, WAITING_MAX / 2);
        assert!(hashing.0.memory.lock().len() <= HASHES_MAX);
        assert!(!hashing.verify(None, "correct horse".into()).await.expect("room again"));
    }

    #[tokio::test]
    async fn others_on_the_same_thread_go_on_while_passwords_are_hashed() {
        let hashing = PasswordHashing::default();
        let hashed = tokio::spawn(async move {
            let hash = hashing.hash("correct horse".into(), PasswordPolicy::default()).await?;
            hashing.verify(Some(hash), "correct horse".into()).await
        });
        let mut turns = 0;
        while !hashed.is_finished() {
            tokio::time::sleep(std::time::Duration::from_millis(1)).await;
            turns += 1;
        }
        assert!(hashed.await.expect("no panic").expect("room"));
        assert!(turns > 3, "{turns} turns");
    }
}
