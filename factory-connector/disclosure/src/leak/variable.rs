//! Variables of local servers that fields rest on.

use asi_model::NodeId;
use serde::{Deserialize, Serialize};
use shop_floor_model::SourceId;

/// A variable of a local OPC UA server.
#[derive(
    Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, utoipa::ToSchema,
)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct VariableKey {
    /// The local server.
    pub source_id: SourceId,
    /// The variable, with its namespace's URI.
    pub node_id: NodeId,
}
