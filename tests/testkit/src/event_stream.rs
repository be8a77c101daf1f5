//! Server-sent events of an open answer, one by one.

use reqwest::Response;
use serde_json::Value;

/// A named event with JSON as its data.
#[derive(Debug, Clone, PartialEq)]
pub struct Event {
    pub id: Option<String>,
    pub name: String,
    /// Null where the data is no JSON.
    pub data: Value,
}

impl Event {
    /// Reads the lines of one event; `None` for comments and events without name or data.
    fn read(text: &str) -> Option<Self> {
        let line = |key: &str| {
            text.lines().find_map(|line| line.strip_prefix(key)).map(|rest| rest.trim().to_owned())
        };
        let data = serde_json::from_str(&line("data:")?).unwrap_or_default();
        Some(Self { id: line("id:"), name: line("event:")?, data })
    }
}

/// Events as they come.
#[derive(Debug)]
pub struct EventStream {
    response: Response,
    received: Vec<u8>,
}

impl EventStream {
    pub(crate) fn new(response: Response) -> Self {
        Self { response, received: Vec::new() }
    }

    /// Waits for the next event; `None` at the end of the stream.
    ///
    /// # Errors
    /// When the connection breaks.
    pub async fn next(&mut self) -> reqwest::Result<Option<Event>> {
        loop {
            while let Some(text) = self.take_text() {
                if let Some(event) = Event::read(&text) {
                    return Ok(Some(event));
                }
            }
            match self.response.chunk().await? {
                Some(chunk) => self.received.extend_from_slice(&chunk),
                None => return Ok(None),
            }
        }
    }

    /// Takes the text up to the next empty line out of what was received.
    fn take_text(&mut self) -> Option<String> {
        let end = self.received.windows(2).position(|pair| pair == b"\n\n")?;
        let text: Vec<u8> = self.received.drain(..end + 2).collect();
        Some(String::from_utf8_lossy(&text).into_owned())
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn an_event_has_a_name_and_data() {
        let event = Event::read("id: 7\nevent: report\ndata: {\"value\": 1}\n\n");
        let data = json!({ "value": 1 });
        assert_eq!(event, Some(Event { id: Some("7".into()), name: "report".into(), data }));
        assert_eq!(Event::read(": keep-alive\n\n"), None);
        assert_eq!(Event::read("event: report\n\n"), None);
    }
}
