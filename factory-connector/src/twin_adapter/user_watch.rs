//! Ends the OPC UA sessions of people who were removed, who got another role or password, or who turned a second
//! factor on: a session keeps the rights it began with, and began with a password alone then.

use std::{
    collections::{HashMap, HashSet},
    sync::Arc,
    time::Duration,
};

use tokio::sync::Notify;
use tokio_util::sync::CancellationToken;
use twin::TwinHandle;

use crate::store::{Readers, StoreError, User};

/// Time between two reads of the store without a notification: the command line changes users, too.
const READ_INTERVAL: Duration = Duration::from_secs(5);

/// People by name.
type People = HashMap<String, Person>;

/// Rights and secrets that a session of a person began with.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Person {
    role: String,
    password_hash: String,
    /// True where codes of an app, or passkeys, are asked for.
    has_second_factor: bool,
}

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
    let mut session = readers.session().await?;
    let users = session.users().all().await?;
    let confirmed: HashSet<String> =
        session.second_factors().confirmed().await?.into_iter().collect();
    let entry = |user: User| {
        let has_second_factor = confirmed.contains(&user.user_name);
        let role = user.role.name().to_owned();
        (user.user_name, Person { role, password_hash: user.password_hash, has_second_factor })
    };
    Ok(users.into_iter().map(entry).collect())
}

/// Returns the names of users who were changed or removed. Who turned the second factor off keeps the sessions.
fn changed<'p>(before: &'p People, now: &People) -> impl Iterator<Item = &'p str> {
    let is_same = |before: &Person, now: &Person| {
        before.role == now.role
            && before.password_hash == now.password_hash
            && (before.has_second_factor || !now.has_second_factor)
    };
    let is_changed =
        move |name: &str, person: &Person| !now.get(name).is_some_and(|now| is_same(person, now));
    before
        .iter()
        .filter(move |(name, person)| is_changed(name, person))
        .map(|(name, _)| name.as_str())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changed_and_removed_users_are_found() {
        let people = |people: &[(&str, &str, &str, bool)]| -> People {
            let person =
                |(name, role, password_hash, has_second_factor): &(&str, &str, &str, bool)| {
                    let (role, password_hash) = ((*role).into(), (*password_hash).into());
                    (
                        (*name).into(),
                        Person { role, password_hash, has_second_factor: *has_second_factor },
                    )
                };
            people.iter().map(person).collect()
        };
        let before = people(&[
            ("eva", "E", "1", false),
            ("otto", "O", "2", false),
            ("vera", "V", "3", false),
            ("ida", "E", "4", false),
            ("on", "E", "5", false),
            ("off", "E", "6", true),
        ]);
        let now = people(&[
            ("eva", "E", "1", false),
            ("otto", "V", "2", false),
            ("vera", "V", "9", false),
            ("new", "E", "5", false),
            ("on", "E", "5", true),
            ("off", "E", "6", false),
        ]);
        let mut found: Vec<_> = changed(&before, &now).collect();
        found.sort_unstable();
        assert_eq!(found, ["ida", "on", "otto", "vera"]);
    }
}
