//! Polling of conditions until a deadline, in place of sleeps of a fixed time.

use std::{
    future::{Future, ready},
    time::{Duration, Instant},
};

/// Time by which a condition must hold.
#[derive(Debug, Clone, Copy)]
pub struct Deadline(Instant);

impl Deadline {
    /// Returns the deadline that passes this long from now.
    #[must_use]
    pub fn after(duration: Duration) -> Self {
        Self(Instant::now() + duration)
    }

    /// True once it has passed.
    #[must_use]
    pub fn has_passed(self) -> bool {
        Instant::now() >= self.0
    }
}

/// Polls `condition` every few milliseconds until it yields a value.
///
/// # Errors
/// When `limit` passes first; the message names what was waited for and the last thing seen.
pub async fn eventually<T, F, Fut>(what: &str, limit: Duration, condition: F) -> anyhow::Result<T>
where
    F: FnMut() -> Fut,
    Fut: Future<Output = Result<T, String>>,
{
    Ok(testkit::wait::eventually(what, limit, condition).await?)
}

/// Polls `holds` every few milliseconds until it is true.
///
/// # Errors
/// When `limit` passes first; the message names what was waited for.
pub async fn until(
    what: &str,
    limit: Duration,
    mut holds: impl FnMut() -> bool,
) -> anyhow::Result<()> {
    let look = || ready(holds().then_some(()).ok_or_else(|| "it does not hold".to_owned()));
    eventually(what, limit, look).await
}
