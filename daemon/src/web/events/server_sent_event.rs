//! Form of an event on a stream.

use axum::response::sse::Event;
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;

/// Event as a stream carries it: a name in the line `event:`, JSON in the line `data:`.
#[derive(Debug, Clone, Deserialize)]
pub struct ServerSentEvent {
    event: String,
    data: Box<RawValue>,
}

impl ServerSentEvent {
    /// Takes name and data from the JSON of an event, `{"event": NAME, "data": ...}`. So one type
    /// is both what the stream sends and what the API's description says of it.
    ///
    /// # Panics
    /// When the event's JSON has another form.
    #[must_use]
    pub fn of(event: &impl Serialize) -> Self {
        let json = serde_json::to_string(event).expect("an event serialises");
        serde_json::from_str(&json).expect("an event has a name and data")
    }

    /// Returns the lines of the event with this id.
    pub(super) fn with_id(&self, id: String) -> Event {
        Event::default().id(id).event(&self.event).data(self.data.get())
    }
}
