//! Candidates and released values per hour, for the leak budget. Counted in memory only.

use asi_model::DateTime;
use disclosure::Measured;
/// Hours that are counted.
const HOURS: usize = 24;
const HOUR_MS: i64 = 3_600_000;

/// Counts per hour over the last day.
#[derive(Debug, Clone)]
pub struct DisclosureRate {
    since: DateTime,
    /// The current hour since 1970, with its candidates and released values.
    hour: i64,
    present: (u32, u32),
    /// The counts of the hours before it, indexed by hour modulo 24; allocated on first use.
    earlier: Option<Box<[(u32, u32); HOURS]>>,
}

impl DisclosureRate {
    /// Starts to count.
    #[must_use]
    pub(crate) fn new(since: DateTime) -> Self {
        Self {
            since,
            hour: since.unix_millis().div_euclid(HOUR_MS),
            present: (0, 0),
            earlier: None,
        }
    }

    pub(crate) fn count_candidate(&mut self, now: DateTime) {
        self.turn_to(now);
        self.present.0 = self.present.0.saturating_add(1);
    }

    /// Counts a released value.
    pub(crate) fn count_released(&mut self, now: DateTime) {
        self.turn_to(now);
        self.present.1 = self.present.1.saturating_add(1);
    }

    /// Sums up the last day, or the time since counting started.
    #[must_use]
    #[allow(clippy::cast_precision_loss)]
    pub fn measured(&self, now: DateTime) -> Measured {
        let mut counted = self.clone();
        counted.turn_to(now);
        let counts =
            || counted.earlier.iter().flat_map(|hours| hours.iter()).chain([&counted.present]);
        let hours = (now.since(self.since).as_secs_f64() / 3600.0).min(HOURS as f64);
        Measured {
            candidates: counts().map(|(came, _)| u64::from(*came)).sum(),
            released: counts().map(|(_, left)| u64::from(*left)).sum(),
            hours,
        }
    }

    /// Moves on to the hour of `now` and forgets hours more than a day ago.
    fn turn_to(&mut self, now: DateTime) {
        let hour = now.unix_millis().div_euclid(HOUR_MS);
        if hour <= self.hour {
            return;
        }
        let index = |hour: i64| usize::try_from(hour.rem_euclid(HOURS as i64)).unwrap_or(0);
        if self.present != (0, 0) || self.earlier.is_some() {
            let earlier = self.earlier.get_or_insert_with(|| Box::new([(0, 0); HOURS]));
            earlier[index(self.hour)] = std::mem::take(&mut self.present);
            for passed in (self.hour + 1..=hour).rev().take(HOURS) {
                earlier[index(passed)] = (0, 0);
            }
        }
        self.hour = hour;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_day_is_counted() {
        let at = |minutes: i64| DateTime::from_unix_micros((480_000 * 60 + minutes) * 60_000_000);
        let mut rate = DisclosureRate::new(at(0));
        for minute in 0..120 {
            rate.count_candidate(at(minute));
            if minute % 10 == 0 {
                rate.count_released(at(minute));
            }
        }
        let measured = rate.measured(at(120));
        assert_eq!(measured.candidates, 120);
        assert_eq!(measured.released, 12);
        assert_eq!(measured.hours, 2.0);
        assert_eq!(measured.candidates_per_hour(), Some(60.0));
        let later = rate.measured(at(25 * 60 - 1));
        assert_eq!((later.candidates, later.hours), (60, 24.0), "the first hour is over a day ago");
        assert_eq!(rate.measured(at(60 * 60)).candidates, 0);
    }
}
