//! Errors of requests to the client.

use asi_model::values::StatusCode;

use crate::SourceId;

/// Failure of a request to the client.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ShopFloorError {
    /// No source has this id.
    #[error("there is no source {0}")]
    UnknownSource(SourceId),
    #[error("the source {0} is not connected")]
    NotConnected(SourceId),
    /// More sources or inputs than allowed.
    #[error("the limit of {limit} {what} is reached")]
    LimitReached { what: &'static str, limit: usize },
    /// A part of the request does not fit.
    #[error("{0}")]
    Invalid(String),
    /// The server did not answer in time.
    #[error("the source {0} did not answer in time")]
    Timeout(SourceId),
    #[error("the server refused: {status}")]
    Refused { status: StatusCode },
    /// Certificates or keys could not be read or written.
    #[error("certificates could not be read or written: {0}")]
    Certificates(String),
    /// The shop floor has stopped.
    #[error("the shop floor has stopped")]
    Stopped,
}
