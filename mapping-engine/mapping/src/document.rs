//! Mapping document: inputs, a chain of functions, and the field that gets the result.
//!
//! A mapping is plain data, checked and compiled by [`crate::transform::compile`]; its owner
//! stores, versions and publishes it. Sources and nodes are named as in the factory; namespaces are
//! URIs, so that a mapping survives a server whose namespace indexes moved.

mod literal;
mod schema;
mod step;

use std::{borrow::Borrow, fmt, sync::Arc};

use asi_model::{BuiltInType, FieldKey, NodeId};
use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use utoipa::ToSchema;

pub use crate::convert::{Overflow, Rounding};
pub use literal::Literal;
pub use schema::TypeName;
pub use step::{
    Aggregate, Bit, BitText, BitTexts, Constant, Convert, Counter, CounterInput, Deadband,
    Debounce, Edge, EdgeDirection, Enumeration, EnumerationText, Expression, Format, Increment,
    Lookup, LookupEntry, Merge, MergeRule, OnDecrease, Parse, Rate, RatePeriod, Scale, Script,
    Select, Step, Threshold, UnitConversion, Window,
};

use shop_floor_model::{MonitorOptions, SourceId};

/// Most inputs of a mapping.
pub const INPUTS_MAX: usize = 32;
/// Most functions of a mapping.
pub const STEPS_MAX: usize = 32;
/// Most scripts of a mapping.
pub const SCRIPT_STEPS_MAX: usize = 4;
/// Longest name of an input, in bytes.
pub const INPUT_NAME_BYTES_MAX: usize = 64;

/// A mapping's identity within a connector.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord, JsonSchema, ToSchema)]
#[schemars(transparent)]
#[schema(value_type = String, min_length = 1, max_length = 512)]
pub struct MappingId(#[schemars(length(min = 1, max = 512))] Arc<str>);

/// A text is not a mapping id.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("a mapping id has 1 to 512 bytes and no control characters")]
pub struct InvalidMappingId;

impl MappingId {
    /// Checks and takes a text.
    ///
    /// # Errors
    /// [`InvalidMappingId`] when it is empty, longer than 512 bytes or contains control characters.
    pub fn new(text: impl AsRef<str>) -> Result<Self, InvalidMappingId> {
        let text = text.as_ref();
        if text.is_empty() || text.len() > 512 || text.chars().any(char::is_control) {
            return Err(InvalidMappingId);
        }
        Ok(Self(Arc::from(text)))
    }

    /// The identifier as text.
    #[must_use]
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl From<uuid::Uuid> for MappingId {
    fn from(id: uuid::Uuid) -> Self {
        Self(Arc::from(id.hyphenated().to_string()))
    }
}

impl fmt::Display for MappingId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl Borrow<str> for MappingId {
    fn borrow(&self) -> &str {
        &self.0
    }
}

impl Serialize for MappingId {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&self.0)
    }
}

impl<'de> Deserialize<'de> for MappingId {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = std::borrow::Cow::<'de, str>::deserialize(deserializer)?;
        Self::new(&text).map_err(serde::de::Error::custom)
    }
}

/// Document that leads from local variables to a requested field.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Mapping {
    /// Its identity within the connector.
    pub mapping_id: MappingId,
    /// The report field that gets the values.
    pub target: FieldKey,
    /// The built-in type of the field; what leaves the chain is of this type or a fault.
    pub target_type: TypeName,
    /// The unit the partner asked for (UNECE code or alias).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub target_unit: Option<String>,
    /// The ValueRank of the field: -1 scalar (default), 1 array, n matrix.
    #[serde(default = "scalar_rank", skip_serializing_if = "is_scalar_rank")]
    pub target_value_rank: i32,
    /// The variables it reads. The first one enters the chain.
    #[schema(max_items = 32)]
    pub inputs: Vec<MappingInput>,
    /// The functions, applied in this order.
    #[serde(default)]
    #[schema(max_items = 32)]
    pub steps: Vec<Step>,
    /// Treatment of values that arrive after newer ones of the same variable.
    #[serde(default, skip_serializing_if = "LateValues::is_default")]
    pub late_values: LateValues,
}

/// A variable of a local server, under the name that expressions and scripts use.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct MappingInput {
    /// `[A-Za-z_][A-Za-z0-9_]*`, unique within the mapping, not `value`.
    #[schema(pattern = "^[A-Za-z_][A-Za-z0-9_]{0,63}$")]
    pub name: String,
    /// The local server.
    #[schemars(with = "String")]
    pub source_id: SourceId,
    /// The variable, with its namespace's URI.
    pub node_id: NodeId,
    /// The variable's built-in type as seen when it was picked; lets a mapping be checked without
    /// its server.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub value_type: Option<TypeName>,
    /// The variable's unit as seen when it was picked (UNECE code or alias).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
    /// True where a change of this variable makes the mapping run; otherwise it is only read when
    /// another one changes.
    #[serde(default = "yes", skip_serializing_if = "is_yes")]
    pub triggers: bool,
    /// Monitoring of the variable: sampling, queue, browse path to find it again, part of an array.
    #[serde(default, skip_serializing_if = "is_default_monitoring")]
    #[schemars(with = "serde_json::Value")]
    pub monitor: MonitorOptions,
}

/// Treatment of a value whose source time lies before that of the newest value of the same
/// variable.
///
/// A value is late by at most ten seconds. A longer step back is a source whose clock was set back,
/// and the value is used.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema, ToSchema,
)]
#[serde(rename_all = "camelCase")]
pub enum LateValues {
    /// Counted and left out: the newest value stays the newest.
    #[default]
    Ignore,
    /// Used like any other; windows put it in its place.
    Use,
}

impl LateValues {
    #[allow(clippy::trivially_copy_pass_by_ref)]
    fn is_default(&self) -> bool {
        *self == Self::default()
    }
}

impl Mapping {
    /// The position of an input by its name.
    #[must_use]
    pub fn input_index(&self, name: &str) -> Option<usize> {
        self.inputs.iter().position(|input| input.name == name)
    }

    /// The built-in type of the target.
    #[must_use]
    pub const fn built_in_type(&self) -> BuiltInType {
        self.target_type.0
    }
}

const fn yes() -> bool {
    true
}

#[allow(clippy::trivially_copy_pass_by_ref)]
const fn is_yes(value: &bool) -> bool {
    *value
}

fn is_default_monitoring(options: &MonitorOptions) -> bool {
    *options == MonitorOptions::default()
}

const fn scalar_rank() -> i32 {
    -1
}

#[allow(clippy::trivially_copy_pass_by_ref)]
const fn is_scalar_rank(rank: &i32) -> bool {
    *rank == -1
}
