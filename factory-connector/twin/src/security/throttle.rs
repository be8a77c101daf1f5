//! Throttling of sign-in attempts. Pure.

use std::{
    collections::HashMap,
    time::{Duration, Instant},
};

/// Most user names that are counted; beyond it the oldest failures are dropped. Any client may send
/// any name.
const USERS_MAX: usize = 10_000;
/// Failures allowed on the whole server, as a multiple of those of one user. It stops a client that
/// tries one password with many names.
const SERVER_FACTOR: u32 = 10;

/// Counts failures per user and over the whole server within a window.
#[derive(Debug)]
pub(crate) struct Throttle {
    failures_max: u32,
    window: Duration,
    users: HashMap<String, Failures>,
    server: Option<Failures>,
}

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

impl Throttle {
    /// Creates a throttle without failures; allows at least one.
    pub fn new(failures_max: u32, window: Duration) -> Self {
        Self { failures_max: failures_max.max(1), window, users: HashMap::new(), server: None }
    }

    /// Returns whether a password may be checked.
    pub fn may_try(&self, user: &str, now: Instant) -> bool {
        let is_open = |failures: Option<&Failures>, max: u32| {
            failures.is_none_or(|f| f.count < max || !f.is_within(self.window, now))
        };
        is_open(self.users.get(user), self.failures_max)
            && is_open(self.server.as_ref(), self.failures_max.saturating_mul(SERVER_FACTOR))
    }

    /// Counts a wrong password.
    pub fn failed(&mut self, user: &str, now: Instant) {
        if self.users.len() >= USERS_MAX {
            let window = self.window;
            self.users.retain(|_, failures| failures.is_within(window, now));
            if self.users.len() >= USERS_MAX {
                self.users.clear();
            }
        }
        let window = self.window;
        let count = |failures: Option<Failures>| match failures {
            Some(f) if f.is_within(window, now) => {
                Failures { count: f.count.saturating_add(1), ..f }
            }
            _ => Failures { count: 1, first: now },
        };
        let of_user = count(self.users.get(user).copied());
        self.users.insert(user.to_owned(), of_user);
        self.server = Some(count(self.server));
    }

    /// Resets the failures of a user.
    pub fn succeeded(&mut self, user: &str) {
        self.users.remove(user);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn failures_block_a_user_for_the_window() {
        let start = Instant::now();
        let mut throttle = Throttle::new(3, Duration::from_secs(60));
        for _ in 0..3 {
            assert!(throttle.may_try("anna", start));
            throttle.failed("anna", start);
        }
        assert!(!throttle.may_try("anna", start + Duration::from_secs(59)));
        assert!(throttle.may_try("bert", start), "others are not locked out");
        assert!(throttle.may_try("anna", start + Duration::from_secs(60)));
        throttle.failed("anna", start + Duration::from_secs(60));
        throttle.succeeded("anna");
        assert!(throttle.may_try("anna", start + Duration::from_secs(61)));
    }

    #[test]
    fn failures_of_many_users_block_the_server() {
        let now = Instant::now();
        let mut throttle = Throttle::new(3, Duration::from_secs(60));
        for guess in 0..30 {
            throttle.failed(&format!("user{guess}"), now);
        }
        assert!(!throttle.may_try("fresh", now));
    }
}
