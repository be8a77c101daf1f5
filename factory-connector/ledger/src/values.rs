//! Commitment to a DataSetMessage's values.

use std::{borrow::Cow, fmt};

use serde::{
    Deserialize, Deserializer,
    de::{self, DeserializeSeed, MapAccess, Visitor},
};
use serde_json::value::RawValue;
use sha2::{Digest, Sha256};

use super::Hash;

/// Length of a report's salt, in bytes.
pub const SALT_BYTES: usize = 16;

/// Fault of a text that is not a DataSetMessage.
#[derive(Debug, thiserror::Error)]
#[error("the report is not a JSON object with members that can be hashed")]
pub struct ValuesError(#[from] serde_json::Error);

/// Result of the check of an entry's values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum CheckedValues {
    /// The entry has no values.
    None,
    /// The values are stored and were compared with the root.
    Compared,
    /// Retention has emptied them.
    Emptied,
}

/// Computes the root over the salted hashes of all members of a DataSetMessage (its JSON text), with
/// each payload member separately.
///
/// Each member has its own salt, derived from the report's. An auditor can be shown one value, with
/// its salt and the hashes of the other members, without a way to read or guess the others.
///
/// # Errors
/// [`ValuesError`] when the text is not a JSON object.
pub fn values_root(report: &str, salt: &[u8]) -> Result<Hash, ValuesError> {
    let mut root = Root { salt, index: 0, hasher: Sha256::new() };
    let mut text = serde_json::Deserializer::from_str(report);
    MessageMembers { root: &mut root, path: "" }.deserialize(&mut text)?;
    text.end()?;
    Ok(root.hasher.finalize().into())
}

/// The root while members are added to it, in the order of the text.
struct Root<'a> {
    salt: &'a [u8],
    index: u32,
    hasher: Sha256,
}

impl Root<'_> {
    fn add(&mut self, path: &str, name: &str, value: &str) {
        let mut member_salt = Sha256::new();
        member_salt.update(self.salt);
        member_salt.update(self.index.to_be_bytes());
        self.index += 1;
        let mut leaf = Sha256::new();
        leaf.update(member_salt.finalize());
        for part in [path, name, value] {
            leaf.update(u64::try_from(part.len()).unwrap_or(u64::MAX).to_be_bytes());
            leaf.update(part.as_bytes());
        }
        self.hasher.update(leaf.finalize());
    }
}

/// The members of the message, or of its payload, read once and not stored.
struct MessageMembers<'r, 'a> {
    root: &'r mut Root<'a>,
    path: &'static str,
}

const PAYLOAD: &str = "Payload";

#[derive(Deserialize)]
struct Name<'t>(#[serde(borrow)] Cow<'t, str>);

impl<'de> DeserializeSeed<'de> for MessageMembers<'_, '_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_map(self)
    }
}

impl<'de> Visitor<'de> for MessageMembers<'_, '_> {
    type Value = ();

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("an object")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut members: A) -> Result<(), A::Error> {
        let mut has_payload = false;
        while let Some(Name(name)) = members.next_key()? {
            if self.path.is_empty() && name == PAYLOAD {
                // Readers take the last of two, and the root tells one from two only by members.
                if std::mem::replace(&mut has_payload, true) {
                    return Err(de::Error::duplicate_field(PAYLOAD));
                }
                members.next_value_seed(MessageMembers { root: self.root, path: PAYLOAD })?;
            } else {
                self.root.add(self.path, &name, members.next_value::<&RawValue>()?.get());
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_change_changes_the_root() {
        let salt = [7; SALT_BYTES];
        let report = r#"{"SequenceNumber":1,"Payload":{"a":{"Type":9,"Body":"1"},"b":2}}"#;
        let root = values_root(report, &salt).expect("a report");
        for other in [
            r#"{"SequenceNumber":2,"Payload":{"a":{"Type":9,"Body":"1"},"b":2}}"#,
            r#"{"SequenceNumber":1,"Payload":{"a":{"Type":9,"Body":"2"},"b":2}}"#,
            r#"{"SequenceNumber":1,"Payload":{"b":2,"a":{"Type":9,"Body":"1"}}}"#,
            r#"{"SequenceNumber":1,"Payload":{"a":{"Type":9,"Body":"1"}}}"#,
        ] {
            assert_ne!(values_root(other, &salt).expect("a report"), root, "{other}");
        }
        assert_ne!(values_root(report, &[8; SALT_BYTES]).expect("a report"), root);
        assert!(values_root("[1]", &salt).is_err());
        assert!(values_root(r#"{"a":1} x"#, &salt).is_err());
        assert!(values_root(r#"{"Payload":{"a":1},"Payload":{}}"#, &salt).is_err());
    }

    #[test]
    fn the_root_of_a_report_never_changes() {
        let report = r#"{"DataSetWriterId":7,"Payload":{"a":{"Type":9,"Body":"1"},"\u00e4":2},"Status":{"Code":0}}"#;
        let root = hex::encode(values_root(report, &[7; SALT_BYTES]).expect("a report"));
        // Computed independently of this code, from the description above.
        insta::assert_snapshot!(root, @"198a9281f697f80bc1f0835c67146ec04904cad1f3fb8be5926fee511ca5ed9e");
    }
}
