//! Live events, each of which the description of the API allows.

use std::time::Duration;

use testkit::Event;
use tokio::sync::mpsc::UnboundedReceiver;

use super::Answers;

/// Operation that answers with live events.
pub const STREAM: &str = "streamEvents";

/// Kinds of events that do not occur in the test. `inbox` is sent when the platform sends a
/// network, and the plant has no link: its network is stored before the connector starts.
const ABSENT: [&str; 1] = ["inbox"];

/// Longest wait for an event.
const PATIENCE: Duration = Duration::from_secs(60);

/// Opens the stream after an event that the connector does not know, so that it begins with
/// `reset`.
pub async fn open(answers: &Answers<'_>) -> UnboundedReceiver<Event> {
    answers.plant.events(Some("unknown")).await
}

/// Compares all events so far with the description, and those to come until each kind has come.
pub async fn check(answers: &mut Answers<'_>, mut events: UnboundedReceiver<Event>) {
    let mut missing = answers.contract.events(STREAM);
    for absent in ABSENT {
        assert!(missing.remove(absent), "{absent} is no event");
    }
    while !missing.is_empty() || !events.is_empty() {
        let event = tokio::time::timeout(PATIENCE, events.recv()).await;
        let event = event.unwrap_or_else(|_| panic!("events that did not come: {missing:?}"));
        let event = event.expect("the stream goes on");
        answers.faults.extend(answers.contract.event_faults(STREAM, &event));
        missing.remove(&event.name);
    }
}
