//! Status data sets of assets: which there are, and requests for them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{
    ids::{AssetId, FactoryId, MessageId, OrganisationId},
    values::DateTime,
};

/// A kind of status data set of an asset.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum AssetKind {
    /// Axis positions with their ranges.
    Pose,
    /// Power and energy.
    Power,
    /// Health and overall condition.
    Condition,
    /// States of safety functions, as emergency stops.
    Safety,
}

/// Status data sets that could be asked for.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "camelCase")]
pub struct AssetOffer {
    /// Unique per message.
    pub message_id: MessageId,
    /// The factory that owns the asset.
    pub factory_id: FactoryId,
    pub asset_id: AssetId,
    /// The data sets that can be asked for; never empty.
    pub kind_list: Vec<AssetKind>,
    /// The asset in words, at most 8192 characters.
    pub description: String,
}

/// A request for an asset's status data sets.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "camelCase")]
pub struct AssetRequest {
    /// Unique per message.
    pub message_id: MessageId,
    /// The factory that owns the asset.
    pub factory_id: FactoryId,
    pub asset_id: AssetId,
    /// The data sets asked for; never empty.
    pub kind_list: Vec<AssetKind>,
    /// The organisation that asks.
    pub requester_id: OrganisationId,
    /// The organisations that may see the answers.
    pub recipient_list: Vec<OrganisationId>,
    /// Purpose in words, for the factory's engineer; never empty.
    pub purpose: String,
    /// End of the request; absent where it has none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub valid_until: Option<DateTime>,
}
