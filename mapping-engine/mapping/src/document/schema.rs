//! JSON form and API description of types that `asi-model` owns.

use std::{borrow::Cow, fmt};

use asi_model::{BuiltInType, network::FieldType};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use utoipa::{
    ToSchema,
    openapi::{ObjectBuilder, RefOr, Type},
};

/// A built-in type by its name; read also by its id, as the wire contract allows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct TypeName(pub BuiltInType);

impl From<BuiltInType> for TypeName {
    fn from(built_in: BuiltInType) -> Self {
        Self(built_in)
    }
}

impl fmt::Display for TypeName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.0.name())
    }
}

impl Serialize for TypeName {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.0.name())
    }
}

impl<'de> Deserialize<'de> for TypeName {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        FieldType::deserialize(deserializer).map(|field| Self(field.0))
    }
}

impl JsonSchema for TypeName {
    fn schema_name() -> Cow<'static, str> {
        "TypeName".into()
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "description": "An OPC UA built-in type by its name.", "enum": names() })
    }
}

impl utoipa::PartialSchema for TypeName {
    fn schema() -> RefOr<utoipa::openapi::Schema> {
        ObjectBuilder::new()
            .schema_type(Type::String)
            .description(Some("An OPC UA built-in type by its name."))
            .enum_values(Some(names()))
            .into()
    }
}

impl ToSchema for TypeName {
    fn name() -> Cow<'static, str> {
        "TypeName".into()
    }
}

fn names() -> Vec<&'static str> {
    BuiltInType::ALL.iter().map(|built_in| built_in.name()).collect()
}
