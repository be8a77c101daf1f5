//! Ends the OPC UA sessions of people who were removed, or who got another role or password: a
//! session keeps the rights it began with.

use std::{collections::HashMap, sync::Arc, time::Duration};

use tokio::sync::Notify;
use tokio_util::sync::CancellationToken;
use twin::TwinHandle;

use crate::store::{Readers, StoreError, User};

/// Time between two reads of the store without a notification: the command line changes users, too.
const READ_INTERVAL: Duration = Duration::from_secs(5);

/// Role and password hash by name.
type People = HashMap<String, (String, String)>;

/// Task that compares the stored users with those it read before.
pub struct UserWatch {
    readers: Readers,
    twin: TwinHandle,
    changed: Arc<Notify>,
    known: People,
}

impl UserWatch {
    /// Reads the users of now; `changed` notifies of later changes by this process.
    ///
    /// # Errors
    /// [`StoreError`] where the users cannot be read.
    pub async fn new(
        readers: Readers,
        twin: TwinHandle,
        changed: Arc<Notify>,
    ) -> Result<Self, StoreError> {
        let known = people(&readers).await?;
        Ok(Self { readers, twin, changed, known })
    }

    /// Compares users until shutdown.
    pub async fn run(mut self, shutdown: CancellationToken) {
        loop {
            tokio::select! {
                () = tokio::time::sleep(READ_INTERVAL) => {}
                () = self.changed.notified() => {}
                () = shutdown.cancelled() => return,
            }
            match people(&self.readers).await {
                Ok(now) => self.compare(now).await,
                Err(error) => tracing::warn!(
                    error = &error as &dyn std::error::Error,
                    "It is not known whether people were changed; OPC UA sessions go on for the time being."
                ),
            }
        }
    }

    async fn compare(&mut self, now: People) {
        let before = std::mem::replace(&mut self.known, now);
        for name in changed(&before, &self.known) {
            let ended = self.twin.end_sessions_of(name).await;
            if ended > 0 {
                tracing::info!(
                    user.name = name,
                    sessions = ended,
                    "OPC UA sessions of a changed user were ended."
                );
            }
        }
    }
}

async fn people(readers: &Readers) -> Result<People, StoreError> {
    let users = readers.session().await?.users().all().await?;
    let entry = |user: User| (user.user_name, (user.role.name().to_owned(), user.password_hash));
    Ok(users.into_iter().map(entry).collect())
}

/// Returns the names of users who were changed or removed.
fn changed<'p>(before: &'p People, now: &People) -> impl Iterator<Item = &'p str> {
    before.iter().filter(|(name, user)| now.get(*name) != Some(user)).map(|(name, _)| name.as_str())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changed_and_removed_users_are_found() {
        let people = |people: &[(&str, &str, &str)]| -> People {
            people
                .iter()
                .map(|(name, role, hash)| ((*name).into(), ((*role).into(), (*hash).into())))
                .collect()
        };
        let before =
            people(&[("eva", "E", "1"), ("otto", "O", "2"), ("vera", "V", "3"), ("ida", "E", "4")]);
        let now =
            people(&[("eva", "E", "1"), ("otto", "V", "2"), ("vera", "V", "9"), ("new", "E", "5")]);
        let mut found: Vec<_> = changed(&before, &now).collect();
        found.sort_unstable();
        assert_eq!(found, ["ida", "otto", "vera"]);
    }
}
