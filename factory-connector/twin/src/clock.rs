//! Wall clock of the crate: the one place that reads it.

use std::time::Duration;

use asi_model::DateTime;
use opcua_stack::opcua::types::DateTime as StackTime;

/// Returns the current time, as OPC UA counts it.
#[expect(clippy::disallowed_methods, reason = "the clock of the crate")]
pub(crate) fn now() -> DateTime {
    std::time::SystemTime::now().into()
}

/// Returns the time that lies so far back.
#[expect(clippy::disallowed_methods, reason = "the clock of the crate")]
pub(crate) fn ago(duration: Duration) -> DateTime {
    let now = std::time::SystemTime::now();
    now.checked_sub(duration).unwrap_or(now).into()
}

/// Returns the time since 1970, as file systems count it; zero before.
#[expect(clippy::disallowed_methods, reason = "the clock of the crate")]
pub(crate) fn unix_time() -> Duration {
    std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).unwrap_or_default()
}

/// Returns the current time in the type of the OPC UA stack, for timestamps of the server.
#[expect(clippy::disallowed_methods, reason = "the clock of the crate")]
pub(crate) fn stack_now() -> StackTime {
    StackTime::now()
}
