//! Name of a local server.

use std::{fmt, str::FromStr, sync::Arc};

use serde::{Deserialize, Deserializer, Serialize, Serializer};
use utoipa::ToSchema;

/// The name of a source: `[A-Za-z0-9_-]{1,64}`.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord, ToSchema)]
#[schema(value_type = String, pattern = "^[A-Za-z0-9_-]{1,64}$")]
pub struct SourceId(Arc<str>);

/// A text is not a source id.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("a source id must match ^[A-Za-z0-9_-]{{1,64}}$, but is {found:?}")]
pub struct InvalidSourceId {
    /// Text that was found, cut after 80 characters.
    pub found: String,
}

impl SourceId {
    /// Checks and takes a text.
    ///
    /// # Errors
    /// [`InvalidSourceId`] when the text does not match.
    pub fn new(text: impl AsRef<str>) -> Result<Self, InvalidSourceId> {
        let text = text.as_ref();
        let is_name = (1..=64).contains(&text.len())
            && text
                .bytes()
                .all(|byte| byte.is_ascii_alphanumeric() || byte == b'_' || byte == b'-');
        if is_name {
            Ok(Self(Arc::from(text)))
        } else {
            Err(InvalidSourceId { found: text.chars().take(80).collect() })
        }
    }

    /// The id as text.
    #[must_use]
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl fmt::Display for SourceId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl FromStr for SourceId {
    type Err = InvalidSourceId;
    fn from_str(text: &str) -> Result<Self, InvalidSourceId> {
        Self::new(text)
    }
}

impl Serialize for SourceId {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&self.0)
    }
}

impl<'de> Deserialize<'de> for SourceId {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = std::borrow::Cow::<'de, str>::deserialize(deserializer)?;
        Self::new(&text).map_err(serde::de::Error::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn source_ids_are_names() {
        for text in ["press-1", "A_b"] {
            assert!(SourceId::new(text).is_ok(), "{text}");
        }
        for text in ["", "a b", "ä", &"x".repeat(65)] {
            assert!(SourceId::new(text).is_err(), "{text}");
        }
    }
}
