//! Rows about messages: networks, comments, dead letters, and ids that were received.

use asi_model::{DateTime, MessageId, OperationNetworkId, messages::Comment};

/// Rows about messages beside the spool.
#[derive(Debug, Default, PartialEq)]
pub struct MessageWrites {
    /// Ids of received messages, so that a repeated one has no effect.
    pub seen: Vec<(MessageId, DateTime)>,
    pub comments: Vec<CommentRow>,
    pub dead_letters: Vec<DeadLetterRow>,
}

impl MessageWrites {
    pub(super) fn merge(&mut self, later: Self) {
        let Self { seen, comments, dead_letters } = later;
        self.seen.extend(seen);
        self.comments.extend(comments);
        self.dead_letters.extend(dead_letters);
    }
}

/// An operation network.
#[derive(Debug, Clone, PartialEq)]
pub struct NetworkRow {
    pub operation_network_id: OperationNetworkId,
    /// Revision of the network, or of its withdrawal.
    pub revision: u64,
    /// The message as JSON; `None` once withdrawn.
    pub message: Option<String>,
    pub received_at: DateTime,
}

/// A comment about a network or a part of it.
#[derive(Debug, Clone, PartialEq)]
pub struct CommentRow {
    pub comment: Comment,
    /// Written at this factory.
    pub is_own: bool,
    pub written_at: DateTime,
}

/// A message that was rejected.
#[derive(Debug, Clone, PartialEq)]
pub struct DeadLetterRow {
    /// Received here (true), or sent from here (false).
    pub is_received: bool,
    pub message_id: Option<MessageId>,
    /// Message type, as far as it is known.
    pub subject: String,
    /// Code of the reason.
    pub code: String,
    pub reason: String,
    pub body: Vec<u8>,
    pub occurred_at: DateTime,
}
