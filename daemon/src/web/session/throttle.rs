//! Slowing down those who guess passwords, without locking anybody out for long.
//!
//! An attempt counts from its beginning, for its user and for the place that it comes from, and is
//! given back where it turns out right. So guesses that run beside each other are as few as those that
//! follow each other. A user is counted over all places; a place from which the user has signed in
//! before has a count of its own, so that strangers cannot lock a person out at the usual place.

use std::{
    collections::HashMap,
    net::IpAddr,
    time::{Duration, Instant},
};

use rand::RngCore;
use sha2::{Digest, Sha256};

use crate::web::address_range::AddressRange;

/// Limits of failed attempts to sign in, per user, and tenfold per place: an address of IPv4, or a /64
/// of IPv6.
#[derive(Debug, Clone)]
pub struct ThrottleConfig {
    /// Failures before the first wait.
    pub free_failures: u32,
    /// The wait after the first failure beyond; doubles with each further one.
    pub first_wait: Duration,
    /// The longest wait; a quiet time of this length also forgets the failures.
    pub longest_wait: Duration,
}

impl Default for ThrottleConfig {
    fn default() -> Self {
        Self {
            free_failures: 5,
            first_wait: Duration::from_secs(1),
            longest_wait: Duration::from_secs(300),
        }
    }
}

/// Most users and places remembered; beyond, the one with the fewest failures is forgotten. Any caller
/// may make up names.
const COUNTS_MAX: usize = 10_000;
/// Most pairs of user and usual place remembered; beyond, the one longest unused is forgotten.
const USUAL_PLACES_MAX: usize = 10_000;
/// Pause between two searches for what can be forgotten by time.
const PURGE_INTERVAL: Duration = Duration::from_secs(1);
/// Patience with a place, which may be an office with many people, in times of that with a user.
const PLACE_FACTOR: u32 = 10;

/// Digest of a user, of a place or of both. Names are of any length and tell who tries; digests are
/// short and tell nobody.
type CountKey = [u8; 16];

/// Counts failures per user and per place.
pub struct LoginThrottle {
    config: ThrottleConfig,
    /// Made at the start, so that nobody can prepare names whose digests are alike.
    secret: [u8; 32],
    counts: HashMap<CountKey, Count>,
    /// Last sign-in of a user at a place.
    usual_places: HashMap<CountKey, Instant>,
    purged_at: Option<Instant>,
}

#[derive(Debug, Clone, Copy)]
struct Count {
    failures: u32,
    /// Attempts whose outcome is open.
    open: u32,
    last: Instant,
}

/// An attempt that has begun.
#[derive(Debug, Clone, Copy)]
pub struct Attempt {
    user: CountKey,
    place: CountKey,
    user_at_place: CountKey,
}

/// Reason why an attempt cannot begin.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Hindrance {
    /// Time left to wait, after too many failures.
    Wait(Duration),
    /// Number of attempts under way that would be too many if they failed.
    Undecided,
}

impl LoginThrottle {
    /// Makes one for which no sign-in has failed yet.
    #[must_use]
    pub fn new(config: ThrottleConfig) -> Self {
        let mut secret = [0_u8; 32];
        rand::rng().fill_bytes(&mut secret);
        let (counts, usual_places) = (HashMap::new(), HashMap::new());
        Self { config, secret, counts, usual_places, purged_at: None }
    }

    /// Begins an attempt, which counts until its outcome is told.
    ///
    /// # Errors
    /// `Hindrance`; then nothing was counted.
    pub fn begin(
        &mut self,
        client: IpAddr,
        user_name: &str,
        now: Instant,
    ) -> Result<Attempt, Hindrance> {
        self.purge(now);
        let place = AddressRange::of_client(client).to_string();
        let user_at_place = self.user_at_place(user_name, &place);
        let user = if self.usual_places.contains_key(&user_at_place) {
            user_at_place
        } else {
            self.key(&[b"user", user_name.as_bytes()])
        };
        let attempt =
            Attempt { user, place: self.key(&[b"place", place.as_bytes()]), user_at_place };
        let free = self.config.free_failures.max(1);
        self.check(&attempt.user, free, now)?;
        self.check(&attempt.place, free.saturating_mul(PLACE_FACTOR), now)?;
        for key in [attempt.user, attempt.place] {
            self.make_room(&key);
            let count = self.counts.entry(key).or_insert(Count { failures: 0, open: 0, last: now });
            count.open += 1;
        }
        Ok(attempt)
    }

    /// The attempt failed, or nobody waited for its outcome.
    pub fn failed(&mut self, attempt: Attempt, now: Instant) {
        for key in [attempt.user, attempt.place] {
            if let Some(count) = self.close(&key) {
                count.failures = count.failures.saturating_add(1);
                count.last = now;
            }
        }
    }

    /// The attempt succeeded: it is given back, and the failures of its user are forgotten.
    pub fn succeeded(&mut self, attempt: Attempt, now: Instant) {
        if let Some(count) = self.close(&attempt.user) {
            count.failures = 0;
        }
        self.close(&attempt.place);
        self.remember_key(attempt.user_at_place, now);
    }

    /// Returns true where a user has signed in from the client's place before.
    #[must_use]
    pub fn is_usual(&self, client: IpAddr, user_name: &str) -> bool {
        let place = AddressRange::of_client(client).to_string();
        self.usual_places.contains_key(&self.user_at_place(user_name, &place))
    }

    /// Notes that a user has signed in from the client's place before.
    pub fn remember(&mut self, client: IpAddr, user_name: &str, now: Instant) {
        let place = AddressRange::of_client(client).to_string();
        self.remember_key(self.user_at_place(user_name, &place), now);
    }

    fn remember_key(&mut self, user_at_place: CountKey, now: Instant) {
        if self.usual_places.len() >= USUAL_PLACES_MAX
            && !self.usual_places.contains_key(&user_at_place)
            && let Some(oldest) =
                self.usual_places.iter().min_by_key(|(_, last)| **last).map(|(key, _)| *key)
        {
            self.usual_places.remove(&oldest);
        }
        self.usual_places.insert(user_at_place, now);
    }

    /// The attempt was neither right nor wrong: it is given back, and nothing is forgotten.
    pub fn withdrawn(&mut self, attempt: Attempt) {
        self.close(&attempt.user);
        self.close(&attempt.place);
    }

    fn user_at_place(&self, user_name: &str, place: &str) -> CountKey {
        self.key(&[b"usual", user_name.as_bytes(), place.as_bytes()])
    }

    fn key(&self, parts: &[&[u8]]) -> CountKey {
        let mut digest = Sha256::new_with_prefix(self.secret);
        for part in parts {
            digest.update(u64::try_from(part.len()).unwrap_or(u64::MAX).to_be_bytes());
            digest.update(part);
        }
        let mut key = [0; 16];
        key.copy_from_slice(&digest.finalize()[..16]);
        key
    }

    fn check(&self, key: &CountKey, free: u32, now: Instant) -> Result<(), Hindrance> {
        let Some(count) = self.counts.get(key) else { return Ok(()) };
        let Some(beyond) = count.failures.checked_sub(free) else {
            let is_free = count.failures + count.open < free;
            return if is_free { Ok(()) } else { Err(Hindrance::Undecided) };
        };
        let factor = 2_u32.saturating_pow(beyond);
        let wait = self.config.first_wait.saturating_mul(factor).min(self.config.longest_wait);
        let left = wait.saturating_sub(now.saturating_duration_since(count.last));
        match (left.is_zero(), count.open) {
            (false, _) => Err(Hindrance::Wait(left)),
            (true, 0) => Ok(()),
            (true, _) => Err(Hindrance::Undecided),
        }
    }

    fn close(&mut self, key: &CountKey) -> Option<&mut Count> {
        let count = self.counts.get_mut(key)?;
        count.open = count.open.saturating_sub(1);
        Some(count)
    }

    /// Forgets by time.
    fn purge(&mut self, now: Instant) {
        if self.purged_at.is_some_and(|last| now.saturating_duration_since(last) < PURGE_INTERVAL) {
            return;
        }
        self.purged_at = Some(now);
        let longest = self.config.longest_wait;
        self.counts.retain(|_, count| {
            let is_quiet = now.saturating_duration_since(count.last) > longest;
            count.open > 0 || (count.failures > 0 && !is_quiet)
        });
    }

    /// Forgets the count with the fewest failures where there is no room for another. Made-up names have
    /// few each, so that they do not displace the names that a guesser is after.
    fn make_room(&mut self, key: &CountKey) {
        if self.counts.len() < COUNTS_MAX || self.counts.contains_key(key) {
            return;
        }
        let closed = self.counts.iter().filter(|(_, count)| count.open == 0);
        let least = closed.min_by_key(|(_, count)| (count.failures, count.last));
        if let Some(key) = least.map(|(key, _)| *key) {
            self.counts.remove(&key);
        }
    }
}

impl std::fmt::Debug for LoginThrottle {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("LoginThrottle").field("counts", &self.counts.len()).finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests;
