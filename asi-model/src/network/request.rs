//! Dynamic data requests: the data that a partner requests about an operation, its frequency and
//! its composition.

use std::{borrow::Cow, fmt, time::Duration};

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Deserializer, Serialize, Serializer, de};

use crate::{
    ids::{DynamicDataRequestId, FieldName, OrganisationId, ToolId, is_noncharacter},
    values::{BuiltInType, DateTime},
};

/// A partner's request for data about an operation. One request is one DataSetWriter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "camelCase")]
pub struct DynamicDataRequest {
    /// Unique within the network.
    pub dynamic_data_request_id: DynamicDataRequestId,
    /// The tool that posted the request.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dynamic_data_request_publisher_id: Option<ToolId>,
    /// The organisation that asks.
    pub requester_id: OrganisationId,
    /// The organisations that may see the answers, and no others.
    pub recipient_list: Vec<OrganisationId>,
    /// Purpose of the data in words, for the factory's engineer.
    pub purpose: String,
    /// Begin of the time for which answers are wanted; at once where absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub valid_from: Option<DateTime>,
    /// End of the time for which answers are wanted; without end where absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub valid_until: Option<DateTime>,
    /// More about the request.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub description: Option<String>,
    /// The buffer or store the request is about.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub buffer_id: Option<String>,
    /// Number of reports wanted per [`Self::update_frequency_unit`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub update_frequency: Option<u32>,
    /// The period that [`Self::update_frequency`] divides.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub update_frequency_unit: Option<UpdateFrequencyUnit>,
    /// The composition of the report.
    pub report_data_format: ReportDataFormat,
}

impl DynamicDataRequest {
    /// The time between two reports that the partner asked for, if it named one.
    #[must_use]
    pub fn update_interval(&self) -> Option<Duration> {
        let (frequency, unit) = (self.update_frequency?, self.update_frequency_unit?);
        (frequency > 0).then(|| unit.duration() / frequency)
    }
}

/// The period of an update frequency.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum UpdateFrequencyUnit {
    Second,
    Minute,
    Hour,
    Day,
    Week,
}

impl UpdateFrequencyUnit {
    /// The length of the period.
    #[must_use]
    pub const fn duration(self) -> Duration {
        Duration::from_secs(match self {
            Self::Second => 1,
            Self::Minute => 60,
            Self::Hour => 3_600,
            Self::Day => 86_400,
            Self::Week => 604_800,
        })
    }
}

/// The fields of a report, under its name.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "camelCase")]
pub struct ReportDataFormat {
    /// The report's name; the first payload member.
    pub report_name: String,
    /// The fields, in payload order.
    pub report_field_list: Vec<ReportField>,
}

/// Scalar, in OPC UA's ValueRank.
pub const VALUE_RANK_SCALAR: i32 = -1;
/// Array of one dimension, in OPC UA's ValueRank.
pub const VALUE_RANK_ARRAY: i32 = 1;

const fn value_rank_scalar() -> i32 {
    VALUE_RANK_SCALAR
}

#[allow(clippy::trivially_copy_pass_by_ref)]
const fn is_scalar(value_rank: &i32) -> bool {
    *value_rank == VALUE_RANK_SCALAR
}

/// One value that a partner requests.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "camelCase")]
pub struct ReportField {
    /// The field's name; unique within the report.
    pub name: FieldName,
    /// Its built-in type: id 1 to 25 or name.
    #[serde(rename = "type")]
    pub field_type: FieldType,
    /// OPC UA ValueRank: -1 scalar, 1 array, n matrix of n dimensions.
    #[serde(default = "value_rank_scalar", skip_serializing_if = "is_scalar")]
    pub value_rank: i32,
    /// More about the field.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub description: Option<String>,
    /// The unit: a UNECE common code or one of its aliases (`PIECE`).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
    /// Meaning of the field; progress and forecasts build on it, never on names.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub semantic: Option<Semantic>,
}

/// A field's built-in type on the wire: read as id or name, written as id.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct FieldType(pub BuiltInType);

impl Serialize for FieldType {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_u8(self.0.id())
    }
}

impl<'de> Deserialize<'de> for FieldType {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Visitor;
        impl de::Visitor<'_> for Visitor {
            type Value = FieldType;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("an OPC UA built-in type: an id from 1 to 25 or a name as UInt64")
            }
            fn visit_u64<E: de::Error>(self, id: u64) -> Result<FieldType, E> {
                BuiltInType::from_id(id)
                    .map(FieldType)
                    .ok_or_else(|| E::invalid_value(de::Unexpected::Unsigned(id), &self))
            }
            fn visit_i64<E: de::Error>(self, id: i64) -> Result<FieldType, E> {
                u64::try_from(id)
                    .map_err(|_| E::invalid_value(de::Unexpected::Signed(id), &self))
                    .and_then(|id| self.visit_u64(id))
            }
            fn visit_str<E: de::Error>(self, name: &str) -> Result<FieldType, E> {
                name.parse()
                    .map(FieldType)
                    .map_err(|()| E::invalid_value(de::Unexpected::Str(name), &self))
            }
        }
        deserializer.deserialize_any(Visitor)
    }
}

impl JsonSchema for FieldType {
    fn schema_name() -> Cow<'static, str> {
        "FieldType".into()
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let names: Vec<&str> = BuiltInType::ALL.iter().map(|t| t.name()).collect();
        json_schema!({
            "description": "An OPC UA built-in type: its id (1 to 25) or its name.",
            "anyOf": [
                { "type": "integer", "minimum": 1, "maximum": 25 },
                { "type": "string", "enum": names }
            ]
        })
    }
}

/// Meaning of a field.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum Semantic {
    ProducedQuantity,
    GoodQuantity,
    ScrapQuantity,
    PercentComplete,
    OperationState,
    ActualStart,
    ActualEnd,
    ExpectedEnd,
    /// A meaning defined elsewhere, by its IRI.
    Iri(String),
}

const SEMANTICS: [(&str, Semantic); 8] = [
    ("PRODUCED_QUANTITY", Semantic::ProducedQuantity),
    ("GOOD_QUANTITY", Semantic::GoodQuantity),
    ("SCRAP_QUANTITY", Semantic::ScrapQuantity),
    ("PERCENT_COMPLETE", Semantic::PercentComplete),
    ("OPERATION_STATE", Semantic::OperationState),
    ("ACTUAL_START", Semantic::ActualStart),
    ("ACTUAL_END", Semantic::ActualEnd),
    ("EXPECTED_END", Semantic::ExpectedEnd),
];

/// The pattern of IRIs that are accepted (ECMA-262 regular expression).
pub(crate) const SEMANTIC_IRI_PATTERN: &str =
    "^[A-Za-z][A-Za-z0-9+.-]*:[^\\s\\u0000-\\u001F\\u007F-\\u009F\\uFFFE\\uFFFF]+$";

impl Semantic {
    /// The eight names on the wire.
    pub(crate) fn names() -> [&'static str; 8] {
        SEMANTICS.each_ref().map(|(name, _)| *name)
    }

    /// The wire form: one of the eight names, or the IRI.
    #[must_use]
    pub fn as_str(&self) -> &str {
        match self {
            Self::Iri(iri) => iri,
            known => SEMANTICS.iter().find(|(_, s)| s == known).map_or("", |(name, _)| name),
        }
    }
}

impl std::str::FromStr for Semantic {
    type Err = ();
    fn from_str(text: &str) -> Result<Self, ()> {
        if let Some((_, known)) = SEMANTICS.iter().find(|(name, _)| *name == text) {
            return Ok(known.clone());
        }
        // An IRI has a scheme; anything else would be a misspelt name.
        let is_iri = text.split_once(':').is_some_and(|(scheme, rest)| {
            !rest.is_empty()
                && scheme.starts_with(|c: char| c.is_ascii_alphabetic())
                && scheme
                    .bytes()
                    .all(|b| b.is_ascii_alphanumeric() || matches!(b, b'+' | b'-' | b'.'))
        });
        let is_foreign = |c: char| c.is_whitespace() || c.is_control() || is_noncharacter(c);
        if is_iri && text.len() <= 2048 && !text.contains(is_foreign) {
            Ok(Self::Iri(text.to_owned()))
        } else {
            Err(())
        }
    }
}

impl Serialize for Semantic {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.as_str())
    }
}

impl<'de> Deserialize<'de> for Semantic {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = Cow::<'de, str>::deserialize(deserializer)?;
        text.parse().map_err(|()| {
            de::Error::invalid_value(
                de::Unexpected::Str(&text),
                &"a semantic as PRODUCED_QUANTITY, or an IRI",
            )
        })
    }
}

impl JsonSchema for Semantic {
    fn schema_name() -> Cow<'static, str> {
        "Semantic".into()
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "description": "Meaning of a field: one of the names, or an IRI.",
            "anyOf": [
                { "type": "string", "enum": Self::names() },
                { "type": "string", "pattern": SEMANTIC_IRI_PATTERN, "maxLength": 2048 }
            ]
        })
    }
}
