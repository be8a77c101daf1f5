//! Slowing down those who guess passwords, without locking anybody out for long.

use std::{
    collections::HashMap,
    net::IpAddr,
    time::{Duration, Instant},
};

/// Limits of failed attempts to sign in, per address and user, and tenfold per address.
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

/// Most pairs of address and user remembered; beyond, the quietest is forgotten. Any caller may
/// make up names.
const ENTRIES_MAX: usize = 10_000;

/// Counts failures per client address and user name, and per address alone with ten times the
/// patience.
#[derive(Debug)]
pub struct LoginThrottle {
    config: ThrottleConfig,
    entries: HashMap<(IpAddr, Option<String>), FailedAttempts>,
}

#[derive(Debug, Clone, Copy)]
struct FailedAttempts {
    failures: u32,
    last: Instant,
}

impl LoginThrottle {
    /// Makes one for which no sign-in has failed yet.
    #[must_use]
    pub fn new(config: ThrottleConfig) -> Self {
        Self { config, entries: HashMap::new() }
    }

    /// Checks that an attempt is allowed now.
    ///
    /// # Errors
    /// The time left to wait.
    pub fn check(&self, client: IpAddr, user_name: &str, now: Instant) -> Result<(), Duration> {
        let wait = self
            .wait(&(client, Some(user_name.to_owned())), self.config.free_failures, now)
            .max(self.wait(&(client, None), self.config.free_failures.saturating_mul(10), now));
        if wait.is_zero() { Ok(()) } else { Err(wait) }
    }

    /// Counts a failed attempt for the user at the address and for the address.
    pub fn failed(&mut self, client: IpAddr, user_name: &str, now: Instant) {
        let longest = self.config.longest_wait;
        for key in [(client, Some(user_name.to_owned())), (client, None)] {
            let entry =
                self.entries.entry(key).or_insert(FailedAttempts { failures: 0, last: now });
            if now.duration_since(entry.last) > longest {
                entry.failures = 0;
            }
            *entry = FailedAttempts { failures: entry.failures.saturating_add(1), last: now };
        }
        if self.entries.len() > ENTRIES_MAX {
            self.entries.retain(|_, entry| now.duration_since(entry.last) <= longest);
        }
        while self.entries.len() > ENTRIES_MAX {
            let quietest =
                self.entries.iter().min_by_key(|(_, entry)| entry.last).map(|(key, _)| key.clone());
            let Some(key) = quietest else { break };
            self.entries.remove(&key);
        }
    }

    /// An attempt succeeded: the user's failures are forgotten.
    pub fn succeeded(&mut self, client: IpAddr, user_name: &str) {
        self.entries.remove(&(client, Some(user_name.to_owned())));
    }

    fn wait(&self, key: &(IpAddr, Option<String>), free: u32, now: Instant) -> Duration {
        let Some(entry) = self.entries.get(key) else { return Duration::ZERO };
        let Some(beyond) = entry.failures.checked_sub(free.max(1)) else { return Duration::ZERO };
        let wait = self
            .config
            .first_wait
            .saturating_mul(2_u32.saturating_pow(beyond))
            .min(self.config.longest_wait);
        wait.saturating_sub(now.duration_since(entry.last))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CLIENT: IpAddr = IpAddr::V4(std::net::Ipv4Addr::LOCALHOST);

    #[test]
    fn waits_grow_and_end() {
        let mut throttle = LoginThrottle::new(ThrottleConfig::default());
        let start = Instant::now();
        for _ in 0..5 {
            assert!(throttle.check(CLIENT, "eve", start).is_ok());
            throttle.failed(CLIENT, "eve", start);
        }
        assert_eq!(throttle.check(CLIENT, "eve", start), Err(Duration::from_secs(1)));
        assert!(throttle.check(CLIENT, "ann", start).is_ok(), "others are not held up");
        let later = start + Duration::from_secs(1);
        assert!(throttle.check(CLIENT, "eve", later).is_ok());
        throttle.failed(CLIENT, "eve", later);
        assert_eq!(throttle.check(CLIENT, "eve", later), Err(Duration::from_secs(2)));
        throttle.succeeded(CLIENT, "eve");
        assert!(throttle.check(CLIENT, "eve", later).is_ok());
    }

    #[test]
    fn trying_many_names_from_one_address_is_slowed_too() {
        let mut throttle = LoginThrottle::new(ThrottleConfig::default());
        let now = Instant::now();
        for number in 0..50 {
            throttle.failed(CLIENT, &format!("user{number}"), now);
        }
        assert!(throttle.check(CLIENT, "other", now).is_err());
    }

    #[test]
    fn memory_is_bounded() {
        let mut throttle = LoginThrottle::new(ThrottleConfig::default());
        let now = Instant::now();
        for number in 0..10_100_u32 {
            throttle.failed(IpAddr::from(number.to_be_bytes()), "eve", now);
        }
        assert!(throttle.entries.len() <= ENTRIES_MAX + 1);
    }
}
