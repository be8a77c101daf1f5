//! Ids of rows for those outside, which say nothing of the number behind them.

use std::{borrow::Cow, fmt, str::FromStr};

use serde::Serialize;
use utoipa::{
    PartialSchema, ToSchema,
    openapi::{ObjectBuilder, RefOr, Schema, Type},
};

/// Digits of an id: 128 bits, hexadecimal.
const DIGITS: usize = 32;

/// Random id of a row: 32 hexadecimal digits. A row's number counts over all members, and is said to
/// nobody.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(transparent)]
pub struct OpaqueId(String);

/// Text that is no such id.
#[derive(Debug, thiserror::Error)]
#[error("{0:?} is no opaque id")]
pub struct InvalidOpaqueId(String);

impl OpaqueId {
    /// Makes an id of random bits.
    #[must_use]
    pub fn new(bits: u128) -> Self {
        Self(format!("{bits:032x}"))
    }

    /// Returns the text.
    #[must_use]
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl fmt::Display for OpaqueId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl FromStr for OpaqueId {
    type Err = InvalidOpaqueId;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let is_digit = |byte: u8| matches!(byte, b'0'..=b'9' | b'a'..=b'f');
        if text.len() == DIGITS && text.bytes().all(is_digit) {
            Ok(Self(text.to_owned()))
        } else {
            Err(InvalidOpaqueId(text.chars().take(80).collect()))
        }
    }
}

impl PartialSchema for OpaqueId {
    fn schema() -> RefOr<Schema> {
        ObjectBuilder::new()
            .schema_type(Type::String)
            .description(Some("A random id, which says nothing of an order or a number."))
            .pattern(Some("^[0-9a-f]{32}$"))
            .into()
    }
}

impl ToSchema for OpaqueId {
    fn name() -> Cow<'static, str> {
        "OpaqueId".into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_id_reads_back_and_a_number_is_none() {
        for bits in [0, 7, u128::MAX] {
            let id = OpaqueId::new(bits);
            assert_eq!(id.to_string().parse::<OpaqueId>().expect("an id"), id);
        }
        for text in ["", "7", "00000000000000000000000000000000f", &"G".repeat(DIGITS)] {
            assert!(text.parse::<OpaqueId>().is_err(), "{text:?}");
        }
    }
}
