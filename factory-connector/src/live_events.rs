//! Events for open pages.

use connector_state::ConnectorEvent;
use daemon::web::events::EventLog;

/// Logs of events for open pages. Viewers read another one than operators and engineers, with
/// numbers of its own: a `reset` would come earlier by the events that it does not have. Clones share it.
#[derive(Clone, Debug)]
pub struct LiveEvents {
    all: EventLog<ConnectorEvent>,
    of_viewers: EventLog<ConnectorEvent>,
}

impl LiveEvents {
    /// Makes logs of at most `capacity` events. `start_mark` differs from start to start.
    #[must_use]
    pub fn new(capacity: usize, start_mark: u64) -> Self {
        Self {
            all: EventLog::new(capacity, start_mark),
            of_viewers: EventLog::new(capacity, start_mark),
        }
    }

    /// Tells all readers, in this order.
    pub fn publish(&self, events: Vec<ConnectorEvent>) {
        self.of_viewers.publish(events.iter().filter(|event| is_of_viewers(event)).cloned());
        self.all.publish(events);
    }

    /// Returns the log that operators and engineers read.
    #[must_use]
    pub const fn all(&self) -> &EventLog<ConnectorEvent> {
        &self.all
    }

    /// Returns the log that viewers read.
    #[must_use]
    pub const fn of_viewers(&self) -> &EventLog<ConnectorEvent> {
        &self.of_viewers
    }
}

/// Returns false for what happens before the gate: the time of an entry is that of a value, which a
/// policy may delay, coarsen or withhold.
const fn is_of_viewers(event: &ConnectorEvent) -> bool {
    match event {
        ConnectorEvent::Operator(_) => false,
        ConnectorEvent::Field(_)
        | ConnectorEvent::Inbox(_)
        | ConnectorEvent::Comment(_)
        | ConnectorEvent::Decisions(_)
        | ConnectorEvent::Ledger
        | ConnectorEvent::Policies
        | ConnectorEvent::Revocation(_)
        | ConnectorEvent::Status => true,
    }
}
