//! Pauses between attempts to connect.

use std::time::Duration;

/// Jittered exponential backoff with a cap. Reset only once data flowed: a broker that accepts
/// connections and drops them must not be hammered.
#[derive(Debug, Clone)]
pub(crate) struct Backoff {
    min: Duration,
    max: Duration,
    permanent: Duration,
    failures: u32,
}

impl Backoff {
    pub(crate) const fn new(min: Duration, max: Duration, permanent: Duration) -> Self {
        Self { min, max, permanent, failures: 0 }
    }

    /// Returns the pause after one more failure. `jitter` in [0, 1) spreads it between half and
    /// all of its length.
    pub(crate) fn after_failure(&mut self, is_permanent: bool, jitter: f64) -> Duration {
        let whole = if is_permanent {
            // Only a person can mend it, and repeated wrong credentials lock accounts.
            self.permanent
        } else {
            // Bounded before the shift: a link that is down for a year must not overflow.
            self.min.saturating_mul(1 << self.failures.min(20)).min(self.max)
        };
        self.failures = self.failures.saturating_add(1);
        // Spread: the connectors of all factories lose a broker at the same moment.
        whole.mul_f64(0.5 + jitter.clamp(0.0, 1.0) / 2.0)
    }

    /// Notes that data flowed: the next failure is the first again.
    pub(crate) const fn reset(&mut self) {
        self.failures = 0;
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const MIN: Duration = Duration::from_millis(200);
    const MAX: Duration = Duration::from_secs(30);
    const PERMANENT: Duration = Duration::from_secs(120);

    #[test]
    fn pauses_double_up_to_the_cap() {
        let mut backoff = Backoff::new(MIN, MAX, PERMANENT);
        let pauses: Vec<_> =
            (0..10).map(|_| backoff.after_failure(false, 1.0).as_millis()).collect();
        assert_eq!(pauses, [200, 400, 800, 1600, 3200, 6400, 12800, 25600, 30000, 30000]);
        assert_eq!(backoff.after_failure(true, 1.0), PERMANENT);
        backoff.reset();
        assert_eq!(backoff.after_failure(false, 0.0), MIN / 2);
    }

    proptest! {
        #[test]
        fn a_pause_is_between_half_and_all_of_its_length(failures in 0u32..100, jitter in 0.0f64..1.0) {
            let mut backoff = Backoff::new(MIN, MAX, PERMANENT);
            for _ in 0..failures { backoff.after_failure(false, jitter); }
            let pause = backoff.after_failure(false, jitter);
            prop_assert!(pause >= MIN / 2 && pause <= MAX);
        }
    }
}
