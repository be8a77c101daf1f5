//! Server-sent events for pages. Events have ids, so that a page that was away catches up.
//!
//! An [`EventLog`] keeps the newest events in a ring. Every reader has its own cursor into it, so a
//! slow page costs nothing but its own place: when the ring has moved on, the page is told `reset`
//! and loads afresh. Ids carry a mark of this start of the daemon, so that an id from before a
//! restart also leads to `reset`. The number behind the mark is sealed: events count over all that
//! happens, and a reader learns of its own only.

mod event_ids;
mod server_sent_event;

use std::{collections::VecDeque, convert::Infallible, sync::Arc, time::Duration};

use axum::{
    http::HeaderMap,
    response::{
        IntoResponse, Response,
        sse::{Event, KeepAlive, Sse},
    },
};
use futures::{StreamExt, stream::BoxStream};
use parking_lot::RwLock;
use tokio::sync::watch;
use tokio_util::sync::CancellationToken;

use self::event_ids::EventIds;
pub use self::server_sent_event::ServerSentEvent;

/// The newest events, shared by all readers. Clones share one log.
pub struct EventLog<T> {
    ring: Arc<RwLock<Ring<T>>>,
    newest: Arc<watch::Sender<u64>>,
    ids: Arc<EventIds>,
    capacity: usize,
}

struct Ring<T> {
    events: VecDeque<Arc<T>>,
    /// The number of the first event in the ring; events count from 1.
    first: u64,
}

impl<T> Clone for EventLog<T> {
    fn clone(&self) -> Self {
        Self {
            ring: Arc::clone(&self.ring),
            newest: Arc::clone(&self.newest),
            ids: Arc::clone(&self.ids),
            capacity: self.capacity,
        }
    }
}

impl<T> std::fmt::Debug for EventLog<T> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("EventLog").field("newest", &*self.newest.borrow()).finish_non_exhaustive()
    }
}

/// The stream behind an answer.
type EventStream = BoxStream<'static, Result<Event, Infallible>>;

/// End of a stream whose next event cannot be shown now. The page connects again, and asks for it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StreamEnd;

/// Result of a reader's look into the log.
enum Next<T> {
    Event(u64, Arc<T>),
    Reset(u64),
    Nothing,
}

impl<T: Send + Sync + 'static> EventLog<T> {
    /// A log of at most `capacity` events. `start_mark` differs from start to start.
    #[must_use]
    pub fn new(capacity: usize, start_mark: u64) -> Self {
        let ring = Ring { events: VecDeque::with_capacity(capacity.min(1024)), first: 1 };
        Self {
            ring: Arc::new(RwLock::new(ring)),
            newest: Arc::new(watch::Sender::new(0)),
            ids: Arc::new(EventIds::new(start_mark)),
            capacity,
        }
    }

    /// Tells all readers, in this order.
    pub fn publish(&self, events: impl IntoIterator<Item = T>) {
        let newest = {
            let mut ring = self.ring.write();
            for event in events {
                if ring.events.len() >= self.capacity && ring.events.pop_front().is_some() {
                    ring.first += 1;
                }
                ring.events.push_back(Arc::new(event));
            }
            ring.first + ring.events.len() as u64 - 1
        };
        self.newest.send_if_modified(|number| std::mem::replace(number, newest) != newest);
    }

    /// The id of the newest event: a page that has loaded its state after asking for this id misses
    /// nothing when it reads on from it. Each call returns another id of it.
    #[must_use]
    pub fn newest_id(&self) -> String {
        let newest = *self.newest.borrow();
        self.ids.seal(newest)
    }

    fn next(&self, after: u64) -> Next<T> {
        let ring = self.ring.read();
        let newest = ring.first + ring.events.len() as u64 - 1;
        if after >= newest {
            return Next::Nothing;
        }
        if after + 1 < ring.first {
            return Next::Reset(newest);
        }
        let position = usize::try_from(after + 1 - ring.first).unwrap_or(usize::MAX);
        match ring.events.get(position) {
            Some(event) => Next::Event(after + 1, Arc::clone(event)),
            None => Next::Nothing,
        }
    }

    /// A stream of server-sent events after `last_event_id`, or of what comes from now on. `show`
    /// yields an event, `None` where the viewer must not see it, or the end of the stream; `reset` is
    /// sent in the place of events that the log no longer has. The stream ends at shutdown, too.
    pub fn stream<Shown>(
        &self,
        last_event_id: Option<&str>,
        reset: ServerSentEvent,
        shutdown: CancellationToken,
        mut show: impl FnMut(Arc<T>) -> Shown + Send + 'static,
    ) -> Response
    where
        Shown: Future<Output = Result<Option<ServerSentEvent>, StreamEnd>> + Send + 'static,
    {
        let (start, must_reset) = match last_event_id {
            None => (*self.newest.borrow(), false),
            Some(id) => match self.ids.open(id) {
                Some(number) if number <= *self.newest.borrow() => (number, false),
                _ => (*self.newest.borrow(), true),
            },
        };
        let log = self.clone();
        let mut wake = self.newest.subscribe();
        let stream = async_stream(move |sink| async move {
            let mut after = start;
            if must_reset && sink.send(reset.with_id(log.ids.seal(after))).await.is_err() {
                return;
            }
            loop {
                wake.borrow_and_update();
                loop {
                    let event = match log.next(after) {
                        Next::Nothing => break,
                        Next::Reset(newest) => {
                            after = newest;
                            reset.with_id(log.ids.seal(newest))
                        }
                        Next::Event(number, event) => {
                            after = number;
                            match show(event).await {
                                Ok(Some(shown)) => shown.with_id(log.ids.seal(number)),
                                Ok(None) => continue,
                                Err(StreamEnd) => return,
                            }
                        }
                    };
                    if sink.send(event).await.is_err() {
                        return;
                    }
                }
                tokio::select! {
                    () = shutdown.cancelled() => return,
                    () = sink.closed() => return,
                    changed = wake.changed() => if changed.is_err() { return },
                }
            }
        });
        Sse::new(stream).keep_alive(KeepAlive::new().interval(KEEP_ALIVE_INTERVAL)).into_response()
    }
}

/// The standard's header for catching up (HTML living standard §9.2).
#[must_use]
pub fn last_event_id(headers: &HeaderMap) -> Option<&str> {
    headers.get("last-event-id").and_then(|id| id.to_str().ok())
}

/// Shorter than the idle timeout of common proxies, often 30 or 60 seconds.
const KEEP_ALIVE_INTERVAL: Duration = Duration::from_secs(15);
/// Events written ahead of the socket per page. A slow page waits in the ring, not in memory of its
/// own.
const AHEAD_MAX: usize = 64;

/// A stream fed by a task that ends with it.
fn async_stream<F, Fut>(feed: F) -> EventStream
where
    F: FnOnce(tokio::sync::mpsc::Sender<Event>) -> Fut,
    Fut: Future<Output = ()> + Send + 'static,
{
    let (sender, mut receiver) = tokio::sync::mpsc::channel(AHEAD_MAX);
    tokio::spawn(feed(sender));
    futures::stream::poll_fn(move |context| receiver.poll_recv(context).map(|event| event.map(Ok)))
        .boxed()
}

#[cfg(test)]
mod tests {
    use axum::body::HttpBody;
    use serde_json::{Value, json};

    use super::*;

    fn log() -> EventLog<u32> {
        let log = EventLog::new(3, 0xab);
        log.publish([1, 2]);
        log
    }

    fn sent(name: &str, data: &Value) -> ServerSentEvent {
        ServerSentEvent::of(&json!({ "event": name, "data": data }))
    }

    /// Reads until `count` events have come.
    async fn read(log: &EventLog<u32>, last: Option<&str>, count: usize) -> String {
        let reset = sent("reset", &json!({}));
        let response = log.stream(last, reset, CancellationToken::new(), |event| {
            let shown = (*event != 13).then(|| sent("value", &json!(*event)));
            std::future::ready(Ok(shown))
        });
        let mut body = response.into_body();
        let mut text = String::new();
        while text.matches("\n\n").count() < count {
            let frame =
                std::future::poll_fn(|context| std::pin::Pin::new(&mut body).poll_frame(context));
            let frame = tokio::time::timeout(Duration::from_secs(5), frame)
                .await
                .expect("an event in time");
            let bytes = frame.expect("not ended").expect("no error").into_data().expect("data");
            text.push_str(std::str::from_utf8(&bytes).expect("UTF-8"));
        }
        text
    }

    /// Returns the text with the number in place of each id.
    fn opened(log: &EventLog<u32>, text: &str) -> String {
        let lines = text.lines().map(|line| match line.strip_prefix("id: ") {
            Some(id) => format!("id: {}\n", log.ids.open(id).expect("an id of this log")),
            None => format!("{line}\n"),
        });
        lines.collect()
    }

    #[tokio::test]
    async fn a_page_catches_up_after_its_last_event() {
        let log = log();
        let (newest, again) = (log.newest_id(), log.newest_id());
        assert_ne!(newest, again);
        assert_eq!(log.ids.open(&newest), log.ids.open(&again));
        let text = read(&log, Some(&log.ids.seal(1)), 1).await;
        assert_eq!(opened(&log, &text), "id: 2\nevent: value\ndata: 2\n\n");
        log.publish([3]);
        for id in [newest, again] {
            let text = read(&log, Some(&id), 1).await;
            assert_eq!(opened(&log, &text), "id: 3\nevent: value\ndata: 3\n\n");
        }
    }

    #[tokio::test]
    async fn what_the_viewer_must_not_see_is_skipped() {
        let log = log();
        let last = log.newest_id();
        log.publish([13, 4]);
        let text = read(&log, Some(&last), 1).await;
        assert_eq!(opened(&log, &text), "id: 4\nevent: value\ndata: 4\n\n");
    }

    #[tokio::test]
    async fn two_readers_of_an_event_get_different_ids() {
        let log = log();
        let last = log.newest_id();
        log.publish([4]);
        let (one, other) = (read(&log, Some(&last), 1).await, read(&log, Some(&last), 1).await);
        assert_ne!(one, other);
        assert_eq!((one.len(), opened(&log, &one)), (other.len(), opened(&log, &other)));
    }

    #[tokio::test]
    async fn who_is_too_far_behind_or_from_another_start_is_reset() {
        let log = log();
        log.publish([3, 4, 5]);
        let other = EventLog::<u32>::new(3, 0xcd).newest_id();
        let ids = [log.ids.seal(1), other, log.ids.seal(99), "ab-4".into(), "nonsense".into()];
        for id in ids {
            let text = read(&log, Some(&id), 1).await;
            assert_eq!(opened(&log, &text), "id: 5\nevent: reset\ndata: {}\n\n", "{id}");
        }
    }

    #[tokio::test]
    async fn an_event_wakes_a_waiting_page() {
        let log = log();
        let (reader, last) = (log.clone(), log.newest_id());
        let waiting = tokio::spawn(async move { read(&reader, Some(&last), 1).await });
        tokio::task::yield_now().await;
        log.publish([7]);
        let text = waiting.await.expect("no panic");
        assert_eq!(opened(&log, &text), "id: 3\nevent: value\ndata: 7\n\n");
    }
}
