//! Sign-ins that have failed, counted by network, by user, and by both, so that secrets are guessed
//! slowly. What was counted is forgotten with time, one failure after the other.
//!
//! A user is never locked out by what others do elsewhere: while guesses for a user come from many
//! networks, each network still has one attempt, and who has signed in from a network before has as
//! many as in quiet times.

use std::{
    collections::HashMap,
    net::IpAddr,
    time::{Duration, Instant},
};

use parking_lot::Mutex;
use sha2::{Digest, Sha256};

use crate::waiting::network;

/// Failures of one user from one network.
const OF_USER_AND_NETWORK: Bound = Bound { failures: 20, forgotten_after: Duration::from_secs(6) };
/// Failures from one network, which may be a plant with many programs.
const OF_NETWORK: Bound = Bound { failures: 200, forgotten_after: Duration::from_millis(600) };
/// Failures of one user from all networks, beyond which a network has a single attempt.
const OF_USER: Bound = Bound { failures: 200, forgotten_after: Duration::from_millis(600) };
/// Failures of one user from one network while [`OF_USER`] is exceeded.
const OF_GUESSED_USER: Bound = Bound { failures: 1, ..OF_USER_AND_NETWORK };
/// Most counts; beyond, that with the fewest failures is forgotten. Any peer may make up names.
const COUNTS_MAX: usize = 10_000;
/// Most pairs of user and network remembered that have signed in; beyond, the one longest unused is
/// forgotten.
const USUAL_MAX: usize = 10_000;

/// Most failures, and the time after which one of them is forgotten.
#[derive(Clone, Copy)]
struct Bound {
    failures: u32,
    forgotten_after: Duration,
}

#[derive(Clone, Copy, PartialEq, Eq, Hash)]
enum Key {
    Network(IpAddr),
    /// Digest of the name: names are of any length.
    User([u8; 32]),
    UserAt([u8; 32], IpAddr),
}

/// Counts of one broker.
#[derive(Default)]
pub(crate) struct Guesses {
    state: Mutex<Counts>,
}

#[derive(Default)]
struct Counts {
    /// Times at which all failures of a count are forgotten.
    counts: HashMap<Key, Instant>,
    /// Last sign-ins of users from networks.
    usual: HashMap<([u8; 32], IpAddr), Instant>,
}

/// An attempt that counts as failed until it turns out right.
pub(crate) struct Attempt {
    user: [u8; 32],
    network: IpAddr,
}

impl Guesses {
    /// Begins an attempt; none where too many have failed.
    pub(crate) fn begin(&self, peer: IpAddr, user_name: &str, now: Instant) -> Option<Attempt> {
        let (user, network) = (Sha256::digest(user_name).into(), network(peer));
        let mut state = self.state.lock();
        let is_usual = state.usual.contains_key(&(user, network));
        let is_guessed = !is_usual && state.is_exceeded(Key::User(user), OF_USER, now);
        let of_pair = if is_guessed { OF_GUESSED_USER } else { OF_USER_AND_NETWORK };
        if state.is_exceeded(Key::UserAt(user, network), of_pair, now)
            // Who is known at a network does not wait for its other programs.
            || (!is_usual && state.is_exceeded(Key::Network(network), OF_NETWORK, now))
        {
            return None;
        }
        let attempt = Attempt { user, network };
        // From the beginning, so that attempts beside each other are as few as those in a row.
        for (key, bound) in attempt.counts() {
            state.make_room(key, now);
            let until = state.counts.entry(key).or_insert(now);
            *until = (*until).max(now) + bound.forgotten_after;
        }
        Some(attempt)
    }

    /// The attempt was right: it is given back, and the failures of its user from its network are
    /// forgotten.
    pub(crate) fn succeeded(&self, attempt: &Attempt, now: Instant) {
        let mut state = self.state.lock();
        for (key, bound) in attempt.counts() {
            if let Some(until) = state.counts.get_mut(&key) {
                *until = until.checked_sub(bound.forgotten_after).unwrap_or(now);
            }
        }
        let Attempt { user, network } = *attempt;
        state.counts.remove(&Key::UserAt(user, network));
        if state.usual.len() >= USUAL_MAX
            && let Some(oldest) =
                state.usual.iter().min_by_key(|(_, last)| **last).map(|(pair, _)| *pair)
        {
            state.usual.remove(&oldest);
        }
        state.usual.insert((user, network), now);
    }
}

impl Attempt {
    const fn counts(&self) -> [(Key, Bound); 3] {
        [
            (Key::UserAt(self.user, self.network), OF_USER_AND_NETWORK),
            (Key::User(self.user), OF_USER),
            (Key::Network(self.network), OF_NETWORK),
        ]
    }
}

impl Counts {
    /// Returns whether there are as many failures as a bound permits.
    fn is_exceeded(&self, key: Key, bound: Bound, now: Instant) -> bool {
        let Some(until) = self.counts.get(&key) else { return false };
        let left = until.saturating_duration_since(now);
        left > bound.forgotten_after * (bound.failures - 1)
    }

    /// Forgets what time has, and beyond the bound the count with the fewest failures.
    fn make_room(&mut self, key: Key, now: Instant) {
        if self.counts.len() < COUNTS_MAX || self.counts.contains_key(&key) {
            return;
        }
        self.counts.retain(|_, until| *until > now);
        if self.counts.len() < COUNTS_MAX {
            return;
        }
        let least = self.counts.iter().min_by_key(|(_, until)| **until).map(|(key, _)| *key);
        if let Some(least) = least {
            self.counts.remove(&least);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn address(at: u32) -> IpAddr {
        IpAddr::from(0x0a00_0000_u32.wrapping_add(at).to_be_bytes())
    }

    /// Guesses until refused; returns how many attempts there were.
    fn guess(guesses: &Guesses, at: u32, user: &str, now: Instant) -> u32 {
        (0..10_000)
            .find(|_| guesses.begin(address(at), user, now).is_none())
            .expect("guesses are refused")
    }

    #[test]
    fn guesses_of_a_user_are_few_and_become_possible_again_one_by_one() {
        let (guesses, now) = (Guesses::default(), Instant::now());
        assert_eq!(guess(&guesses, 1, "f1", now), 20);
        let later = now + Duration::from_secs(6);
        assert_eq!(guess(&guesses, 1, "f1", later), 1, "one is forgotten");
        assert_eq!(guess(&guesses, 1, "f1", later + Duration::from_secs(3600)), 20);
    }

    #[test]
    fn a_network_guesses_for_many_users_as_little_as_for_ten() {
        let (guesses, now) = (Guesses::default(), Instant::now());
        let tried: u32 = (0..50).map(|user| guess(&guesses, 1, &format!("f{user}"), now)).sum();
        assert_eq!(tried, 200);
        assert!(guesses.begin(address(2), "f1", now).is_some(), "another network is served");
    }

    #[test]
    fn guesses_from_elsewhere_lock_out_nobody() {
        let (guesses, now) = (Guesses::default(), Instant::now());
        let usual = guesses.begin(address(1), "f1", now).expect("an attempt");
        guesses.succeeded(&usual, now);
        let tried: u32 = (100..200).map(|at| guess(&guesses, at, "f1", now)).sum();
        assert_eq!(tried, 10 * 20 + 90, "after ten networks each has one attempt");
        let elsewhere = guesses.begin(address(2), "f1", now);
        guesses.succeeded(&elsewhere.expect("a first attempt from a new network"), now);
        assert_eq!(guess(&guesses, 1, "f1", now), 20, "at the usual network as in quiet times");
    }

    #[test]
    fn who_is_known_at_a_network_does_not_wait_for_its_other_programs() {
        let (guesses, now) = (Guesses::default(), Instant::now());
        let usual = guesses.begin(address(1), "f1", now).expect("an attempt");
        guesses.succeeded(&usual, now);
        for user in 0..50 {
            guess(&guesses, 1, &format!("made-up-{user}"), now);
        }
        assert!(guesses.begin(address(1), "f2", now).is_none(), "the network has to wait");
        assert!(guesses.begin(address(1), "f1", now).is_some());
    }

    #[test]
    fn made_up_names_take_bounded_memory_and_do_not_displace_those_that_are_guessed() {
        let (guesses, now) = (Guesses::default(), Instant::now());
        assert_eq!(guess(&guesses, 1, "f1", now), 20);
        for at in 2..4_000 {
            guesses.begin(address(at), &at.to_string(), now);
        }
        assert_eq!(guesses.state.lock().counts.len(), COUNTS_MAX);
        assert!(guesses.begin(address(1), "f1", now).is_none(), "f1 is not forgotten");
    }
}
