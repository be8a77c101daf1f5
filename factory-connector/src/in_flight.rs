//! Messages of reports on their way out: which reports each carries, and which of them must not be
//! sent any more.

use std::{
    collections::{HashMap, HashSet, VecDeque},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::Duration,
};

use asi_model::MessageId;
use parking_lot::Mutex;
use tokio::time::Instant;

/// Most messages whose reports are remembered; far more than the link has under way.
const FETCHED_MAX: usize = 65_536;
/// Number of recalled reports above which those are forgotten that no fetched message carries. Only
/// messages that were fetched before the recall can still carry one.
const RECALLED_MAX: usize = 1_000_000;

/// A message that the broker accepted.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SentMessage {
    /// Number in the spool.
    pub row: i64,
    /// Id under which it was sent.
    pub message_id: MessageId,
    /// Numbers of the reports in it.
    pub reports: Arc<[i64]>,
}

/// Shared by the link, which composes and sends messages, and the coordinator, which recalls
/// reports.
#[derive(Default)]
pub struct InFlight {
    inner: Mutex<Inner>,
    /// No message of reports leaves, whatever is in it.
    is_held: AtomicBool,
    /// Time at which the link, on its present connection, was first turned away while they are held.
    turned_away_at: Mutex<Option<Instant>>,
}

#[derive(Default)]
struct Inner {
    fetched: HashMap<MessageId, Fetched>,
    order: VecDeque<MessageId>,
    /// Id under which a message was sent last; the link sends one form of a message at a time.
    sent: HashMap<i64, MessageId>,
    /// Reports that a committed transaction took back.
    recalled: HashSet<i64>,
    /// Reports that the transaction that is being written takes back.
    being_recalled: HashSet<i64>,
}

/// Reports of one message that was composed for the link.
struct Fetched {
    reports: Arc<[i64]>,
    /// Number in the spool, once it is on the wire.
    row: Option<i64>,
}

impl InFlight {
    /// Notes that a message was composed of these reports.
    pub fn fetched(&self, message_id: MessageId, reports: impl Iterator<Item = i64>) {
        let mut inner = self.inner.lock();
        let fetched = Fetched { reports: reports.collect(), row: None };
        if inner.fetched.insert(message_id.clone(), fetched).is_none() {
            inner.order.push_back(message_id);
        }
        while inner.order.len() > FETCHED_MAX {
            inner.forget_oldest();
        }
    }

    /// Notes that a message is about to be put on the wire. Returns false where a report in it was
    /// recalled meanwhile.
    pub fn may_leave(&self, row: i64, message_id: &MessageId) -> bool {
        let mut inner = self.inner.lock();
        let Inner { fetched, recalled, being_recalled, .. } = &mut *inner;
        // Control messages and keep-alives carry no reports, so nothing in them can be recalled.
        let Some(fetched) = fetched.get_mut(message_id) else { return true };
        if self.is_held() {
            return false;
        }
        let is_recalled =
            |report: &i64| recalled.contains(report) || being_recalled.contains(report);
        if fetched.reports.iter().any(is_recalled) {
            return false;
        }
        fetched.row = Some(row);
        inner.sent.insert(row, message_id.clone());
        true
    }

    /// Holds all reports back (true), or lets them leave. While held they wait in the spool.
    pub fn set_held(&self, is_held: bool) {
        self.is_held.store(is_held, Ordering::Release);
    }

    /// Returns whether all reports are held back.
    #[must_use]
    pub fn is_held(&self) -> bool {
        self.is_held.load(Ordering::Acquire)
    }

    /// Notes that the link was turned away: it could send reports, but they are held back.
    pub fn turn_away(&self) {
        self.turned_away_at.lock().get_or_insert_with(Instant::now);
    }

    /// Notes a new connection of the link, on which nothing was asked for.
    pub fn begin_connection(&self) {
        *self.turned_away_at.lock() = None;
    }

    /// Returns the time for which the link has waited on its present connection; none before it
    /// asked for reports.
    #[must_use]
    pub fn waited(&self) -> Option<Duration> {
        self.turned_away_at.lock().map(|at| at.elapsed())
    }

    /// Returns the contents of a message that the broker accepted, as often as it is asked until
    /// [`Self::recorded`]: where the outcome cannot be written, it is recorded again.
    #[must_use]
    pub fn accepted(&self, row: i64) -> Option<SentMessage> {
        let inner = self.inner.lock();
        let message_id = inner.sent.get(&row)?.clone();
        let reports = Arc::clone(&inner.fetched.get(&message_id)?.reports);
        Some(SentMessage { row, message_id, reports })
    }

    /// Notes that the outcomes of these messages are committed.
    pub fn recorded<'m>(&self, messages: impl IntoIterator<Item = &'m SentMessage>) {
        let mut inner = self.inner.lock();
        for SentMessage { row, message_id, .. } in messages {
            if inner.sent.get(row) == Some(message_id) {
                inner.sent.remove(row);
            }
        }
    }

    /// Notes that a message was not sent after all.
    pub fn not_sent(&self, row: i64) {
        self.inner.lock().sent.remove(&row);
    }

    /// Recalls reports: no message that was fetched with one of them is sent. The recall holds
    /// until [`Self::undo_recalls`], or for ever after [`Self::confirm_recalls`].
    pub fn recall(&self, reports: impl IntoIterator<Item = i64>) {
        let mut inner = self.inner.lock();
        if inner.recalled.len() > RECALLED_MAX {
            inner.forget_recalls_of_others();
        }
        inner.being_recalled.extend(reports);
    }

    /// Notes that the recalls of the transaction are committed.
    pub fn confirm_recalls(&self) {
        let mut inner = self.inner.lock();
        let confirmed = std::mem::take(&mut inner.being_recalled);
        inner.recalled.extend(confirmed);
    }

    /// Undoes the recalls of a failed transaction; those of former transactions hold.
    pub fn undo_recalls(&self) {
        self.inner.lock().being_recalled.clear();
    }
}

impl Inner {
    fn forget_oldest(&mut self) {
        let Some(oldest) = self.order.pop_front() else { return };
        let sent_as = self.fetched.remove(&oldest).and_then(|fetched| fetched.row);
        // The row may have been sent again in another form; that one stays known.
        if let Some(row) = sent_as
            && self.sent.get(&row) == Some(&oldest)
        {
            self.sent.remove(&row);
        }
    }

    fn forget_recalls_of_others(&mut self) {
        // The others are committed as taken back, so no later fetch reads them.
        let held: HashSet<i64> =
            self.fetched.values().flat_map(|fetched| fetched.reports.iter().copied()).collect();
        self.recalled.retain(|report| held.contains(report));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_recalled_report_is_sent_in_no_message_fetched_before() {
        let in_flight = InFlight::default();
        let id = |text: &str| MessageId::new(text).expect("an id");
        in_flight.fetched(id("both"), [1, 2].into_iter());
        in_flight.fetched(id("other"), [3].into_iter());
        assert!(in_flight.may_leave(3, &id("other")));
        in_flight.recall([1]);
        assert!(!in_flight.may_leave(2, &id("both")), "a report in it was taken back");
        in_flight.fetched(id("remaining"), [2].into_iter());
        assert!(in_flight.may_leave(2, &id("remaining")), "what remains leaves in another form");
        let left = in_flight.accepted(2).expect("it was sent");
        assert_eq!((&left.message_id, &*left.reports), (&id("remaining"), &[2_i64][..]));
        assert_eq!(in_flight.accepted(2).as_ref(), Some(&left), "it could not be written");
        in_flight.recorded([&left]);
        assert_eq!(in_flight.accepted(2), None, "it is recorded");
        in_flight.undo_recalls();
        assert!(in_flight.may_leave(2, &id("both")), "the transaction failed");
    }

    #[test]
    fn a_failed_transaction_undoes_its_own_recalls_only() {
        let in_flight = InFlight::default();
        let id = |text: &str| MessageId::new(text).expect("an id");
        in_flight.fetched(id("first"), [1].into_iter());
        in_flight.fetched(id("second"), [2].into_iter());
        in_flight.recall([1]);
        in_flight.confirm_recalls();
        in_flight.recall([2]);
        in_flight.undo_recalls();
        assert!(!in_flight.may_leave(1, &id("first")), "a revoked report stays revoked");
        assert!(in_flight.may_leave(2, &id("second")));
    }

    #[test]
    fn no_report_leaves_while_all_are_held() {
        let in_flight = InFlight::default();
        let id = |text: &str| MessageId::new(text).expect("an id");
        in_flight.fetched(id("report"), [1].into_iter());
        in_flight.set_held(true);
        assert!(!in_flight.may_leave(1, &id("report")));
        assert!(in_flight.may_leave(2, &id("control")), "it carries no report");
        in_flight.set_held(false);
        assert!(in_flight.may_leave(1, &id("report")));
    }

    #[test]
    fn remembered_messages_and_recalls_are_limited() {
        let in_flight = InFlight::default();
        let id = |number: usize| MessageId::new(format!("message-{number}")).expect("an id");
        for (number, report) in (0..FETCHED_MAX + 10).zip(0_i64..) {
            in_flight.fetched(id(number), std::iter::once(report));
            assert!(in_flight.may_leave(report, &id(number)));
        }
        assert_eq!(
            in_flight.inner.lock().sent.len(),
            FETCHED_MAX,
            "no outcome came for any of them"
        );
        assert_eq!(in_flight.accepted(0), None, "the oldest are forgotten");
        assert!(in_flight.accepted(10).is_some());

        let (held, gone) = (FETCHED_MAX as i64, 10_000_000_i64);
        in_flight.recall((gone..).take(RECALLED_MAX).chain([held]));
        in_flight.confirm_recalls();
        in_flight.recall([5]);
        in_flight.confirm_recalls();
        assert!(
            !in_flight.may_leave(held, &id(FETCHED_MAX)),
            "a recall of what may still leave is kept"
        );
        assert_eq!(in_flight.inner.lock().recalled.len(), 2, "others are forgotten");
    }
}
