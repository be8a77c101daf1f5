//! Size of a spool.

use serde::Serialize;
use time::OffsetDateTime;

/// Numbers of rows and bytes in a spool, for the link's state and metrics. Parked rows are not
/// counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "camelCase")]
pub struct Backlog {
    /// Rows that wait to be sent.
    pub waiting: u64,
    /// Rows that are sent and wait for the receipt.
    pub sent: u64,
    /// Bytes of waiting and sent rows.
    pub bytes: u64,
    /// Creation time of the oldest waiting or sent row.
    #[serde(with = "time::serde::rfc3339::option")]
    #[cfg_attr(feature = "openapi", schema(value_type = Option<String>, format = DateTime))]
    pub oldest_at: Option<OffsetDateTime>,
}
