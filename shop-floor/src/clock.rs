//! Wall clock of the crate: the one place that reads it.

use std::time::SystemTime;

use asi_model::values::DateTime;

/// Returns the current time, as OPC UA counts it.
#[expect(clippy::disallowed_methods, reason = "the clock of the crate")]
pub(crate) fn now() -> DateTime {
    SystemTime::now().into()
}
