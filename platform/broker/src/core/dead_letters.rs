//! Dead letters: what becomes one, and which are given up.

use std::sync::{Arc, atomic::Ordering};

use tracing::warn;

use super::Core;
use crate::{
    address::QueueName,
    message::{AnyMessage, Features, cut},
    queue::{Queue, QueueEntry},
    shares::count_refusal,
    store::{self, DeadLettering, StoreCommand},
};

/// Characters of a dead letter's code and reason, which a consumer sends.
const CODE_CHARS_MAX: usize = 100;
const REASON_CHARS_MAX: usize = 1000;

/// Share of a queue in the dead letters.
const DEAD_LETTERS: &str = "dead-letters";
/// Name of all queues that are there no more.
const FORMER: &str = "former";

impl Core {
    /// Moves a leased message to the dead letters; removes one that is already there.
    pub(crate) async fn dead_letter(
        &self,
        queue: &Arc<Queue>,
        entry: QueueEntry,
        message: &AnyMessage,
        code: String,
        reason: String,
    ) {
        metrics::counter!("broker_messages_dead_lettered_total").increment(1);
        if queue.id == self.dead_letters.id {
            return self.remove(queue, &entry).await;
        }
        let (code, reason) = (cut(&code, CODE_CHARS_MAX), cut(&reason, REASON_CHARS_MAX));
        warn!(queue = %queue.name, message = entry.id, code, reason, "a message moves to the dead letters");
        self.cache.remove(entry.id);
        let features = Features::of(message);
        let (origin, is_new) = (Arc::clone(queue), Arc::clone(&self.has_new_dead_letters));
        let letter = DeadLettering { entry, origin, features, code, reason, is_new };
        self.write(StoreCommand::DeadLetter(Box::new(letter))).await;
    }

    /// Removes the oldest dead letters of each queue beyond its bound, and beyond the bound of all together those of
    /// the queues that have most.
    pub(super) async fn forget_dead_letters(&self) {
        let limits = &self.config.limits;
        let mut beyond = Vec::new();
        if self.has_new_dead_letters.swap(false, Ordering::Relaxed) {
            match store::dead_letters_beyond(&self.readers, limits).await {
                Ok(letters) => {
                    for (id, origin) in letters {
                        let Some(entry) = self.dead_letters.withdraw(id) else {
                            // A consumer has it: it is looked at again.
                            self.has_new_dead_letters.store(true, Ordering::Relaxed);
                            continue;
                        };
                        self.count_given_up(&origin);
                        beyond.push(entry);
                    }
                }
                Err(problem) => {
                    self.has_new_dead_letters.store(true, Ordering::Relaxed);
                    warn!(error = %problem, "old dead letters could not be listed");
                }
            }
        } else {
            // What was sent to their queue came from no other.
            let bytes_max = limits.dead_letter_bytes_max;
            beyond = self.dead_letters.withdraw_beyond(limits.dead_letters_max, bytes_max);
        }
        for entry in beyond {
            self.write(StoreCommand::Remove(entry.id)).await;
        }
    }

    /// Counts a dead letter that was given up, under the name of its queue.
    fn count_given_up(&self, origin: &str) {
        let name = origin.parse::<QueueName>().ok().filter(|name| self.queue(name).is_some());
        count_refusal(DEAD_LETTERS, name.as_ref().map_or(FORMER, QueueName::as_str));
    }
}
