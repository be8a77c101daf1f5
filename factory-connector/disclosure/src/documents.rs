//! Policies and rules as documents: named, versioned, never deleted.

use std::{fmt, str::FromStr};

use asi_model::DateTime;
use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error as _};

use super::DisclosurePolicy;

/// Longest name of a policy or rule, in characters.
pub const NAME_CHARS_MAX: usize = 120;
/// Most policies, and most rules.
pub const DOCUMENTS_MAX: usize = 500;

/// Fault of a text that is not the id of a policy or rule.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("an id has 1 to 64 letters, digits, _ or -")]
pub struct InvalidDocumentId;

/// The id of a policy or rule, chosen by its author.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash, utoipa::ToSchema)]
#[schema(value_type = String, pattern = "^[A-Za-z0-9_-]{1,64}$")]
pub struct DocumentId(Box<str>);

impl DocumentId {
    /// Returns the id as text.
    #[must_use]
    pub const fn as_str(&self) -> &str {
        &self.0
    }
}

impl FromStr for DocumentId {
    type Err = InvalidDocumentId;
    fn from_str(text: &str) -> Result<Self, InvalidDocumentId> {
        let is_id = (1..=64).contains(&text.len())
            && text
                .bytes()
                .all(|byte| byte.is_ascii_alphanumeric() || byte == b'_' || byte == b'-');
        if is_id { Ok(Self(text.into())) } else { Err(InvalidDocumentId) }
    }
}

impl fmt::Display for DocumentId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl Serialize for DocumentId {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&self.0)
    }
}

impl<'de> Deserialize<'de> for DocumentId {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        String::deserialize(deserializer)?.parse().map_err(D::Error::custom)
    }
}

/// One version of a policy or rule.
#[derive(
    Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, utoipa::ToSchema,
)]
#[serde(rename_all = "camelCase")]
pub struct DocumentVersion {
    pub id: DocumentId,
    /// Number from 1, which increases by one with every change.
    pub version: u32,
}

/// A policy with a name, which can be chosen for fields and set for recipients.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct NamedPolicy {
    /// Name for people, 1 to 120 characters.
    pub name: String,
    pub disclosure: DisclosurePolicy,
    /// True when it is no longer offered or applied.
    #[serde(default)]
    pub is_retired: bool,
}

/// A document with its version, author and time.
#[derive(Debug, Clone, PartialEq, Serialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct Versioned<T> {
    /// Id and version.
    #[serde(flatten)]
    pub key: DocumentVersion,
    /// Content of the document.
    #[serde(flatten)]
    pub document: T,
    /// User of the last change.
    pub changed_by: String,
    pub changed_at: DateTime,
}
