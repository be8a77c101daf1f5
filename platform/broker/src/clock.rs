//! Wall clock of the crate: the one place that reads it.

use time::OffsetDateTime;

/// Returns the current time in UTC.
#[expect(clippy::disallowed_methods, reason = "the clock of the crate")]
pub(crate) fn now() -> OffsetDateTime {
    OffsetDateTime::now_utc()
}

/// Returns the current time in Unix milliseconds.
pub(crate) fn now_ms() -> i64 {
    i64::try_from(now().unix_timestamp_nanos() / 1_000_000).unwrap_or(i64::MAX)
}
