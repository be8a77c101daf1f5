//! Dead letters: messages that were rejected or delivered too often.

use serde::{Deserialize, Serialize};
use time::OffsetDateTime;

use crate::address::QueueName;

/// Code of a message that was dead-lettered by the broker itself, without a receiver's rejection.
pub(crate) const TOO_MANY_DELIVERIES: &str = "verbund:too-many-deliveries";

/// A message in the queue `dead-letters`, without its body.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct BrokerDeadLetter {
    /// Number of the message; grows with the order of arrival at the broker.
    pub id: i64,
    /// Queue from which it was removed.
    pub queue: QueueName,
    /// `message-id` of its AMQP properties.
    pub message_id: Option<String>,
    /// `subject` of its AMQP properties.
    pub subject: Option<String>,
    /// User that sent it.
    pub principal: Option<String>,
    /// Stable code: the receiver's error condition, or `verbund:too-many-deliveries`.
    pub code: String,
    /// Reason in a sentence for people.
    pub reason: String,
    /// Time of the dead-lettering.
    #[serde(with = "time::serde::rfc3339")]
    pub at: OffsetDateTime,
    pub bytes: u64,
}
