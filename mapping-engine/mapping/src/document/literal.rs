//! Values written into a mapping: constants and table entries.

use std::{borrow::Cow, sync::Arc};

use asi_model::{BuiltInType, Scalar, Variant};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Deserializer, Serialize, Serializer, de};
use serde_json::Value as Json;
use utoipa::openapi::{OneOfBuilder, RefOr};

use super::TypeName;
use crate::{convert, number::Number};

/// A single value. In JSON either plain - text is String, `true` Boolean, `3` Int64, `0.5` Double -
/// or with its type: `{"type": "UInt64", "value": "18446744073709551615"}`.
#[derive(Debug, Clone, PartialEq)]
pub struct Literal(pub Scalar);

impl Literal {
    /// The value as a variant.
    #[must_use]
    pub fn to_variant(&self) -> Variant {
        Variant::Scalar(self.0.clone())
    }

    /// The value in its shortest JSON form that reads back to the same type.
    #[must_use]
    pub fn to_json(&self) -> Json {
        match &self.0 {
            Scalar::Boolean(v) => Json::Bool(*v),
            Scalar::String(Some(v)) => Json::String(v.to_string()),
            Scalar::Int64(v) => Json::from(*v),
            // A whole double reads back as an integer, so it carries its type.
            Scalar::Double(v) if v.is_finite() && v.fract() != 0.0 => Json::from(*v),
            other => {
                serde_json::json!({ "type": other.built_in_type().name(), "value": plain(other) })
            }
        }
    }

    /// Reads either JSON form.
    ///
    /// # Errors
    /// A sentence saying what is wrong.
    pub fn from_json(json: &Json) -> Result<Self, String> {
        match json {
            Json::Object(members) => {
                let wanted: TypeName =
                    members.get("type").ok_or("a typed value needs \"type\"").and_then(|name| {
                        TypeName::deserialize(name)
                            .map_err(|_| "\"type\" is not the name of a built-in type")
                    })?;
                if members.keys().any(|key| key != "type" && key != "value") {
                    return Err("a typed value has \"type\" and \"value\" only".into());
                }
                typed(members.get("value").unwrap_or(&Json::Null), wanted.0).map(Self)
            }
            Json::Bool(v) => Ok(Self(Scalar::Boolean(*v))),
            Json::String(text) => Ok(Self(Scalar::String(Some(Arc::from(text.as_str()))))),
            Json::Number(_) => {
                let number = Number::deserialize(json).map_err(|_| "not a number".to_owned())?;
                Ok(Self(number.to_scalar()))
            }
            Json::Null | Json::Array(_) => Err("a single value is expected".into()),
        }
    }
}

impl From<Scalar> for Literal {
    fn from(scalar: Scalar) -> Self {
        Self(scalar)
    }
}

/// The value without its type; 64-bit integers and everything that is not a number as text.
fn plain(scalar: &Scalar) -> Json {
    match scalar {
        Scalar::Boolean(v) => Json::Bool(*v),
        Scalar::Int64(v) => Json::String(v.to_string()),
        Scalar::UInt64(v) => Json::String(v.to_string()),
        Scalar::StatusCode(v) => Json::from(v.0),
        Scalar::Float(v) if v.is_finite() => Json::from(*v),
        Scalar::Double(v) if v.is_finite() => Json::from(*v),
        other => match other.as_i128().and_then(|v| i64::try_from(v).ok()) {
            Some(v) => Json::from(v),
            None => convert::to_text(other).map_or(Json::Null, Json::String),
        },
    }
}

fn typed(json: &Json, wanted: BuiltInType) -> Result<Scalar, String> {
    let scalar = match json {
        Json::Null => {
            return match wanted {
                BuiltInType::String => Ok(Scalar::String(None)),
                BuiltInType::ByteString => Ok(Scalar::ByteString(None)),
                BuiltInType::XmlElement => Ok(Scalar::XmlElement(None)),
                BuiltInType::LocalizedText => Ok(Scalar::LocalizedText(Box::default())),
                _ => Err(format!("a {wanted} cannot be null")),
            };
        }
        Json::String(text) if matches!(wanted, BuiltInType::Float | BuiltInType::Double) => {
            let real = text.parse::<f64>().map_err(|_| format!("\"value\" is not a {wanted}"))?;
            // Reads NaN and the infinities too.
            #[allow(clippy::cast_possible_truncation)]
            return Ok(if wanted == BuiltInType::Float {
                Scalar::Float(real as f32)
            } else {
                Scalar::Double(real)
            });
        }
        Json::Bool(v) => Scalar::Boolean(*v),
        Json::String(text) => Scalar::String(Some(Arc::from(text.as_str()))),
        Json::Number(_) => {
            Number::deserialize(json).map_err(|_| "not a number".to_owned())?.to_scalar()
        }
        _ => return Err(format!("\"value\" is not a {wanted}")),
    };
    convert::convert_exactly(&scalar, wanted).ok_or_else(|| format!("\"value\" is not a {wanted}"))
}

impl Serialize for Literal {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.to_json().serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Literal {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Self::from_json(&Json::deserialize(deserializer)?).map_err(de::Error::custom)
    }
}

impl JsonSchema for Literal {
    fn schema_name() -> Cow<'static, str> {
        "Literal".into()
    }
    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let type_name = generator.subschema_for::<TypeName>();
        json_schema!({
            "description": "A value: plain text, Boolean or number, or an object with its type.",
            "anyOf": [
                { "type": ["string", "boolean", "number"] },
                { "type": "object", "required": ["type"], "additionalProperties": false,
                  "properties": { "type": type_name, "value": { "type": ["string", "boolean", "number", "null"] } } }
            ]
        })
    }
}

/// The typed form of a [`Literal`], for the API description.
#[derive(utoipa::ToSchema)]
#[allow(dead_code)]
struct TypedLiteral {
    /// The built-in type.
    r#type: TypeName,
    /// The value; 64-bit integers as text.
    #[schema(value_type = asi_model::openapi::PlainValue)]
    value: Json,
}

impl utoipa::PartialSchema for Literal {
    fn schema() -> RefOr<utoipa::openapi::Schema> {
        OneOfBuilder::new()
            .item(String::schema())
            .item(bool::schema())
            .item(f64::schema())
            .item(TypedLiteral::schema())
            .description(Some(
                "A value: plain text, Boolean or number, or an object with its type.",
            ))
            .into()
    }
}

impl utoipa::ToSchema for Literal {
    fn name() -> Cow<'static, str> {
        "Literal".into()
    }
    fn schemas(schemas: &mut Vec<(String, RefOr<utoipa::openapi::Schema>)>) {
        schemas.push((TypeName::name().into(), <TypeName as utoipa::PartialSchema>::schema()));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_forms_keep_value_and_type() {
        for (json, scalar) in [
            ("\"00123\"", Scalar::from("00123")),
            ("true", Scalar::Boolean(true)),
            ("3", Scalar::Int64(3)),
            ("0.5", Scalar::Double(0.5)),
            (r#"{"type":"Double","value":3.0}"#, Scalar::Double(3.0)),
            (r#"{"type":"UInt64","value":"18446744073709551615"}"#, Scalar::UInt64(u64::MAX)),
            (r#"{"type":"Byte","value":7}"#, Scalar::Byte(7)),
            (
                r#"{"type":"DateTime","value":"2019-04-18T06:00:00Z"}"#,
                Scalar::DateTime("2019-04-18T06:00:00Z".parse().expect("valid")),
            ),
        ] {
            let literal: Literal = serde_json::from_str(json).expect(json);
            assert_eq!(literal.0, scalar);
            assert_eq!(serde_json::to_string(&literal).expect("serialisable"), json);
        }
        for json in [
            "null",
            "[1]",
            r#"{"type":"Byte","value":300}"#,
            r#"{"type":"Byte","value":1,"x":1}"#,
            "{}",
        ] {
            assert!(serde_json::from_str::<Literal>(json).is_err(), "{json}");
        }
    }
}
