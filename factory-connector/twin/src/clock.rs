//! Wall clock of the crate: the one place that reads it.

use asi_model::DateTime;

/// Returns the current time, as OPC UA counts it.
#[expect(clippy::disallowed_methods, reason = "the clock of the crate")]
pub(crate) fn now() -> DateTime {
    std::time::SystemTime::now().into()
}
