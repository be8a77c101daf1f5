//! What is on its way out: which reports travel in which message, and which of them must not leave
//! any more.

use std::{
    collections::{HashMap, HashSet, VecDeque},
    sync::Arc,
};

use asi_model::MessageId;
use parking_lot::Mutex;

/// Most messages whose reports are remembered; far more than the link keeps open.
const FETCHED_MAX: usize = 65_536;
/// Recalled reports beyond which those are forgotten that no fetched message holds.
const RECALLED_MAX: usize = 1_000_000;

/// A message that the broker accepted.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Departure {
    /// Its number in the spool.
    pub message: i64,
    /// Its id, as it left.
    pub message_id: MessageId,
    /// The reports in it.
    pub reports: Arc<[i64]>,
}

/// Shared by the link's end, which sends, and the desk, which takes back.
#[derive(Default)]
pub struct Departures(Mutex<Inner>);

#[derive(Default)]
struct Inner {
    fetched: HashMap<MessageId, Fetched>,
    order: VecDeque<MessageId>,
    /// The form in which a message was sent last; the link sends a message in one form at a time.
    sent: HashMap<i64, MessageId>,
    recalled: HashSet<i64>,
}

/// A message as it was composed.
struct Fetched {
    reports: Arc<[i64]>,
    /// Its number in the spool, once it is on the wire.
    message: Option<i64>,
}

impl Departures {
    /// A message was composed of these reports.
    pub(super) fn fetched(&self, message_id: MessageId, reports: impl Iterator<Item = i64>) {
        let mut inner = self.0.lock();
        let fetched = Fetched { reports: reports.collect(), message: None };
        if inner.fetched.insert(message_id.clone(), fetched).is_none() {
            inner.order.push_back(message_id);
        }
        while inner.order.len() > FETCHED_MAX {
            inner.forget_oldest();
        }
    }

    /// A message is about to be put on the wire. False where a report in it was taken back
    /// meanwhile.
    pub(super) fn may_leave(&self, message: i64, message_id: &MessageId) -> bool {
        let mut inner = self.0.lock();
        let Inner { fetched, recalled, .. } = &mut *inner;
        let Some(fetched) = fetched.get_mut(message_id) else { return true };
        if fetched.reports.iter().any(|report| recalled.contains(report)) {
            return false;
        }
        fetched.message = Some(message);
        inner.sent.insert(message, message_id.clone());
        true
    }

    /// The broker accepted a message: what was in it.
    pub(super) fn accepted(&self, message: i64) -> Option<Departure> {
        let mut inner = self.0.lock();
        let message_id = inner.sent.remove(&message)?;
        let reports = Arc::clone(&inner.fetched.get(&message_id)?.reports);
        Some(Departure { message, message_id, reports })
    }

    /// A message was not sent after all.
    pub(super) fn not_sent(&self, message: i64) {
        self.0.lock().sent.remove(&message);
    }

    /// These reports are taken back: what was fetched with them does not leave.
    pub fn recall(&self, reports: impl IntoIterator<Item = i64>) {
        let mut inner = self.0.lock();
        if inner.recalled.len() > RECALLED_MAX {
            inner.forget_recalls_of_others();
        }
        inner.recalled.extend(reports);
    }

    /// Taking back failed: everything may leave as before.
    pub fn forget_recalls(&self) {
        self.0.lock().recalled.clear();
    }
}

impl Inner {
    fn forget_oldest(&mut self) {
        let Some(oldest) = self.order.pop_front() else { return };
        let sent_as = self.fetched.remove(&oldest).and_then(|fetched| fetched.message);
        if let Some(message) = sent_as
            && self.sent.get(&message) == Some(&oldest)
        {
            self.sent.remove(&message);
        }
    }

    fn forget_recalls_of_others(&mut self) {
        let held: HashSet<i64> =
            self.fetched.values().flat_map(|fetched| fetched.reports.iter().copied()).collect();
        self.recalled.retain(|report| held.contains(report));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_taken_back_does_not_leave_in_any_message_fetched_before() {
        let departures = Departures::default();
        let id = |text: &str| MessageId::new(text).expect("an id");
        departures.fetched(id("both"), [1, 2].into_iter());
        departures.fetched(id("other"), [3].into_iter());
        assert!(departures.may_leave(3, &id("other")));
        departures.recall([1]);
        assert!(!departures.may_leave(2, &id("both")), "a report in it was taken back");
        departures.fetched(id("rest"), [2].into_iter());
        assert!(departures.may_leave(2, &id("rest")), "what remains leaves in another form");
        let left = departures.accepted(2).expect("it was sent");
        assert_eq!((left.message_id, &*left.reports), (id("rest"), &[2_i64][..]));
        assert_eq!(departures.accepted(2), None, "once");
        departures.forget_recalls();
        assert!(departures.may_leave(2, &id("both")), "taking back failed");
    }

    #[test]
    fn what_is_remembered_has_a_bound() {
        let departures = Departures::default();
        let id = |number: usize| MessageId::new(format!("message-{number}")).expect("an id");
        for (number, report) in (0..FETCHED_MAX + 10).zip(0_i64..) {
            departures.fetched(id(number), std::iter::once(report));
            assert!(departures.may_leave(report, &id(number)));
        }
        assert_eq!(departures.0.lock().sent.len(), FETCHED_MAX, "no outcome came for any of them");
        assert_eq!(departures.accepted(0), None, "the oldest are forgotten");
        assert!(departures.accepted(10).is_some());

        let (held, gone) = (FETCHED_MAX as i64, 10_000_000_i64);
        departures.recall((gone..).take(RECALLED_MAX).chain([held]));
        departures.recall([5]);
        assert!(
            !departures.may_leave(held, &id(FETCHED_MAX)),
            "a recall of what may still leave is kept"
        );
        assert_eq!(departures.0.lock().recalled.len(), 2, "others are forgotten");
    }
}
