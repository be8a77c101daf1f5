//! Limits on the number of released values per period.

use std::{collections::VecDeque, time::Duration};

use asi_model::DateTime;
use serde::{Deserialize, Serialize};

/// Most values per period that a limit can allow: so many times of releases are stored.
pub(super) const VALUES_MAX: u32 = 100;
/// Most limits of one policy.
pub(super) const LIMITS_MAX: usize = 4;

/// Most values that are released within any period of this length.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, utoipa::ToSchema,
)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct RateLimit {
    /// Number of values, 1 to 100.
    pub values: u32,
    /// The period in milliseconds.
    pub period_ms: u64,
}

impl RateLimit {
    /// Returns the time at which the next value may be released, given the times of releases, oldest
    /// first.
    pub(super) fn next_at(self, released: &VecDeque<DateTime>) -> Option<DateTime> {
        let index = released.len().checked_sub(usize::try_from(self.values.max(1)).ok()?)?;
        released.get(index).map(|at| at.after(Duration::from_millis(self.period_ms)))
    }
}

/// Records a release under limits: as many as any limit can ask for, whatever the present ones are. A
/// former policy with a limit of more values may apply again, and then all of them count. What was
/// released without a limit counts for none.
pub(super) fn remember(released: &mut VecDeque<DateTime>, limits: &[RateLimit], now: DateTime) {
    if limits.is_empty() {
        return;
    }
    released.push_back(now);
    while released.len() > VALUES_MAX as usize {
        released.pop_front();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_period_slides() {
        let at = |ms: i64| DateTime::from_unix_micros(ms * 1_000);
        let limit = RateLimit { values: 2, period_ms: 100 };
        let mut released = VecDeque::new();
        assert_eq!(limit.next_at(&released), None);
        for (now, next) in [(0, None), (10, Some(100)), (100, Some(110)), (150, Some(200))] {
            remember(&mut released, &[limit], at(now));
            assert_eq!(limit.next_at(&released), next.map(at), "after {now}");
        }
        for now in 0..200 {
            remember(&mut released, &[limit], at(200 + now));
        }
        assert_eq!(released.len(), 100, "as many as any limit can ask for");
    }
}
