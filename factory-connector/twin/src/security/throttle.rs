//! Throttling of sign-in attempts. Pure.

use std::{
    collections::HashMap,
    hash::Hash,
    net::IpAddr,
    time::{Duration, Instant},
};

/// Most entries of each kind that are counted. Any client may send any name; beyond it the oldest are forgotten.
const ENTRIES_MAX: usize = 10_000;
/// Failures allowed from one address, and of one user from anywhere, as a multiple of those of one user from one address.
/// The first stops a client that tries one password with many names, the second a guess from many addresses.
const FACTOR: u32 = 10;

/// Counts attempts per user and address within a window. An attempt counts as failed from its beginning, so that
/// attempts at the same time are no way around the limit.
#[derive(Debug)]
pub(crate) struct Throttle {
    failures_max: u32,
    window: Duration,
    by_user_and_address: Counts<(String, Option<IpAddr>)>,
    by_user: Counts<String>,
    by_address: Counts<Option<IpAddr>>,
}

impl Throttle {
    /// Creates a throttle without failures; allows at least one.
    pub fn new(failures_max: u32, window: Duration) -> Self {
        Self {
            failures_max: failures_max.max(1),
            window,
            by_user_and_address: Counts::default(),
            by_user: Counts::default(),
            by_address: Counts::default(),
        }
    }

    /// Begins an attempt. False when no password may be checked.
    pub fn begin(&mut self, user: &str, address: Option<IpAddr>, now: Instant) -> bool {
        let both = (user.to_owned(), address);
        let (max, window) = (self.failures_max, self.window);
        let many = max.saturating_mul(FACTOR);
        if self.by_user_and_address.count(&both, window, now) >= max
            || self.by_user.count(&both.0, window, now) >= many
            || self.by_address.count(&address, window, now) >= many
        {
            return false;
        }
        self.by_user_and_address.add(both, window, now);
        self.by_user.add(user.to_owned(), window, now);
        self.by_address.add(address, window, now);
        true
    }

    /// Ends an attempt with the right password, or one whose password was not checked.
    pub fn take_back(&mut self, user: &str, address: Option<IpAddr>) {
        self.by_user_and_address.take_back(&(user.to_owned(), address));
        self.by_user.take_back(&user.to_owned());
        self.by_address.take_back(&address);
    }

    /// Ends an attempt with the right password: the user's failures from this address are forgotten.
    pub fn succeeded(&mut self, user: &str, address: Option<IpAddr>) {
        self.take_back(user, address);
        self.by_user_and_address.forget(&(user.to_owned(), address));
    }
}

#[derive(Debug)]
struct Counts<K>(HashMap<K, Failures>);

#[derive(Debug, Clone, Copy)]
struct Failures {
    count: u32,
    first: Instant,
}

impl Failures {
    fn is_within(&self, window: Duration, now: Instant) -> bool {
        now.saturating_duration_since(self.first) < window
    }
}

impl<K> Default for Counts<K> {
    fn default() -> Self {
        Self(HashMap::new())
    }
}

impl<K: Hash + Eq + Clone> Counts<K> {
    fn count(&self, key: &K, window: Duration, now: Instant) -> u32 {
        self.0.get(key).filter(|failures| failures.is_within(window, now)).map_or(0, |f| f.count)
    }

    fn add(&mut self, key: K, window: Duration, now: Instant) {
        if self.0.len() >= ENTRIES_MAX && !self.0.contains_key(&key) {
            self.0.retain(|_, failures| failures.is_within(window, now));
            if self.0.len() >= ENTRIES_MAX
                && let Some(oldest) = self
                    .0
                    .iter()
                    .min_by_key(|(_, failures)| failures.first)
                    .map(|(key, _)| key.clone())
            {
                self.0.remove(&oldest);
            }
        }
        let failures = self.0.entry(key).or_insert(Failures { count: 0, first: now });
        if !failures.is_within(window, now) {
            *failures = Failures { count: 0, first: now };
        }
        failures.count = failures.count.saturating_add(1);
    }

    fn take_back(&mut self, key: &K) {
        if let Some(failures) = self.0.get_mut(key) {
            failures.count = failures.count.saturating_sub(1);
            if failures.count == 0 {
                self.0.remove(key);
            }
        }
    }

    fn forget(&mut self, key: &K) {
        self.0.remove(key);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WINDOW: Duration = Duration::from_secs(60);

    fn address(host: u8) -> Option<IpAddr> {
        Some(IpAddr::from([10, 0, 0, host]))
    }

    #[test]
    fn failures_block_a_user_at_an_address_for_the_window() {
        let start = Instant::now();
        let mut throttle = Throttle::new(3, WINDOW);
        for _ in 0..3 {
            assert!(throttle.begin("anna", address(1), start));
        }
        assert!(!throttle.begin("anna", address(1), start + Duration::from_secs(59)));
        assert!(throttle.begin("bert", address(1), start), "others are not locked out");
        assert!(throttle.begin("anna", address(2), start), "nor is she, at another address");
        assert!(throttle.begin("anna", address(1), start + WINDOW));
        throttle.succeeded("anna", address(1));
        for _ in 0..3 {
            assert!(throttle.begin("anna", address(1), start + Duration::from_secs(61)));
        }
    }

    #[test]
    fn attempts_at_the_same_time_count_before_they_end() {
        let now = Instant::now();
        let mut throttle = Throttle::new(3, WINDOW);
        let begun = (0..20).filter(|_| throttle.begin("anna", address(1), now)).count();
        assert_eq!(begun, 3);
        throttle.take_back("anna", address(1));
        assert!(throttle.begin("anna", address(1), now), "one that was not checked is no failure");
        assert!(!throttle.begin("anna", address(1), now));
    }

    #[test]
    fn one_client_locks_out_itself_and_nobody_else() {
        let now = Instant::now();
        let mut throttle = Throttle::new(3, WINDOW);
        let begun = (0..100)
            .filter(|guess| throttle.begin(&format!("user{guess}"), address(1), now))
            .count();
        assert_eq!(begun, 30);
        assert!(!throttle.begin("anna", address(1), now));
        assert!(throttle.begin("anna", address(2), now));
    }

    #[test]
    fn guesses_from_many_addresses_end_for_their_user() {
        let now = Instant::now();
        let mut throttle = Throttle::new(3, WINDOW);
        let begun = (0..100).filter(|host| throttle.begin("anna", address(*host), now)).count();
        assert_eq!(begun, 30);
        assert!(throttle.begin("bert", address(1), now));
    }

    #[test]
    fn names_without_end_take_no_memory_without_end() {
        let now = Instant::now();
        let mut throttle = Throttle::new(3, WINDOW);
        for guess in 0..(ENTRIES_MAX as u32 + 100) {
            let address = Some(IpAddr::from(guess.to_be_bytes()));
            assert!(throttle.begin(&format!("user{guess}"), address, now));
        }
        assert_eq!(throttle.by_user.0.len(), ENTRIES_MAX);
        assert_eq!(throttle.by_user_and_address.0.len(), ENTRIES_MAX);
        assert_eq!(throttle.by_address.0.len(), ENTRIES_MAX);
    }
}
