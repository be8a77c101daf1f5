//! Items of a session by input: monitored ones, and those that the server refused.

use std::{
    collections::HashMap,
    sync::Arc,
    time::{Duration, Instant},
};

use asi_model::values::DataValue;
use opcua_stack::{opcua::types::StatusCode, values::status_from_stack};

use crate::{
    InputChange, InputKey, MonitorRequest, change_queue::ChangeQueue, clock,
    source::record::SourceRecord,
};

/// First and longest backoff before an input that the server refused is tried again. It is tried
/// for ever, since nodes appear when a machine loads another program.
const RETRY_MIN: Duration = Duration::from_secs(2);
const RETRY_MAX: Duration = Duration::from_secs(60);

pub(super) enum Item {
    Monitored { request: Arc<MonitorRequest>, subscription: usize, item_id: u32, handle: u32 },
    Refused { request: Arc<MonitorRequest>, retry_at: Instant, attempts: u32 },
}

/// Request for an item, with the number of attempts that the server refused before.
pub(super) struct Attempt {
    pub(super) request: Arc<MonitorRequest>,
    pub(super) attempts: u32,
}

pub(super) struct Items {
    record: Arc<SourceRecord>,
    changes: ChangeQueue,
    by_input: HashMap<InputKey, Item>,
    /// Earliest retry of a refused item.
    next_retry: Option<Instant>,
}

impl Items {
    pub(super) fn new(record: Arc<SourceRecord>, changes: ChangeQueue) -> Self {
        Self { record, changes, by_input: HashMap::new(), next_retry: None }
    }

    pub(super) fn get(&self, input: InputKey) -> Option<&Item> {
        self.by_input.get(&input)
    }

    pub(super) fn remove(&mut self, input: InputKey) -> Option<Item> {
        self.by_input.remove(&input)
    }

    pub(super) fn remove_all(&mut self) -> Vec<Item> {
        self.by_input.drain().map(|(_, item)| item).collect()
    }

    /// Returns the request of an item that is monitored.
    pub(super) fn monitored(&self, input: InputKey) -> Option<&Arc<MonitorRequest>> {
        self.get(input).and_then(Item::monitored)
    }

    pub(super) fn all_monitored(&self) -> impl Iterator<Item = &Arc<MonitorRequest>> {
        self.by_input.values().filter_map(Item::monitored)
    }

    /// Returns the requests of all monitored items with their client handles.
    pub(super) fn all_with_handles(&self) -> impl Iterator<Item = (&Arc<MonitorRequest>, u32)> {
        self.by_input.values().filter_map(|item| match item {
            Item::Monitored { request, handle, .. } => Some((request, *handle)),
            Item::Refused { .. } => None,
        })
    }

    /// Returns subscription and id of each item whose value follows from conditions.
    pub(super) fn with_conditions(&self) -> impl Iterator<Item = (usize, u32)> {
        self.by_input.values().filter_map(|item| match item {
            Item::Monitored { request, subscription, item_id, .. } => {
                let events = request.options.events.as_ref();
                events
                    .is_some_and(|events| events.value.is_of_conditions())
                    .then_some((*subscription, *item_id))
            }
            Item::Refused { .. } => None,
        })
    }

    pub(super) fn add_monitored(
        &mut self,
        request: Arc<MonitorRequest>,
        subscription: usize,
        item_id: u32,
        handle: u32,
    ) {
        let input = request.input;
        self.record.clear_input_problem(input);
        self.by_input.insert(input, Item::Monitored { request, subscription, item_id, handle });
    }

    /// Adds an item that the server refused. The input gets the status instead of a value, and is
    /// tried again later.
    pub(super) fn add_refused(&mut self, attempt: Attempt, status: StatusCode, reason: String) {
        let Attempt { request, attempts } = attempt;
        let status = status_from_stack(status);
        let input = request.input;
        self.record.set_input_problem(input, status, reason);
        if attempts == 0 {
            let value = DataValue::status_only(status, Some(clock::now()));
            self.changes.push(vec![InputChange { input, value }]);
        }
        let backoff = RETRY_MIN.saturating_mul(1 << attempts.min(10)).min(RETRY_MAX);
        let retry_at = Instant::now() + backoff;
        self.schedule_retry(retry_at);
        let item = Item::Refused { request, retry_at, attempts: attempts.saturating_add(1) };
        self.by_input.insert(input, item);
    }

    pub(super) fn is_retry_due(&self) -> bool {
        self.next_retry.is_some_and(|at| at <= Instant::now())
    }

    /// Returns the refused items whose retry is due.
    pub(super) fn take_due(&mut self) -> Vec<Attempt> {
        let now = Instant::now();
        let mut due = Vec::new();
        let mut later = Vec::new();
        for item in self.by_input.values() {
            let Item::Refused { request, retry_at, attempts } = item else { continue };
            if *retry_at <= now {
                due.push(Attempt { request: Arc::clone(request), attempts: *attempts });
            } else {
                later.push(*retry_at);
            }
        }
        self.next_retry = later.into_iter().min();
        due
    }

    fn schedule_retry(&mut self, at: Instant) {
        self.next_retry = Some(self.next_retry.map_or(at, |next| next.min(at)));
    }
}

impl Item {
    fn monitored(&self) -> Option<&Arc<MonitorRequest>> {
        match self {
            Self::Monitored { request, .. } => Some(request),
            Self::Refused { .. } => None,
        }
    }
}
