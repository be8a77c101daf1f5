//! The basis of a decision, as consents and the ledger record it.

use serde::{Deserialize, Serialize};

use crate::{DocumentId, DocumentVersion};

/// Named policies, standing rules and caps that a decision is based on, beside the engineer's own
/// policy.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase", default)]
pub struct DecisionBasis {
    /// The named policy of the field, in its newest version.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub policy_id: Option<DocumentId>,
    /// The rules that decided, each in its version at that time.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub rules: Vec<DocumentVersion>,
    /// The named policies that contributed to the precision, in their versions at that time; in
    /// consents only.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub policies: Vec<DocumentVersion>,
    /// The caps that hold the field back, in their versions at that time.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub caps: Vec<DocumentVersion>,
    /// Salted hash of the preview that the engineer decided on, hexadecimal; in consents only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub preview: Option<String>,
    /// Salt of the hash by which ledger entries name policies, rules and caps, hexadecimal; in stored
    /// consents only, from the version on that hashes them.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(ignore)]
    pub salt: Option<String>,
    /// Salted hash in place of policies, rules and caps, hexadecimal; in ledger entries only.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(ignore)]
    pub commitment: Option<String>,
}

impl DecisionBasis {
    /// Returns true when the plant's own documents contributed: policies, rules or caps.
    #[must_use]
    pub fn names_documents(&self) -> bool {
        self.policy_id.is_some()
            || !(self.rules.is_empty() && self.policies.is_empty() && self.caps.is_empty())
    }

    /// Returns true when the engineer alone decided.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}
