//! Policy of a recipient.

use asi_model::DateTime;
use disclosure::DocumentId;
use serde::Serialize;

/// The policy that is set for everything one recipient gets.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct RecipientPolicy {
    /// Number from 1, one more with every change.
    pub version: u32,
    /// The named policy; none after it was taken away.
    pub policy_id: Option<DocumentId>,
    pub changed_by: String,
    pub changed_at: DateTime,
}
