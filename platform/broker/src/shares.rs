//! Shares of users and organisations in sessions, links and unsettled bytes, over all their connections.
//!
//! A session, a link and each direction of it buffer frames of their own, and a link a message that is
//! not complete: so their numbers bound the memory that one user can make the broker spend.

use std::{
    collections::HashMap,
    sync::{
        Arc, Weak,
        atomic::{AtomicU64, Ordering},
    },
};

use parking_lot::Mutex;
use tokio::sync::{Notify, OwnedSemaphorePermit, Semaphore};

use crate::{config::BrokerLimits, credentials::BrokerUser};

/// Sessions and links of one user or one organisation.
struct Share {
    sessions: Arc<Semaphore>,
    links: Arc<Semaphore>,
}

impl Share {
    fn new(sessions: usize, links: usize) -> Arc<Self> {
        let (sessions, links) =
            (Arc::new(Semaphore::new(sessions)), Arc::new(Semaphore::new(links)));
        Arc::new(Self { sessions, links })
    }
}

/// All shares that are in use.
#[derive(Default)]
pub(crate) struct ShareTable {
    users: Mutex<HashMap<String, Weak<UserShare>>>,
    organisations: Mutex<HashMap<String, Weak<Share>>>,
}

/// Share of a user, for all of its connections.
pub(crate) struct UserShare {
    /// Name under which refusals are counted: the organisation, or the user where it has none.
    who: String,
    /// Absent for the broker's owner.
    of_user: Option<Arc<Share>>,
    of_organisation: Option<Arc<Share>>,
    unsettled: Arc<UnsettledShare>,
}

/// Right to a session or link; given back when dropped.
pub(crate) type Held = [Option<OwnedSemaphorePermit>; 2];

impl ShareTable {
    /// Returns the share of a user who signed in.
    pub(crate) fn of(
        &self,
        user_name: &str,
        user: &BrokerUser,
        limits: &BrokerLimits,
    ) -> Arc<UserShare> {
        let mut users = self.users.lock();
        if let Some(known) = users.get(user_name).and_then(Weak::upgrade) {
            return known;
        }
        users.retain(|_, share| share.strong_count() > 0);
        let organisation = user.organisation.as_deref().filter(|_| !user.is_owner);
        let share = Arc::new(UserShare {
            who: organisation.unwrap_or(user_name).to_owned(),
            of_user: (!user.is_owner)
                .then(|| Share::new(limits.sessions_per_user_max, limits.links_per_user_max)),
            of_organisation: organisation.map(|id| self.of_organisation(id, limits)),
            unsettled: Arc::new(UnsettledShare::new(if user.is_owner {
                u64::MAX
            } else {
                limits.unsettled_bytes_per_user_max
            })),
        });
        users.insert(user_name.to_owned(), Arc::downgrade(&share));
        share
    }

    fn of_organisation(&self, id: &str, limits: &BrokerLimits) -> Arc<Share> {
        let mut organisations = self.organisations.lock();
        if let Some(known) = organisations.get(id).and_then(Weak::upgrade) {
            return known;
        }
        organisations.retain(|_, share| share.strong_count() > 0);
        let share =
            Share::new(limits.sessions_per_organisation_max, limits.links_per_organisation_max);
        organisations.insert(id.to_owned(), Arc::downgrade(&share));
        share
    }
}

impl UserShare {
    /// Takes a session; none where user or organisation have no more.
    pub(crate) fn session(&self) -> Option<Held> {
        self.take("sessions", |share| &share.sessions)
    }

    /// Takes a link; none where user or organisation have no more.
    pub(crate) fn link(&self) -> Option<Held> {
        self.take("links", |share| &share.links)
    }

    pub(crate) fn unsettled(&self) -> Arc<UnsettledShare> {
        Arc::clone(&self.unsettled)
    }

    fn take(&self, label: &'static str, of: impl Fn(&Share) -> &Arc<Semaphore>) -> Option<Held> {
        let take = |share: &Option<Arc<Share>>| match share {
            Some(share) => Arc::clone(of(share)).try_acquire_owned().map(Some),
            None => Ok(None),
        };
        // The first is given back where the second is not to be had.
        let held = take(&self.of_user).and_then(|user| Ok([user, take(&self.of_organisation)?]));
        if held.is_err() {
            self.count_refusal(label);
        }
        held.ok()
    }

    /// Counts a refusal under the name of who has used the share up.
    pub(crate) fn count_refusal(&self, label: &'static str) {
        count_refusal(label, &self.who);
    }
}

/// Counts a refusal of a share, under a name of which there are no more than accounts.
pub(crate) fn count_refusal(share: &'static str, who: &str) {
    let who = who.to_owned();
    metrics::counter!("broker_share_refusals_total", "share" => share, "who" => who).increment(1);
}

/// Bytes of the messages that a user's consumers have not settled.
pub(crate) struct UnsettledShare {
    bytes: AtomicU64,
    bytes_max: u64,
    /// Notified when there are fewer.
    fewer: Notify,
}

impl UnsettledShare {
    fn new(bytes_max: u64) -> Self {
        Self { bytes: AtomicU64::new(0), bytes_max, fewer: Notify::new() }
    }

    pub(crate) fn has_room(&self) -> bool {
        self.bytes.load(Ordering::Relaxed) < self.bytes_max
    }

    pub(crate) fn add(&self, bytes: u64) {
        self.bytes.fetch_add(bytes, Ordering::Relaxed);
    }

    pub(crate) fn remove(&self, bytes: u64) {
        self.bytes.fetch_sub(bytes, Ordering::Relaxed);
        self.fewer.notify_waiters();
    }

    /// Resolves at the next removal after this call.
    pub(crate) fn fewer(&self) -> impl Future<Output = ()> + '_ {
        self.fewer.notified()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn limits() -> BrokerLimits {
        BrokerLimits {
            sessions_per_user_max: 1,
            links_per_user_max: 2,
            links_per_organisation_max: 3,
            unsettled_bytes_per_user_max: 10,
            ..BrokerLimits::default()
        }
    }

    fn of(organisation: &str) -> BrokerUser {
        BrokerUser { organisation: Some(organisation.to_owned()), ..BrokerUser::default() }
    }

    #[test]
    fn users_and_organisations_have_links_of_their_own() {
        let table = ShareTable::default();
        let one = table.of("one", &of("a"), &limits());
        let again = table.of("one", &of("a"), &limits());
        let held = [one.link(), again.link()];
        assert!(
            held.iter().all(Option::is_some) && one.link().is_none(),
            "two connections, one user"
        );
        let two = table.of("two", &of("a"), &limits());
        let last = two.link();
        assert!(last.is_some() && two.link().is_none(), "the organisation has three");
        assert!(table.of("three", &of("b"), &limits()).link().is_some(), "another organisation");
        drop(held);
        assert!(two.link().is_some(), "given back");
    }

    #[test]
    fn what_an_organisation_lacks_is_not_taken_from_its_user() {
        let table = ShareTable::default();
        let (one, two) =
            (table.of("one", &of("a"), &limits()), table.of("two", &of("a"), &limits()));
        let held = [one.link(), one.link(), two.link()];
        for _ in 0..10 {
            assert!(two.link().is_none());
        }
        drop(held);
        let held = [two.link(), two.link()];
        assert!(held.iter().all(Option::is_some), "refusals cost nothing");
    }

    #[test]
    fn the_owner_is_bounded_by_its_connections_alone() {
        let table = ShareTable::default();
        let owner = BrokerUser { is_owner: true, ..of("a") };
        let share = table.of("platform", &owner, &limits());
        let held: Vec<_> = (0..100).map(|_| share.link()).collect();
        assert!(held.iter().all(Option::is_some));
    }

    #[test]
    fn unsettled_bytes_are_shared_by_the_links_of_a_user() {
        let table = ShareTable::default();
        let share = table.of("one", &of("a"), &limits()).unsettled();
        share.add(10);
        assert!(!share.has_room());
        share.remove(1);
        assert!(share.has_room());
    }
}
