//! Descriptions for OpenAPI documents of types whose JSON is no plain structure.

use std::borrow::Cow;

use utoipa::{
    PartialSchema, ToSchema,
    openapi::{
        ObjectBuilder, RefOr, Schema, Type,
        schema::{AnyOfBuilder, SchemaType},
    },
};

use crate::{
    network::{FieldType, SEMANTIC_IRI_PATTERN, Semantic},
    values::{BuiltInType, NodeId},
};

impl PartialSchema for BuiltInType {
    fn schema() -> RefOr<Schema> {
        ObjectBuilder::new()
            .schema_type(Type::String)
            .description(Some("An OPC UA built-in type by its name."))
            .enum_values(Some(Self::ALL.map(Self::name)))
            .into()
    }
}

impl ToSchema for BuiltInType {
    fn name() -> Cow<'static, str> {
        "BuiltInType".into()
    }
}

impl PartialSchema for FieldType {
    fn schema() -> RefOr<Schema> {
        let id = ObjectBuilder::new().schema_type(Type::Integer).minimum(Some(1)).maximum(Some(25));
        AnyOfBuilder::new()
            .description(Some("An OPC UA built-in type: its id (1 to 25) or its name."))
            .item(id)
            .item(BuiltInType::schema())
            .into()
    }
}

impl ToSchema for FieldType {
    fn name() -> Cow<'static, str> {
        "FieldType".into()
    }
}

impl PartialSchema for Semantic {
    fn schema() -> RefOr<Schema> {
        let name = ObjectBuilder::new().schema_type(Type::String).enum_values(Some(Self::names()));
        let iri = ObjectBuilder::new()
            .schema_type(Type::String)
            .pattern(Some(SEMANTIC_IRI_PATTERN))
            .max_length(Some(2048));
        AnyOfBuilder::new()
            .description(Some("Meaning of a field: one of the names, or an IRI."))
            .item(name)
            .item(iri)
            .into()
    }
}

impl ToSchema for Semantic {
    fn name() -> Cow<'static, str> {
        "Semantic".into()
    }
}

impl PartialSchema for NodeId {
    fn schema() -> RefOr<Schema> {
        ObjectBuilder::new()
            .schema_type(Type::String)
            .description(Some("A NodeId as text; its namespace by URI."))
            .examples(["nsu=urn:press;s=Cell.Counter"])
            .into()
    }
}

impl ToSchema for NodeId {
    fn name() -> Cow<'static, str> {
        "NodeId".into()
    }
}

/// Schema of a value as plain JSON, without its type: any JSON.
#[derive(Debug, Clone, Copy)]
pub struct PlainValue;

impl PartialSchema for PlainValue {
    fn schema() -> RefOr<Schema> {
        any(
            "A value as plain JSON of any kind: number, text, truth value, list, object, or null where \
             there is none. 64-bit integers are texts.",
        )
    }
}

impl ToSchema for PlainValue {
    fn name() -> Cow<'static, str> {
        "PlainValue".into()
    }
}

/// Schema of a value as the members of an OPC UA payload have it (OPC 10000-6 §5.4): any JSON.
#[derive(Debug, Clone, Copy)]
pub struct EncodedValue;

impl PartialSchema for EncodedValue {
    fn schema() -> RefOr<Schema> {
        any(
            "A value in the OPC UA JSON encoding (OPC 10000-6 §5.4) of the message that carried it: \
             plain, a Variant, or a DataValue.",
        )
    }
}

impl ToSchema for EncodedValue {
    fn name() -> Cow<'static, str> {
        "EncodedValue".into()
    }
}

fn any(description: &str) -> RefOr<Schema> {
    ObjectBuilder::new().schema_type(SchemaType::AnyValue).description(Some(description)).into()
}
