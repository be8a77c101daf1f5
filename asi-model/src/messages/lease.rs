//! The lease on a factory's identity: of all running connectors with its credential, one speaks for
//! the factory.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{
    ids::{FactoryId, InstanceId, MessageId, PlaceId},
    values::DateTime,
};

/// A running connector asks for the lease on its factory's identity, or renews it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "camelCase")]
pub struct LeaseRequest {
    /// Unique per message.
    pub message_id: MessageId,
    /// The factory that the connector speaks for.
    pub factory_id: FactoryId,
    /// The connector that asks: another id at every start.
    pub instance_id: InstanceId,
    /// Id of the place where its store is in use.
    pub place: PlaceId,
    /// The machine and folder, for people.
    pub host: String,
    /// Time of its start, by its own clock.
    pub started_at: DateTime,
}

/// The holder of the lease, in answer to a request for it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "camelCase")]
pub struct Lease {
    /// Unique per message.
    pub message_id: MessageId,
    /// The factory it is for.
    pub factory_id: FactoryId,
    /// The request answered.
    pub correlation_id: MessageId,
    /// The connector that asked. Another one that reads this knows that there are two.
    pub instance_id: InstanceId,
    /// Place of the connector that asked.
    pub place: PlaceId,
    /// The machine and folder of the connector that asked.
    pub host: String,
    /// The answer to the connector that asked.
    pub result: LeaseResult,
    /// Counts up whenever the lease passes to another place. What the holder sends carries it.
    pub lease_number: u64,
    /// Time until the next request is due, in milliseconds.
    pub ask_again_ms: u64,
    /// The holder of the lease, where it was refused.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub holder: Option<LeaseParty>,
    /// The other connector that asked and was refused, where the lease was granted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub contender: Option<LeaseParty>,
}

/// The answer to a request for the lease.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum LeaseResult {
    /// The factory's connector holds it.
    Granted,
    /// Another one is.
    Refused,
}

/// A connector that holds the lease or asked for it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "camelCase")]
pub struct LeaseParty {
    pub instance_id: InstanceId,
    /// Its machine and folder.
    pub host: String,
    /// Time at which it got the lease, or first asked for it.
    pub since: DateTime,
    /// Time of its last request, by the platform's clock.
    pub last_heard_at: DateTime,
}
