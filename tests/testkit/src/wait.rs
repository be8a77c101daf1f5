//! Polling with a deadline. No test sleeps for a fixed time and hopes.

use std::{
    future::Future,
    time::{Duration, Instant},
};

/// Pause between two looks at a condition.
const PAUSE: Duration = Duration::from_millis(5);

/// A condition that was not met in time.
#[derive(Debug, thiserror::Error)]
#[error("{what}: not within {limit:?}; last seen: {seen}")]
pub struct NotInTime {
    what: String,
    limit: Duration,
    seen: String,
}

/// Polls until the condition yields a value. Until then it yields what it saw instead.
///
/// # Errors
/// [`NotInTime`] with what was seen last.
pub async fn eventually<T, F>(
    what: &str,
    limit: Duration,
    mut condition: impl FnMut() -> F,
) -> Result<T, NotInTime>
where
    F: Future<Output = Result<T, String>>,
{
    let begun = Instant::now();
    loop {
        let seen = match condition().await {
            Ok(value) => return Ok(value),
            Err(seen) => seen,
        };
        if begun.elapsed() >= limit {
            return Err(NotInTime { what: what.to_owned(), limit, seen });
        }
        tokio::time::sleep(PAUSE).await;
    }
}

/// Polls until a condition holds; returns the time that it took.
///
/// # Panics
/// When the limit passes first.
pub async fn until(what: &str, limit: Duration, mut holds: impl FnMut() -> bool) -> Duration {
    let begun = Instant::now();
    while !holds() {
        assert!(begun.elapsed() < limit, "{what}: not within {limit:?}");
        tokio::time::sleep(PAUSE).await;
    }
    begun.elapsed()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn a_missed_deadline_names_what_was_seen_last() {
        let mut looks = 0;
        let condition = || {
            looks += 1;
            let seen: Result<(), String> = Err(format!("look {looks}"));
            async move { seen }
        };
        let error = eventually("a miracle", Duration::ZERO, condition).await.expect_err("none");
        assert_eq!(error.to_string(), "a miracle: not within 0ns; last seen: look 1");
    }
}
