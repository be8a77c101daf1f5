//! Challenges that were given out: bound to their user, good once, for a short time, and few.

use std::{
    collections::VecDeque,
    time::{Duration, Instant},
};

/// Challenges of a user at once; one more takes the place of the oldest.
const CHALLENGES_PER_USER_MAX: usize = 8;
/// Challenges at once; one more takes the place of the oldest.
const CHALLENGES_MAX: usize = 1024;

/// Challenges that wait for the answer of an authenticator, in memory alone.
pub(in super::super) struct OpenChallenges<S> {
    lifetime: Duration,
    /// Queue by the time of the begin, so that those that expire are in front.
    open: VecDeque<OpenChallenge<S>>,
}

struct OpenChallenge<S> {
    user_name: String,
    challenge: u128,
    begun_at: Instant,
    state: S,
}

impl<S> OpenChallenges<S> {
    pub(in super::super) const fn new(lifetime: Duration) -> Self {
        Self { lifetime, open: VecDeque::new() }
    }

    /// Stores a challenge that was made for a user.
    pub(in super::super) fn put(
        &mut self,
        user_name: &str,
        challenge: u128,
        state: S,
        now: Instant,
    ) {
        self.forget_expired(now);
        let own = self.open.iter().filter(|open| open.user_name == user_name).count();
        if own >= CHALLENGES_PER_USER_MAX
            && let Some(oldest) = self.open.iter().position(|open| open.user_name == user_name)
        {
            self.open.remove(oldest);
        }
        if self.open.len() >= CHALLENGES_MAX {
            self.open.pop_front();
        }
        let user_name = user_name.to_owned();
        self.open.push_back(OpenChallenge { user_name, challenge, begun_at: now, state });
    }

    /// Takes the challenge of a user out; `None` where it is another's, was used or has expired.
    pub(in super::super) fn take(
        &mut self,
        user_name: &str,
        challenge: u128,
        now: Instant,
    ) -> Option<S> {
        self.forget_expired(now);
        let found = self
            .open
            .iter()
            .position(|open| open.challenge == challenge && open.user_name == user_name)?;
        self.open.remove(found).map(|open| open.state)
    }

    fn forget_expired(&mut self, now: Instant) {
        let lifetime = self.lifetime;
        let is_over =
            |open: &OpenChallenge<S>| now.saturating_duration_since(open.begun_at) >= lifetime;
        while self.open.front().is_some_and(is_over) {
            self.open.pop_front();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIFETIME: Duration = Duration::from_secs(120);

    #[test]
    fn a_challenge_is_its_users_and_good_once_for_a_while() {
        let (mut open, now) = (OpenChallenges::new(LIFETIME), Instant::now());
        open.put("ann", 1, 'a', now);
        open.put("ann", 2, 'b', now + LIFETIME / 2);
        assert_eq!(open.take("bob", 1, now), None, "another's");
        assert_eq!(open.take("ann", 1, now), Some('a'));
        assert_eq!(open.take("ann", 1, now), None, "used");
        open.put("ann", 3, 'c', now + LIFETIME);
        assert_eq!(open.take("ann", 2, now + LIFETIME * 3 / 2), None, "expired");
        assert_eq!(open.take("ann", 3, now + LIFETIME * 3 / 2), Some('c'));
    }

    #[test]
    fn a_flood_displaces_its_own_challenges_first() {
        let (mut open, now) = (OpenChallenges::new(LIFETIME), Instant::now());
        open.put("bob", 0, (), now);
        for challenge in 1..=100 {
            open.put("ann", challenge, (), now);
        }
        assert_eq!(open.open.len(), 1 + CHALLENGES_PER_USER_MAX);
        assert_eq!(open.take("ann", 92, now), None);
        assert_eq!(open.take("ann", 93, now), Some(()));
        assert_eq!(open.take("bob", 0, now), Some(()));
        for challenge in 0..10_000_u32 {
            open.put(&format!("user {challenge}"), challenge.into(), (), now);
        }
        assert_eq!(open.open.len(), CHALLENGES_MAX);
    }
}
