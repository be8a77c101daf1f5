//! Audit of delivery: compares notified values with values on read.
//!
//! A subscription may deliver nothing although its keep-alives arrive. So values that have not been
//! notified for a while are read now and then. When a read value differs from the last notified
//! one, and still does at the next look without a notification between, the subscription is taken
//! for stalled.

use std::{
    collections::HashMap,
    time::{Duration, Instant},
};

use asi_model::values::{DataValue, NodeId};

use super::{
    memory::{SourceMemory, StallHistory},
    notification_sink::NotificationSink,
    subscriptions::Subscriptions,
};
use crate::ShopFloorError;

/// Most inputs compared per round.
const INPUTS_PER_ROUND: usize = 100;
/// Progress of the audit in one session.
pub(super) struct DeliveryAudit {
    interval: Duration,
    next: Instant,
    /// Client handle to continue with.
    position: usize,
    /// Handles whose read value differed, each with the time of its last notification.
    suspects: HashMap<u32, Instant>,
}

impl DeliveryAudit {
    pub(super) fn new(interval: Duration, stalls: &StallHistory) -> Self {
        let next = Instant::now() + stalls.pause(interval);
        Self { interval, next, position: 0, suspects: HashMap::new() }
    }

    /// Compares some inputs when a round is due. Returns true when the subscriptions are stalled.
    pub(super) async fn round(
        &mut self,
        sink: &NotificationSink,
        subscriptions: &Subscriptions,
        memory: &mut SourceMemory,
    ) -> Result<bool, ShopFloorError> {
        if Instant::now() < self.next {
            return Ok(false);
        }
        // A server that publishes rarely may not have sent what it shows on read.
        let interval = self.interval.max(sink.silence_limit_max());
        self.next = Instant::now() + interval;
        let Some(older_than) = Instant::now().checked_sub(interval) else { return Ok(false) };
        let start = if self.suspects.is_empty() { self.position } else { self.suspects_start() };
        let (notified, position) = sink.last_notified(start, INPUTS_PER_ROUND, older_than);
        self.position = position;
        let notified: Vec<_> = notified
            .into_iter()
            .filter(|last| last.at.elapsed() > interval + 2 * subscriptions.sampling_of(last.input))
            .filter_map(|last| Some((subscriptions.node_of(last.input)?, last)))
            .collect();
        let nodes: Vec<NodeId> = notified.iter().map(|(node, _)| node.clone()).collect();
        if nodes.is_empty() {
            self.suspects.clear();
            return Ok(false);
        }
        let values = subscriptions.read_monitored(&nodes, memory).await?;
        let suspects = std::mem::take(&mut self.suspects);
        let mut is_stalled = false;
        for ((_, last), value) in notified.iter().zip(&values) {
            // Notified since then, or unchanged on the server.
            if sink.last_notified_at(last.handle) != Some(last.at) || is_same(&last.value, value) {
                continue;
            }
            is_stalled |= suspects.get(&last.handle) == Some(&last.at);
            self.suspects.insert(last.handle, last.at);
        }
        if is_stalled {
            memory.stalls.record_stall();
        }
        Ok(is_stalled)
    }

    fn suspects_start(&self) -> usize {
        self.suspects.keys().min().map_or(0, |handle| *handle as usize)
    }
}

/// Compares value and quality without times. NaN equals NaN.
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
}
