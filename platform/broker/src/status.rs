//! Status of queues and connections, as the broker's owner reads it.

use std::net::SocketAddr;

use serde::{Deserialize, Serialize};
use time::OffsetDateTime;

use crate::address::QueueName;

/// Counters of one queue at the moment of the call.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "camelCase")]
pub struct QueueStatus {
    #[cfg_attr(feature = "openapi", schema(value_type = String))]
    pub queue: QueueName,
    /// Messages that wait for a consumer.
    pub ready: u64,
    /// Messages delivered and not settled yet.
    pub unsettled: u64,
    /// Stored bytes of ready and unsettled messages.
    pub bytes: u64,
    pub consumers: u64,
}

/// A connected peer.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "camelCase")]
pub struct ConnectionStatus {
    /// Name of the signed-in user.
    pub user_name: String,
    /// Remote address of the TCP connection.
    #[cfg_attr(feature = "openapi", schema(value_type = String))]
    pub peer: SocketAddr,
    /// Time of the sign-in.
    #[serde(with = "time::serde::rfc3339")]
    #[cfg_attr(feature = "openapi", schema(value_type = String, format = DateTime))]
    pub since: OffsetDateTime,
}
