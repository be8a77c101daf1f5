//! Operations: one step of making something together.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::DynamicDataRequest;
use crate::{
    ids::{AssetId, EquipmentRequirementId, FactoryId, OperationId},
    values::DateTime,
};

/// A production, inspection or transportation step.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "camelCase")]
pub struct Operation {
    /// Unique within the network.
    pub operation_id: OperationId,
    /// Type of the operation, with the members that only this type has.
    #[serde(flatten)]
    pub kind: OperationKind,
    /// Name for people, at most 256 characters.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// More about it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub description: Option<String>,
    /// A neighbour's operation that a relation names: only type, id, name and owner.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub stub: bool,
    /// The factory that carries it out; always present on stubs and in whole networks.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub owning_factory_id: Option<FactoryId>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub planned_start: Option<DateTime>,
    /// Planned end, not before the start.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub planned_end: Option<DateTime>,
    /// Planned quantity in [`Self::quantity_unit`], not negative.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub planned_quantity: Option<f64>,
    /// The unit of the planned quantity: a UNECE common code or one of its aliases (`PIECE`).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub quantity_unit: Option<String>,
    /// Equipment that the operation needs.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub equipment_requirement_list: Vec<EquipmentRequirement>,
    /// Data that partners request about the operation.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub dynamic_data_request_list: Vec<DynamicDataRequest>,
}

/// The three kinds of operation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(
    tag = "operationType",
    rename_all = "SCREAMING_SNAKE_CASE",
    rename_all_fields = "camelCase"
)]
pub enum OperationKind {
    /// A value-adding step.
    #[cfg_attr(feature = "openapi", schema(rename_all = "camelCase"))]
    Production {
        /// Product, by the partners' own id.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        product_id: Option<String>,
    },
    /// Any quality inspection or test.
    #[cfg_attr(feature = "openapi", schema(rename_all = "camelCase"))]
    Inspection {
        /// The operation whose result is inspected.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        inspected_operation_id: Option<OperationId>,
        /// Characteristic that is measured or judged.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        characteristic: Option<String>,
    },
    /// Moving material from one place to another.
    #[cfg_attr(feature = "openapi", schema(rename_all = "camelCase"))]
    Transportation {
        /// Place that the material leaves.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        origin: Option<String>,
        /// Place that the material is brought to.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        destination: Option<String>,
    },
}

impl OperationKind {
    /// The wire name: `PRODUCTION`, `INSPECTION` or `TRANSPORTATION`.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Production { .. } => "PRODUCTION",
            Self::Inspection { .. } => "INSPECTION",
            Self::Transportation { .. } => "TRANSPORTATION",
        }
    }
}

/// Equipment that an operation needs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "camelCase")]
pub struct EquipmentRequirement {
    /// Unique within the network.
    pub equipment_requirement_id: EquipmentRequirementId,
    /// The class of equipment, as `ROBOT`.
    pub equipment_type: String,
    /// IRI of a capability the equipment must have.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub capability: Option<String>,
    /// Number of pieces of equipment, not negative.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub quantity: Option<f64>,
    /// A concrete asset, as in its status data sets.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub asset_id: Option<AssetId>,
}

/// The state of an operation after the ISA-95 job states (OPC 10031-4).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub enum OperationState {
    NotAllowedToStart,
    AllowedToStart,
    Running,
    Interrupted,
    Ended,
    Aborted,
}

impl OperationState {
    /// All states, in the order of the standard; the index is the numeric form.
    pub const ALL: [Self; 6] = [
        Self::NotAllowedToStart,
        Self::AllowedToStart,
        Self::Running,
        Self::Interrupted,
        Self::Ended,
        Self::Aborted,
    ];

    /// The standard's name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::NotAllowedToStart => "NotAllowedToStart",
            Self::AllowedToStart => "AllowedToStart",
            Self::Running => "Running",
            Self::Interrupted => "Interrupted",
            Self::Ended => "Ended",
            Self::Aborted => "Aborted",
        }
    }

    /// The state with this name, ignoring case, blanks, `_` and `-`.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        let plain = |text: &str| -> String {
            text.chars()
                .filter(char::is_ascii_alphanumeric)
                .map(|c| c.to_ascii_lowercase())
                .collect()
        };
        let wanted = plain(name);
        Self::ALL.into_iter().find(|state| plain(state.name()) == wanted)
    }
}
