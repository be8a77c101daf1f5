//! Does what the server has agree with what it told us?
//!
//! A subscription may be dead although keep-alives arrive: the connection looks green and no data
//! comes. So values that have not been notified for a while are read now and then. Where the read
//! value differs from the last notified one, and it still does after another while without a
//! notification, the subscription is taken for stalled.

use std::{
    collections::HashMap,
    time::{Duration, Instant},
};

use asi_model::values::{DataValue, NodeId};

use super::{Connection, feed::Feed, life::Memory, services, subscriptions::Subscriptions};
use crate::ShopFloorError;

/// Inputs looked at per round.
const INPUTS_PER_ROUND: usize = 100;
/// Longest pause between suspicions once they proved useless: a server may deliver differently what
/// it lets read.
const PAUSE_MAX: Duration = Duration::from_secs(3600);

/// Where the audit of a session stands.
pub(super) struct Audit {
    interval: Duration,
    next: Instant,
    position: usize,
    /// Handles whose read value differed, with the time of their last notification then.
    suspects: HashMap<u32, Instant>,
}

/// How often the audit of a source made a new session necessary; kept over sessions.
#[derive(Debug, Default)]
pub(super) struct Stalls {
    count: u32,
    last: Option<Instant>,
}

impl Stalls {
    fn pause(&self, interval: Duration) -> Duration {
        if self.count == 0 {
            interval
        } else {
            interval.saturating_mul(1 << self.count.min(16)).min(PAUSE_MAX)
        }
    }

    fn note(&mut self) {
        // After a quiet hour a stall is a new event, not proof that stalls cannot be cured.
        let is_recent = self.last.is_some_and(|last| last.elapsed() < PAUSE_MAX);
        self.count = if is_recent { self.count.saturating_add(1) } else { 1 };
        self.last = Some(Instant::now());
    }
}

impl Audit {
    pub(super) fn new(interval: Duration, stalls: &Stalls) -> Self {
        let next = Instant::now() + stalls.pause(interval);
        Self { interval, next, position: 0, suspects: HashMap::new() }
    }

    /// Looks at some inputs if it is time; true when the subscriptions are stalled.
    pub(super) async fn round(
        &mut self,
        connection: &Connection,
        feed: &Feed,
        subscriptions: &Subscriptions,
        memory: &mut Memory,
    ) -> Result<bool, ShopFloorError> {
        if Instant::now() < self.next {
            return Ok(false);
        }
        self.next = Instant::now() + self.interval;
        let Some(older_than) = Instant::now().checked_sub(self.interval) else { return Ok(false) };
        let start = if self.suspects.is_empty() { self.position } else { self.suspects_start() };
        let (seen, position) = feed.last_seen(start, INPUTS_PER_ROUND, older_than);
        self.position = position;
        let seen: Vec<_> = seen
            .into_iter()
            .filter(|seen| {
                seen.at.elapsed() > self.interval + 2 * subscriptions.sampling_of(seen.input)
            })
            .filter_map(|seen| Some((subscriptions.node_of(seen.input)?, seen)))
            .collect();
        let nodes: Vec<NodeId> = seen.iter().map(|(node, _)| node.clone()).collect();
        if nodes.is_empty() {
            self.suspects.clear();
            return Ok(false);
        }
        let values = services::read_monitored(connection, &nodes, memory).await?;
        let suspects = std::mem::take(&mut self.suspects);
        let mut is_stalled = false;
        for ((_, seen), value) in seen.iter().zip(&values) {
            // Notified meanwhile, or nothing new there.
            if feed.last_at(seen.handle) != Some(seen.at) || is_same(&seen.value, value) {
                continue;
            }
            is_stalled |= suspects.get(&seen.handle) == Some(&seen.at);
            self.suspects.insert(seen.handle, seen.at);
        }
        if is_stalled {
            memory.stalls.note();
        }
        Ok(is_stalled)
    }

    fn suspects_start(&self) -> usize {
        self.suspects.keys().min().map_or(0, |handle| *handle as usize)
    }
}

/// The same value and quality, times aside. NaN is the same as NaN.
fn is_same(notified: &DataValue, read: &DataValue) -> bool {
    notified.status.0 & 0xFFFF_0000 == read.status.0 & 0xFFFF_0000
        && (notified.value == read.value
            || format!("{:?}", notified.value) == format!("{:?}", read.value))
}

#[cfg(test)]
mod tests {
    use asi_model::values::{DateTime, StatusCode};

    use super::*;

    #[test]
    fn values_are_compared_without_their_times() {
        let good = |value: f64, at| DataValue::good(value, DateTime::from_ticks(at));
        let bad = DataValue::status_only(StatusCode::BAD_SENSOR_FAILURE, None);
        assert!(is_same(&good(1.0, 1), &good(1.0, 2)));
        assert!(is_same(&good(f64::NAN, 1), &good(f64::NAN, 2)));
        assert!(!is_same(&good(1.0, 1), &good(2.0, 1)));
        assert!(!is_same(&good(1.0, 1), &bad));
    }

    #[test]
    fn useless_suspicions_become_rare() {
        let mut stalls = Stalls::default();
        let interval = Duration::from_secs(5);
        assert_eq!(stalls.pause(interval), interval);
        stalls.note();
        stalls.note();
        assert_eq!(stalls.pause(interval), 4 * interval);
        stalls.count = 40;
        assert_eq!(stalls.pause(interval), PAUSE_MAX);
    }
}
