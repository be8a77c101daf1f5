//! The basis of a decision, as consents and the ledger record it.

use serde::{Deserialize, Serialize};

use crate::{DocumentId, DocumentVersion};

/// Named policies and standing rules that a decision rests on, beside the engineer's own words.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase", default)]
pub struct DecisionBasis {
    /// The named policy that the field takes, in whatever version.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<String>)]
    pub policy_id: Option<DocumentId>,
    /// The rules that decided, each in the version that did.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub rules: Vec<DocumentVersion>,
    /// The named policies that shaped the precision, with the versions that held; in consents only.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub policies: Vec<DocumentVersion>,
}

impl DecisionBasis {
    /// Returns true where the engineer alone decided.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}
