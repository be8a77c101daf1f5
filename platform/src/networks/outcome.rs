//! Results and rejections of changes.

use asi_model::{CollaborationId, FactoryId, messages::Fault};

use crate::{live::Notification, store::StoreError};

/// Result of a change.
#[derive(Debug, Clone)]
pub struct ChangeOutcome {
    /// The revision in effect.
    pub revision: u64,
    /// False where nothing differed and the revision is the old one.
    pub is_changed: bool,
    /// The factories that were sent something, as far as the author may know of them.
    pub sent_to: Vec<FactoryId>,
    /// Notifications to publish after the commit.
    pub notifications: Vec<Notification>,
}

impl ChangeOutcome {
    /// Makes the result of a change that changed nothing.
    pub(super) const fn unchanged(revision: u64) -> Self {
        Self { revision, is_changed: false, sent_to: Vec::new(), notifications: Vec::new() }
    }
}

/// Rejection of a change.
#[derive(Debug, thiserror::Error)]
pub enum ChangeError {
    /// The author does not know such a collaboration.
    #[error("there is no collaboration {0}")]
    NoCollaboration(CollaborationId),
    /// The author does not know such a network, operation or request.
    #[error("there is no {0}")]
    NotFound(String),
    /// The author only looks on, or it belongs to another organisation.
    #[error("the role or the organisation does not allow it")]
    NotAllowed,
    /// The id belongs to a network that the author does not see.
    #[error("the id is taken")]
    Taken,
    /// The id is for another organisation.
    #[error("the id is for another organisation")]
    Reserved,
    /// The network belongs to another collaboration.
    #[error("the network belongs to another collaboration")]
    OtherCollaboration,
    /// Another change came first.
    #[error("the revision in effect is {revision}")]
    RevisionConflict {
        /// The revision in effect.
        revision: u64,
    },
    /// The author's organisation has as much as it may have.
    #[error("your organisation has {limit} {quota}, the most allowed")]
    QuotaExceeded {
        /// The quota in words, for people.
        quota: &'static str,
        limit: usize,
    },
    /// The network is wrong.
    #[error("the network has {} faults", .0.len())]
    Faulty(Vec<Fault>),
    #[error("the store failed")]
    Store(#[from] StoreError),
}
