//! Intervals that a server grants, and what follows from them: the keep-alive count to request, the
//! silence after which a subscription is given up, and the queue that loses nothing between two
//! publishings. Once the server has answered, nothing is computed from what was requested.

use std::time::Duration;

/// Longest time between two signs of life that is requested.
const KEEP_ALIVE_MAX: Duration = Duration::from_secs(10);
/// Least time without publish requests after which a server deletes a subscription.
const LIFETIME: Duration = Duration::from_secs(30);
/// Part of time by which a server's keep-alive may be late, beside the margin below. Some servers send it two
/// intervals after they should.
const LATE_FACTOR: f64 = 1.25;
const LATE_INTERVALS: u32 = 2;
const LATE_MARGIN_MAX: Duration = Duration::from_secs(1);
/// Longest queue requested when the options have none.
const QUEUE_MAX: u32 = 100;
/// Length of the queue of an item that is sampled on every change.
const QUEUE_ON_CHANGE: u32 = 10;

/// Publishing interval and keep-alive count of a subscription, requested or as the server revised them
/// (OPC 10000-4 §5.14.2.2).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct SubscriptionGrant {
    pub(super) interval: Duration,
    pub(super) keep_alive_count: u32,
}

impl SubscriptionGrant {
    /// Returns the request at a publishing interval, for a source that is given up after so long a
    /// silence.
    pub(super) fn request(interval: Duration, silence_max: Duration) -> Self {
        let wanted = keep_alive_wanted(silence_max).as_secs_f64() / interval.as_secs_f64();
        // Some servers raise 1 to 2.
        Self { interval, keep_alive_count: wanted.floor().max(2.0) as u32 }
    }

    /// Returns the lifetime count to request. One shorter than three keep-alives is not allowed
    /// (OPC 10000-4 §5.14.2.2).
    pub(super) fn lifetime_count(self) -> u32 {
        let cycles = (LIFETIME.as_secs_f64() / self.interval.as_secs_f64()).ceil() as u32;
        cycles.max(self.keep_alive_count.saturating_mul(3))
    }

    /// Returns the time between two signs of life while no value changes.
    pub(super) fn keep_alive(self) -> Duration {
        self.interval.saturating_mul(self.keep_alive_count)
    }

    /// Returns true where the server's signs of life come much more rarely than is wanted, so that the same
    /// request at the granted interval is worth a try.
    pub(super) fn is_quieter_than_wanted(self, silence_max: Duration) -> bool {
        self.keep_alive() > keep_alive_wanted(silence_max).mul_f64(1.5)
    }

    /// Returns the silence after which the subscription is given up: never before the server's next sign
    /// of life is due, with what it may be late.
    pub(super) fn silence_limit(self, silence_max: Duration) -> Duration {
        let count = f64::from(self.keep_alive_count.saturating_add(LATE_INTERVALS));
        let due = self.interval.mul_f64(LATE_FACTOR * count);
        silence_max.max(due + (silence_max / 3).min(LATE_MARGIN_MAX))
    }

    /// Returns the length of a queue that holds all changes between two publishings.
    pub(super) fn queue_size(self, sampling_ms: f64) -> u32 {
        if sampling_ms <= 0.0 {
            return QUEUE_ON_CHANGE;
        }
        let changes = (self.interval.as_secs_f64() * 1000.0 / sampling_ms).ceil();
        changes.clamp(1.0, f64::from(QUEUE_MAX) - 1.0) as u32 + 1
    }

    /// Returns true where changes are lost between two publishings if the value changes as often as it is
    /// sampled.
    pub(super) fn overruns(self, sampling_ms: f64, queue_size: u32) -> bool {
        sampling_ms > 0.0
            && sampling_ms * f64::from(queue_size) < self.interval.as_secs_f64() * 1000.0
    }
}

fn keep_alive_wanted(silence_max: Duration) -> Duration {
    (silence_max / 3).min(KEEP_ALIVE_MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SILENCE: Duration = Duration::from_secs(5);

    fn ms(ms: u64) -> Duration {
        Duration::from_millis(ms)
    }

    fn grant(interval_ms: u64, keep_alive_count: u32) -> SubscriptionGrant {
        SubscriptionGrant { interval: ms(interval_ms), keep_alive_count }
    }

    #[test]
    fn signs_of_life_are_requested_at_the_interval_that_is_granted() {
        let request = |interval_ms| SubscriptionGrant::request(ms(interval_ms), SILENCE);
        assert_eq!(request(20), grant(20, 83));
        assert_eq!(request(500), grant(500, 3));
        assert_eq!(request(1000), grant(1000, 2));
        assert_eq!((request(20).lifetime_count(), request(500).lifetime_count()), (1500, 60));
        // What a controller makes of the first request.
        assert!(grant(500, 83).is_quieter_than_wanted(SILENCE));
        assert!(!grant(500, 3).is_quieter_than_wanted(SILENCE));
    }

    #[test]
    fn no_subscription_is_given_up_before_its_sign_of_life_is_due() {
        assert_eq!(grant(20, 83).silence_limit(SILENCE), SILENCE);
        assert_eq!(grant(500, 3).silence_limit(SILENCE), SILENCE);
        assert_eq!(grant(1000, 2).silence_limit(SILENCE), ms(6000));
        assert_eq!(grant(10_000, 2).silence_limit(SILENCE), ms(51_000));
        for interval_ms in [1, 20, 60, 100, 500, 1000, 10_000] {
            for count in [1, 2, 10, 84, 100] {
                let grant = grant(interval_ms, count);
                assert!(grant.silence_limit(SILENCE) > grant.keep_alive() + grant.interval);
            }
        }
    }

    #[test]
    fn queues_hold_all_changes_between_two_publishings() {
        for (sampling_ms, publishing_ms, expected) in
            [(20.0, 20, 2), (0.0, 20, 10), (1.0, 20, 21), (250.0, 1000, 5), (1.0, 60_000, 100)]
        {
            assert_eq!(grant(publishing_ms, 3).queue_size(sampling_ms), expected);
        }
        assert!(grant(500, 3).overruns(100.0, 4) && !grant(500, 3).overruns(100.0, 5));
        assert!(!grant(500, 3).overruns(0.0, 1), "sampled on change: nobody knows how often");
    }
}
