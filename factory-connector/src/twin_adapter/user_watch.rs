//! Ends the OPC UA sessions of people who were removed, or who got another role or password: a
//! session keeps the rights it began with.

use std::{collections::HashMap, sync::Arc, time::Duration};

use tokio::sync::Notify;
use tokio_util::sync::CancellationToken;
use twin::TwinHandle;

use crate::store::{Readers, StoreError, User};

/// How often the store is looked at without being told to: the command line changes people, too.
const LOOK: Duration = Duration::from_secs(5);

/// Role and password hash by name.
type People = HashMap<String, (String, String)>;

/// Watches people.
pub struct UserWatch {
    readers: Readers,
    twin: TwinHandle,
    changed: Arc<Notify>,
    known: People,
}

impl UserWatch {
    /// Watches from now on; `changed` says that looking is worth while.
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

    /// Goes on until `shutdown`.
    pub async fn run(mut self, shutdown: CancellationToken) {
        loop {
            tokio::select! {
                () = tokio::time::sleep(LOOK) => {}
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

/// Those known before who are others now, or gone.
fn changed<'p>(before: &'p People, now: &People) -> impl Iterator<Item = &'p str> {
    before.iter().filter(|(name, user)| now.get(*name) != Some(user)).map(|(name, _)| name.as_str())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_those_who_changed_have_to_go() {
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
