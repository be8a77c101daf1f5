//! Messages that a broker has accepted, until it has had the time to store them. MQTT has no word for that: a broker
//! acknowledges what it has in its memory, and a crash may lose it.

use std::{collections::VecDeque, sync::Arc, time::Duration};

use futures::future::BoxFuture;
use tokio::time::{Instant, sleep_until};

use crate::{spool::RowOutcome, transport::Connection};

/// Time after which a broker stores what it has accepted, at the latest. Mosquitto does so at once, and answers nothing
/// meanwhile.
const STORES_AFTER: Duration = Duration::from_secs(3);
/// Time for which further messages are awaited before the broker is asked about all of them.
const TOGETHER: Duration = Duration::from_millis(250);

/// Outcomes that are recorded once the broker has stored the messages. Without them the messages wait in the spool, and
/// are sent again on the next connection: their receiver knows them by their ids.
pub(super) struct Unsaved {
    connection: Arc<dyn Connection>,
    /// True where the broker may accept a message before it is stored.
    pub is_needed: bool,
    stores_after: Duration,
    /// Each with the time after which an answer proves that the message is stored; oldest first.
    outcomes: VecDeque<(Instant, RowOutcome)>,
    /// Number of the oldest ones that the broker has stored once it answers, and its answer.
    asked: Option<(usize, BoxFuture<'static, bool>)>,
}

impl Unsaved {
    /// Makes an empty list for a connection.
    pub(super) fn new(connection: Arc<dyn Connection>) -> Self {
        let is_needed = connection.answers().is_some();
        Self {
            connection,
            is_needed,
            stores_after: STORES_AFTER,
            outcomes: VecDeque::new(),
            asked: None,
        }
    }

    /// Adds the outcome of a message that the broker has just accepted.
    pub(super) fn put(&mut self, outcome: RowOutcome) {
        self.outcomes.push_back((Instant::now() + self.stores_after, outcome));
    }

    /// Number of the outcomes.
    pub(super) fn count(&self) -> usize {
        self.outcomes.len()
    }

    /// Waits until the broker has stored some messages, and returns their outcomes; for ever where there are none. May
    /// be cancelled.
    pub(super) async fn stored(&mut self) -> Vec<RowOutcome> {
        if self.asked.is_none() {
            self.ask().await;
        }
        let Some((count, answer)) = &mut self.asked else { return std::future::pending().await };
        let (count, has_answered) = (*count, answer.await);
        self.asked = None;
        if !has_answered {
            // The connection is lost, of which others take notice.
            return std::future::pending().await;
        }
        self.outcomes.drain(..count).map(|(_, outcome)| outcome).collect()
    }

    async fn ask(&mut self) {
        let Some((due, _)) = self.outcomes.front() else { return };
        sleep_until(*due + TOGETHER).await;
        let now = Instant::now();
        let count = self.outcomes.iter().take_while(|(due, _)| *due <= now).count();
        self.asked = self.connection.answers().map(|answer| (count, answer));
    }
}

#[cfg(test)]
mod tests {
    use async_trait::async_trait;
    use futures::FutureExt as _;
    use tokio::sync::watch;

    use super::*;
    use crate::{
        clock,
        profile::Terminus,
        spool::{RowId, SendOutcome},
        transport::{ConnectionFault, EndpointFault, MessageReceiver, MessageSender},
    };

    /// A connection whose broker answers from some time on.
    struct Answering(watch::Sender<bool>);

    #[async_trait]
    impl Connection for Answering {
        async fn sender(&self, _: &Terminus) -> Result<Box<dyn MessageSender>, EndpointFault> {
            Err(EndpointFault::Broken(String::new()))
        }

        async fn receiver(&self, _: &Terminus) -> Result<Box<dyn MessageReceiver>, EndpointFault> {
            Err(EndpointFault::Broken(String::new()))
        }

        async fn lost(&self) -> ConnectionFault {
            std::future::pending().await
        }

        async fn close(&self) {}

        fn answers(&self) -> Option<BoxFuture<'static, bool>> {
            let mut is_there = self.0.subscribe();
            Some(async move { is_there.wait_for(|is_there| *is_there).await.is_ok() }.boxed())
        }
    }

    fn accepted(id: i64) -> RowOutcome {
        RowOutcome { id: RowId(id), outcome: SendOutcome::Accepted, at: clock::now() }
    }

    const SOON: Duration = Duration::from_millis(400);

    fn unsaved(broker: &watch::Sender<bool>) -> Unsaved {
        let connection = Arc::new(Answering(broker.clone()));
        Unsaved { stores_after: SOON, ..Unsaved::new(connection) }
    }

    fn ids(outcomes: &[RowOutcome]) -> Vec<i64> {
        outcomes.iter().map(|outcome| outcome.id.0).collect()
    }

    #[tokio::test]
    async fn an_outcome_waits_until_its_broker_has_stored_the_message_and_answers() {
        let broker = watch::Sender::new(false);
        let mut unsaved = unsaved(&broker);
        assert!(unsaved.is_needed);
        let begin = Instant::now();
        unsaved.put(accepted(1));
        let waiting = tokio::time::timeout(SOON * 3, unsaved.stored()).await;
        assert!(waiting.is_err(), "the broker is silent");
        unsaved.put(accepted(2));
        broker.send_replace(true);
        assert_eq!(ids(&unsaved.stored().await), [1], "the other one came after the question");
        let asked = Instant::now();
        assert_eq!(ids(&unsaved.stored().await), [2]);
        assert!(asked.elapsed() >= SOON / 2 && begin.elapsed() >= SOON * 4);
        assert_eq!(unsaved.count(), 0);
    }

    #[tokio::test]
    async fn nothing_is_stored_on_a_connection_that_is_lost() {
        let broker = watch::Sender::new(false);
        let mut unsaved = unsaved(&broker);
        unsaved.put(accepted(1));
        assert!(tokio::time::timeout(SOON * 3, unsaved.stored()).await.is_err());
        assert_eq!(unsaved.count(), 1);
    }
}
