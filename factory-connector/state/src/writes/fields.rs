//! Rows about requested fields: decisions, consents, states of gates and transforms.

use std::collections::BTreeMap;

use asi_model::{
    DateTime, FieldKey,
    messages::{MappingState, ValueSource},
};
use ledger::{SALT_BYTES, preview_hash};

/// Rows about fields, by field number.
#[derive(Debug, Default, PartialEq)]
pub struct FieldWrites {
    /// Fields that are new or decided again.
    pub decided: BTreeMap<i64, FieldRow>,
    /// Numbers of fields that no request has any more.
    pub removed: Vec<i64>,
    /// Fields whose gate or transform state changed.
    pub values: BTreeMap<i64, FieldValueRow>,
    /// Decisions, each with the precision it consents to.
    pub consents: Vec<ConsentRow>,
    /// Previews that decisions were made on.
    pub previews: Vec<PreviewRow>,
    /// Disclosures until a consent ended.
    pub former: Vec<FormerDisclosureRow>,
    /// Numbers of former disclosures on which nothing depends any more.
    pub forgotten: Vec<i64>,
}

impl FieldWrites {
    pub(super) fn merge(&mut self, later: Self) {
        let Self { decided, removed, values, consents, previews, former, forgotten } = later;
        super::merge::extend(&mut self.decided, decided);
        super::merge::extend(&mut self.values, values);
        self.consents.extend(consents);
        self.previews.extend(previews);
        self.former.extend(former);
        self.forgotten.extend(forgotten);
        for id in removed {
            self.remove(id);
        }
    }

    pub(super) fn remove(&mut self, id: i64) {
        self.decided.remove(&id);
        self.values.remove(&id);
        self.removed.push(id);
    }
}

/// A field with its decision.
#[derive(Debug, Clone, PartialEq)]
pub struct FieldRow {
    /// Number of the field.
    pub id: i64,
    pub key: FieldKey,
    pub mapping_state: MappingState,
    /// Source of the values, while mapped.
    pub value_source: Option<ValueSource>,
    /// Reason as the partner reads it.
    pub reason: Option<String>,
    pub decided_by: Option<String>,
    pub decided_at: Option<DateTime>,
    /// The mapping as JSON.
    pub mapping: Option<String>,
    /// The disclosure policy as JSON.
    pub policy: String,
    /// Basis of the decision, as JSON.
    pub basis: Option<String>,
    /// Number of the consent, from 1; 0 before the first.
    pub consent_version: u32,
}

/// State of a field's gate and transform.
#[derive(Debug, Clone, PartialEq)]
pub struct FieldValueRow {
    /// The gate's state as JSON.
    pub gate: String,
    /// The transform's state as JSON.
    pub transform: Option<String>,
}

/// A consent. Never changed, never deleted.
#[derive(Debug, Clone, PartialEq)]
pub struct ConsentRow {
    /// The field's key as text.
    pub field: String,
    /// Number of the consent within its field.
    pub version: u32,
    pub mapping_state: MappingState,
    /// Source of the values, while mapped.
    pub value_source: Option<ValueSource>,
    /// The disclosure policy in force, as JSON.
    pub policy: String,
    /// Basis of the decision, as JSON.
    pub basis: Option<String>,
    /// Reason as the partner reads it.
    pub reason: Option<String>,
    pub decided_by: Option<String>,
    pub decided_at: DateTime,
}

/// Disclosure of a field until its consent ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FormerDisclosureRow {
    /// Number of the row.
    pub id: i64,
    pub ended_at: DateTime,
    /// Field, policy, recipients and variables, as JSON.
    pub document: String,
}

/// A preview that a decision was made on.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PreviewRow {
    /// Salted hash of the text, hexadecimal, as the ledger's entry has it.
    pub hash: String,
    /// The preview as the engineer saw it, JSON.
    pub text: String,
    /// Random bytes, so that the hash reveals nothing.
    pub salt: [u8; SALT_BYTES],
}

impl PreviewRow {
    /// Commits to the text of a preview.
    #[must_use]
    pub fn new(text: String, salt: [u8; SALT_BYTES]) -> Self {
        Self { hash: preview_hash(&text, &salt), text, salt }
    }
}
