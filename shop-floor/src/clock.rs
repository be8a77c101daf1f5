//! Wall clock of the crate: the one place that reads it.

use std::time::SystemTime;

use asi_model::values::DateTime;

/// Returns the current time, as OPC UA counts it.
pub(crate) fn now() -> DateTime {
    SystemTime::now().into()
}
