//! Pace of senders: who sends faster than its share waits, and the one writer of the database is there for others.

use std::{
    collections::HashMap,
    time::{Duration, Instant},
};

use asi_model::messages::FactoryMessage;
use messaging::LogicalAddress;
use parking_lot::Mutex;

use super::{
    decode::{Content, Incoming},
    used_up::count_used_up,
};
use crate::{sequences::RANGES_MAX, store::Holder};

/// Share of a factory or tool in messages for each time.
const MESSAGES: &str = "messages";

/// Unpacked bytes that count as a message.
const BYTES_PER_MESSAGE: usize = 4 * 1024;
/// Reports, keep-alives, numbers of a gap, writers and ranges that count as a message.
const ITEMS_PER_MESSAGE: usize = 16;

/// Messages of one sender for each time.
#[derive(Debug, Clone, Copy)]
struct Rate {
    per_second: u32,
    /// Messages at once, after a pause.
    at_once: u32,
}

/// A factory's: a message carries up to 64 KiB of reports.
const OF_FACTORY: Rate = Rate { per_second: 2_000, at_once: 20_000 };
/// A factory's that cannot wait: what came while the platform or its line was down arrives at once, and is not to be
/// set aside for that.
const OF_FACTORY_OVER_MQTT: Rate = Rate { at_once: 100_000, ..OF_FACTORY };
/// A tool's: each of its messages may change a network.
const OF_TOOL: Rate = Rate { per_second: 20, at_once: 200 };

/// Pace of all senders, by address.
#[derive(Debug)]
pub(super) struct Pace {
    /// True where the broker refuses what is beyond a sender's bound, so that it can wait there. An MQTT broker drops that
    /// without a word: what is beyond a share is set aside there, with its body, so that it can be seen and replayed.
    may_wait: bool,
    /// Times at which the share of an address is whole again.
    whole_at: Mutex<HashMap<LogicalAddress, Instant>>,
}

/// Excess of a sender over its share.
#[derive(Debug, Default)]
pub(super) struct Excess {
    /// Time until it is within its share; zero where it is, and where it cannot wait.
    pub(super) wait: Duration,
    /// Reason for which its messages are set aside, where it cannot wait.
    pub(super) reason: Option<String>,
}

impl Pace {
    /// Shares of which nothing is used yet.
    pub(super) fn new(may_wait: bool) -> Self {
        Self { may_wait, whole_at: Mutex::default() }
    }

    /// Waits until so many messages of an address are within its share. The broker keeps the others meanwhile.
    /// Returns why they are beyond it, where it cannot wait.
    pub(super) async fn keep(&self, address: &LogicalAddress, messages: usize) -> Option<String> {
        let Excess { wait, reason } = self.charge(address, messages);
        tokio::time::sleep(wait).await;
        reason
    }

    /// Takes so many messages off the share of an address at once; those that are set aside are not taken off.
    pub(super) fn charge(&self, address: &LogicalAddress, messages: usize) -> Excess {
        let wait = self.take(address, messages, Instant::now());
        if wait.is_zero() {
            return Excess::default();
        }
        if let Some(sender) = Holder::of(address) {
            count_used_up(MESSAGES, &sender);
        }
        if self.may_wait {
            return Excess { wait, reason: None };
        }
        let Rate { per_second, at_once } = self.rate(address);
        let sender = if address.tool_id().is_some() { "tool" } else { "factory" };
        let reason = format!(
            "The {sender} sends more than {per_second} messages a second, after {at_once} at once."
        );
        Excess { wait: Duration::ZERO, reason: Some(reason) }
    }

    /// Takes messages off the share of an address, and returns the time until they are within it.
    pub(super) fn take(&self, address: &LogicalAddress, messages: usize, now: Instant) -> Duration {
        let rate = self.rate(address);
        let second = Duration::from_secs(1);
        let messages = u32::try_from(messages).unwrap_or(u32::MAX);
        let mut all = self.whole_at.lock();
        let whole_at = all.get(address).copied().unwrap_or(now).max(now);
        let whole_at = whole_at + second * messages / rate.per_second;
        let wait = (whole_at - now).saturating_sub(second * rate.at_once / rate.per_second);
        if self.may_wait || wait.is_zero() {
            all.insert(address.clone(), whole_at);
        }
        wait
    }

    fn rate(&self, address: &LogicalAddress) -> Rate {
        match (address.tool_id(), self.may_wait) {
            (Some(_), _) => OF_TOOL,
            (None, true) => OF_FACTORY,
            (None, false) => OF_FACTORY_OVER_MQTT,
        }
    }
}

/// Returns how many messages a message counts as: a large one, or one with much in it, keeps the writer of
/// the database busy as many small ones do.
pub(super) fn cost(message: &Incoming) -> usize {
    let items = match &message.content {
        Content::Reports { reports, keep_alives, .. } => reports.len() + keep_alives.len(),
        Content::Factory(message) => match &**message {
            FactoryMessage::Gap(gap) => {
                // As many holes as there can be in it.
                let numbers = gap.last_sequence.saturating_sub(gap.first_sequence);
                usize::try_from(numbers).unwrap_or(usize::MAX).min(RANGES_MAX)
            }
            FactoryMessage::ReceiptRequest(request) => request.writer_list.len(),
            FactoryMessage::PastRelease(release) => release.range_list.len(),
            _ => 0,
        },
        _ => 0,
    };
    (message.body.len() / BYTES_PER_MESSAGE).max(items / ITEMS_PER_MESSAGE).max(1)
}

#[cfg(test)]
mod tests {
    use messaging::{Delivery, Envelope};
    use serde_json::json;

    use super::*;
    use crate::{ingest::decode::decode, signing::SigningState};

    /// Returns what a factory's message with this body counts as.
    fn cost_of(body: &serde_json::Value) -> usize {
        let address: LogicalAddress = "factory.F.ingress".parse().expect("an address");
        let delivery = Delivery {
            envelope: Envelope::new("m".parse().expect("an id"), "any", body.to_string()),
            is_redelivered: false,
            delivery_count: 0,
            received_at: time::OffsetDateTime::UNIX_EPOCH,
        };
        cost(&decode(&address, &delivery.into(), &(), &SigningState::default()))
    }

    #[test]
    fn a_message_with_much_in_it_counts_as_many() {
        let gap = |last: u32| {
            json!({ "messageType": "gap", "messageId": "g", "factoryId": "F", "dataSetWriterId": 1,
                "epoch": 1, "firstSequence": 0, "lastSequence": last, "cause": "COALESCED" })
        };
        assert_eq!(cost_of(&gap(3)), 1);
        assert_eq!(cost_of(&gap(1_000_000)), RANGES_MAX / ITEMS_PER_MESSAGE);
        let alive = |writer: u16| {
            json!({ "DataSetWriterId": writer, "MessageType": "ua-keepalive", "SequenceNumber": 1,
                "MetaDataVersion": { "MajorVersion": 1, "MinorVersion": 1 } })
        };
        let many: Vec<_> = (0..1600).map(alive).collect();
        let keep_alives = json!({ "MessageId": "k", "MessageType": "ua-data", "PublisherId": "F",
            "Messages": many });
        assert_eq!(cost_of(&keep_alives), 100);
        let long = json!({ "MessageId": "l", "MessageType": "ua-data", "PublisherId": "F",
            "WriterGroupName": "x".repeat(40 * 1024), "Messages": [alive(1)] });
        assert_eq!(cost_of(&long), 10);
    }

    #[test]
    fn who_sends_faster_than_its_share_waits_and_nobody_else() {
        let pace = Pace::new(true);
        let [tool, other, factory] = ["tool.T.requests", "tool.U.requests", "factory.F.ingress"]
            .map(|text| text.parse::<LogicalAddress>().expect("an address"));
        let now = Instant::now();
        let mut waited = Duration::ZERO;
        for _ in 0..30 {
            waited = pace.take(&tool, 10, now);
        }
        assert_eq!(waited, Duration::from_secs(5), "100 of 300 are beyond what may come at once");
        assert_eq!(pace.take(&other, 10, now), Duration::ZERO);
        assert_eq!(pace.take(&factory, 10_000, now), Duration::ZERO);
        // A bucket that is full again after a pause.
        let later = now + Duration::from_secs(60);
        assert_eq!(pace.take(&tool, 200, later), Duration::ZERO);
        assert_eq!(pace.take(&tool, 20, later), Duration::from_secs(1));
    }

    #[tokio::test]
    async fn nobody_waits_where_all_come_over_one_line_and_each_has_its_share() {
        let pace = Pace::new(false);
        let [tool, factory, other] = ["tool.T.requests", "factory.F.ingress", "factory.G.ingress"]
            .map(|text| text.parse::<LogicalAddress>().expect("an address"));
        let begun = Instant::now();
        for _ in 0..20 {
            assert_eq!(pace.keep(&tool, 10).await, None);
        }
        let reason = pace.keep(&tool, 10_000).await.expect("beyond its share");
        assert!(reason.contains("20 messages a second"), "{reason}");
        assert_eq!(pace.keep(&factory, 100_000).await, None);
        let reason = pace.keep(&factory, 100_000).await.expect("beyond its share");
        assert!(reason.starts_with("The factory sends more than 2000 messages"), "{reason}");
        assert_eq!(pace.keep(&other, 100_000).await, None, "another factory has its own");
        assert!(begun.elapsed() < Duration::from_secs(5), "nobody waited");
    }

    #[test]
    fn what_is_set_aside_is_not_taken_off_so_that_a_factory_comes_back_to_its_share() {
        let pace = Pace::new(false);
        let factory: LogicalAddress = "factory.F.ingress".parse().expect("an address");
        let now = Instant::now();
        assert_eq!(pace.take(&factory, 100_000, now), Duration::ZERO);
        for _ in 0..1_000 {
            assert!(pace.take(&factory, 100, now) > Duration::ZERO);
        }
        let later = now + Duration::from_secs(1);
        assert_eq!(pace.take(&factory, 2_000, later), Duration::ZERO);
        assert!(pace.take(&factory, 1, later) > Duration::ZERO);
    }
}
