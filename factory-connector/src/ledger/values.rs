//! The commitment to a DataSetMessage's values.

use indexmap::IndexMap;
use serde_json::value::RawValue;
use sha2::{Digest, Sha256};

use super::Hash;

/// Length of a report's salt, in bytes.
pub const SALT_BYTES: usize = 16;

/// The text is not a DataSetMessage.
#[derive(Debug, thiserror::Error)]
#[error("the report is not a JSON object with members that can be hashed")]
pub struct ValuesError(#[from] serde_json::Error);

type Members<'a> = IndexMap<String, &'a RawValue>;

/// The root over the salted hashes of all members of a DataSetMessage (its JSON text), payload members singly.
///
/// Each member has a salt of its own, derived from the report's, so that one value can be shown to an auditor - with its
/// salt and the other members' hashes - without showing the others or letting them be guessed.
///
/// # Errors
/// [`ValuesError`] when the text is not a JSON object.
pub fn values_root(report: &str, salt: &[u8]) -> Result<Hash, ValuesError> {
    let members: Members<'_> = serde_json::from_str(report)?;
    let mut root = Sha256::new();
    let mut place = 0_u32;
    let mut leaf = |path: &str, name: &str, value: &RawValue| {
        let mut member_salt = Sha256::new();
        member_salt.update(salt);
        member_salt.update(place.to_be_bytes());
        place += 1;
        let mut leaf = Sha256::new();
        leaf.update(member_salt.finalize());
        for part in [path, name, value.get()] {
            leaf.update(u64::try_from(part.len()).unwrap_or(u64::MAX).to_be_bytes());
            leaf.update(part.as_bytes());
        }
        root.update(leaf.finalize());
    };
    for (name, value) in &members {
        if name == "Payload" {
            let payload: Members<'_> = serde_json::from_str(value.get())?;
            for (field, value) in &payload {
                leaf("Payload", field, value);
            }
        } else {
            leaf("", name, value);
        }
    }
    Ok(root.finalize().into())
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
    }
}
