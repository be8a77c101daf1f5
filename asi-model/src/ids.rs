//! Identifiers. Each is a type of its own, checked where it enters, so that a factory id can never
//! be taken for an operation id.

use std::{borrow::Borrow, fmt, str::FromStr, sync::Arc};

use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// Error for a text that does not match the pattern of its identifier.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{kind} must match {pattern}, but is {found:?}")]
pub struct InvalidId {
    /// The kind of identifier, as users call it.
    pub kind: &'static str,
    /// The pattern it must match.
    pub pattern: &'static str,
    /// The text, cut after 80 characters.
    pub found: String,
}

/// Longest identifier accepted where the contract does not give a tighter bound, in bytes.
pub const ID_BYTES_MAX: usize = 256;

fn is_name(text: &str) -> bool {
    (1..=64).contains(&text.len())
        && text.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_' || b == b'-')
}

/// True for the two characters that are none, which XML documents cannot carry.
pub(crate) const fn is_noncharacter(c: char) -> bool {
    matches!(c, '\u{FFFE}' | '\u{FFFF}')
}

fn is_network_id(text: &str) -> bool {
    (1..=ID_BYTES_MAX).contains(&text.len())
        && !text.chars().any(|c| c.is_control() || is_noncharacter(c))
}

fn is_field_name(text: &str) -> bool {
    let mut bytes = text.bytes();
    text.len() <= 64
        && bytes.next().is_some_and(|b| b.is_ascii_alphabetic() || b == b'_')
        && bytes.all(|b| b.is_ascii_alphanumeric() || matches!(b, b'_' | b'.' | b'-'))
}

fn is_message_id(text: &str) -> bool {
    (1..=128).contains(&text.len()) && text.bytes().all(|b| b.is_ascii_graphic())
}

macro_rules! id {
    ($(#[$doc:meta])* $name:ident, $kind:literal, $pattern:literal, $check:ident) => {
        $(#[$doc])*
        #[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord, JsonSchema)]
        #[cfg_attr(
            feature = "openapi",
            derive(utoipa::ToSchema),
            schema(value_type = String, pattern = $pattern)
        )]
        #[schemars(transparent)]
        pub struct $name(#[schemars(regex(pattern = $pattern))] Arc<str>);

        impl $name {
            /// The pattern that every such identifier matches (ECMA-262 regular expression).
            pub const PATTERN: &'static str = $pattern;

            /// Checks and takes a text.
            ///
            /// # Errors
            /// [`InvalidId`] when the text does not match [`Self::PATTERN`].
            pub fn new(text: impl AsRef<str>) -> Result<Self, InvalidId> {
                let text = text.as_ref();
                if $check(text) {
                    Ok(Self(Arc::from(text)))
                } else {
                    Err(InvalidId {
                        kind: $kind,
                        pattern: $pattern,
                        found: text.chars().take(80).collect(),
                    })
                }
            }

            /// The identifier as text.
            #[must_use]
            pub fn as_str(&self) -> &str {
                &self.0
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(&self.0)
            }
        }

        impl FromStr for $name {
            type Err = InvalidId;
            fn from_str(text: &str) -> Result<Self, InvalidId> {
                Self::new(text)
            }
        }

        impl AsRef<str> for $name {
            fn as_ref(&self) -> &str {
                &self.0
            }
        }

        impl Borrow<str> for $name {
            fn borrow(&self) -> &str {
                &self.0
            }
        }

        impl Serialize for $name {
            fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                serializer.serialize_str(&self.0)
            }
        }

        impl<'de> Deserialize<'de> for $name {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                let text = std::borrow::Cow::<'de, str>::deserialize(deserializer)?;
                Self::new(&text).map_err(serde::de::Error::custom)
            }
        }
    };
}

id!(
    /// A factory: one connector, one PublisherId, one pair of addresses on the broker.
    FactoryId,
    "a factory id",
    "^[A-Za-z0-9_-]{1,64}$",
    is_name
);
id!(
    /// An organisation that takes part in collaborations.
    OrganisationId,
    "an organisation id",
    "^[A-Za-z0-9_-]{1,64}$",
    is_name
);
id!(
    /// A partner's tool that asks for data and receives reports.
    ToolId,
    "a tool id",
    "^[A-Za-z0-9_-]{1,64}$",
    is_name
);
id!(
    /// A collaboration on the platform, under whose agreement networks are exchanged.
    CollaborationId,
    "a collaboration id",
    "^[A-Za-z0-9_-]{1,64}$",
    is_name
);
id!(
    /// An operation network, unique on a platform.
    OperationNetworkId,
    "an operation network id",
    "^[^\\u0000-\\u001F\\u007F-\\u009F\\uFFFE\\uFFFF]{1,256}$",
    is_network_id
);
id!(
    /// An operation, unique within its network.
    OperationId,
    "an operation id",
    "^[^\\u0000-\\u001F\\u007F-\\u009F\\uFFFE\\uFFFF]{1,256}$",
    is_network_id
);
id!(
    /// A relation between two operations, unique within its network.
    OperationRelationId,
    "an operation relation id",
    "^[^\\u0000-\\u001F\\u007F-\\u009F\\uFFFE\\uFFFF]{1,256}$",
    is_network_id
);
id!(
    /// A condition of a relation, unique within its network.
    ConditionId,
    "a condition id",
    "^[^\\u0000-\\u001F\\u007F-\\u009F\\uFFFE\\uFFFF]{1,256}$",
    is_network_id
);
id!(
    /// An equipment requirement, unique within its network.
    EquipmentRequirementId,
    "an equipment requirement id",
    "^[^\\u0000-\\u001F\\u007F-\\u009F\\uFFFE\\uFFFF]{1,256}$",
    is_network_id
);
id!(
    /// A dynamic data request, unique within its network. One request is one DataSetWriter.
    DynamicDataRequestId,
    "a dynamic data request id",
    "^[^\\u0000-\\u001F\\u007F-\\u009F\\uFFFE\\uFFFF]{1,256}$",
    is_network_id
);
id!(
    /// A concrete asset of a factory, as in its status data sets (OPC 10000-100 AssetId).
    AssetId,
    "an asset id",
    "^[^\\u0000-\\u001F\\u007F-\\u009F\\uFFFE\\uFFFF]{1,256}$",
    is_network_id
);
id!(
    /// The name of a report field: a key of the payload.
    FieldName,
    "a field name",
    "^[A-Za-z_][A-Za-z0-9_.-]{0,63}$",
    is_field_name
);
id!(
    /// A running connector: a new id at every start.
    InstanceId,
    "an instance id",
    "^[A-Za-z0-9_-]{1,64}$",
    is_name
);
id!(
    /// The place where a connector's store is in use. Two processes name the same place only where
    /// the operating system lets no more than one of them open the store.
    PlaceId,
    "a place id",
    "^[A-Za-z0-9_-]{1,64}$",
    is_name
);
id!(
    /// A message id, unique per message; our own senders write a UUID.
    MessageId,
    "a message id",
    "^[!-~]{1,128}$",
    is_message_id
);

impl From<uuid::Uuid> for MessageId {
    fn from(id: uuid::Uuid) -> Self {
        Self(Arc::from(id.hyphenated().to_string()))
    }
}

/// One dynamic data request, addressed through its network and operation.
#[derive(
    Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize, JsonSchema,
)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "camelCase")]
pub struct RequestKey {
    /// The network the request belongs to.
    pub operation_network_id: OperationNetworkId,
    /// The operation it asks about.
    pub operation_id: OperationId,
    /// The request itself.
    pub dynamic_data_request_id: DynamicDataRequestId,
}

/// One report field, addressed from the network down.
#[derive(
    Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize, JsonSchema,
)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "camelCase")]
pub struct FieldKey {
    /// The request whose report contains the field.
    #[serde(flatten)]
    pub request: RequestKey,
    /// The field's name within that report.
    pub field_name: FieldName,
}

impl RequestKey {
    /// The key of one of this request's fields.
    #[must_use]
    pub fn field(&self, field_name: FieldName) -> FieldKey {
        FieldKey { request: self.clone(), field_name }
    }
}

impl fmt::Display for RequestKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}/{}/{}",
            self.operation_network_id, self.operation_id, self.dynamic_data_request_id
        )
    }
}

impl fmt::Display for FieldKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.request, self.field_name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_checked() {
        for (text, ok) in
            [("FOR_MUC", true), ("a-b", true), ("", false), ("a b", false), ("ü", false)]
        {
            assert_eq!(FactoryId::new(text).is_ok(), ok, "{text:?}");
        }
        assert!(FactoryId::new("x".repeat(65)).is_err());
        for (text, ok) in [
            ("progressStatus", true),
            ("Axis1.Pos", true),
            ("1st", false),
            ("", false),
            ("a/b", false),
        ] {
            assert_eq!(FieldName::new(text).is_ok(), ok, "{text:?}");
        }
        assert!(OperationId::new("Frame %1/2#3").is_ok());
        assert!(OperationId::new(" %20 ").is_ok());
        for text in ["a\u{0}b", "a\nb", "a\u{FFFE}", "\u{FFFF}"] {
            assert!(OperationId::new(text).is_err(), "{text:?}");
        }
    }
}
