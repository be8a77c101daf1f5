//! Wall clock of the crate: the one place that reads it.

use time::OffsetDateTime;

/// Returns the current time in UTC.
#[expect(clippy::disallowed_methods, reason = "the clock of the crate")]
pub(crate) fn now() -> OffsetDateTime {
    OffsetDateTime::now_utc()
}
