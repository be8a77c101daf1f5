//! JSON of values inside stored state. Private to it: the wire has its own encodings.

use std::sync::Arc;

use asi_model::{BuiltInType, DateTime, Scalar, StatusCode, Variant, values::Array};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::{
    document::{Literal, TypeName},
    quality::Meta,
};

#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum StoredVariant {
    Array {
        array: TypeName,
        elements: Vec<Literal>,
        #[serde(default)]
        dimensions: Option<Vec<u32>>,
    },
    Scalar(Option<Literal>),
}

/// A variant. Structures are not kept: state that holds one is null after a restart, and filled by
/// the next value.
pub(crate) mod variant {
    use super::{
        Arc, Array, BuiltInType, Deserialize, Deserializer, Literal, Scalar, Serialize, Serializer,
    };
    use super::{StoredVariant, TypeName, Variant};

    pub fn serialize<S: Serializer>(value: &Variant, serializer: S) -> Result<S::Ok, S::Error> {
        let is_kept = |built_in: BuiltInType| {
            built_in.id() <= 17
                || matches!(built_in, BuiltInType::StatusCode | BuiltInType::LocalizedText)
        };
        let stored = match value {
            Variant::Scalar(scalar) if is_kept(scalar.built_in_type()) => {
                StoredVariant::Scalar(Some(Literal(scalar.clone())))
            }
            Variant::Array(array) if is_kept(array.element_type) => StoredVariant::Array {
                array: TypeName(array.element_type),
                elements: array.elements.iter().cloned().map(Literal).collect(),
                dimensions: array.dimensions.clone(),
            },
            _ => StoredVariant::Scalar(None),
        };
        stored.serialize(serializer)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Variant, D::Error> {
        Ok(match StoredVariant::deserialize(deserializer)? {
            StoredVariant::Scalar(None) => Variant::Null,
            StoredVariant::Scalar(Some(literal)) => Variant::Scalar(literal.0),
            StoredVariant::Array { array, elements, dimensions } => {
                let elements: Vec<Scalar> = elements.into_iter().map(|literal| literal.0).collect();
                Variant::Array(Arc::new(Array { element_type: array.0, elements, dimensions }))
            }
        })
    }
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
struct StoredMeta {
    #[serde(default, skip_serializing_if = "is_good")]
    status: StatusCode,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    source_timestamp: Option<DateTime>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    server_timestamp: Option<DateTime>,
}

#[allow(clippy::trivially_copy_pass_by_ref)]
fn is_good(status: &StatusCode) -> bool {
    *status == StatusCode::GOOD
}

/// Status and times; picoseconds are not kept.
pub(crate) mod meta {
    use super::{Deserialize, Deserializer, Meta, Serialize, Serializer, StoredMeta};

    pub fn serialize<S: Serializer>(meta: &Meta, serializer: S) -> Result<S::Ok, S::Error> {
        let Meta { status, source_timestamp, server_timestamp, .. } = *meta;
        StoredMeta { status, source_timestamp, server_timestamp }.serialize(serializer)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Meta, D::Error> {
        let StoredMeta { status, source_timestamp, server_timestamp } =
            StoredMeta::deserialize(deserializer)?;
        Ok(Meta { status, source_timestamp, server_timestamp, ..Meta::default() })
    }
}
