//! Outcomes of attempts to send.

use time::OffsetDateTime;

use crate::{rejection::Rejection, row::RowId};

/// The outcome of an attempt to send a row, as the store records it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RowOutcome {
    pub id: RowId,
    pub outcome: SendOutcome,
    /// Time at which the outcome was known.
    pub at: OffsetDateTime,
}

/// Result of one attempt to send a row.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum SendOutcome {
    /// The broker has stored the message. The connector marks a report as sent and removes a
    /// control row; the platform removes the row.
    Accepted,
    /// The broker rejected the message; the row stays waiting with one attempt more.
    Rejected(Rejection),
    /// The row is never sent again automatically: the store parks it with the reason, visible to
    /// people.
    Parked(Rejection),
    /// The time to live had passed before the message could be sent. The store removes the row and
    /// announces the gap if there is one.
    Expired,
}
