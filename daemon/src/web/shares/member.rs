//! Members, whose shares are used.

use super::refusals::ShareOwner;

/// Person that asks, and the organisation for which it does.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Member {
    /// Name to sign in with.
    pub person: String,
    /// Absent where all people of the daemon are of one organisation, and for administrators without one.
    pub organisation: Option<String>,
}

impl Member {
    /// Returns whose share is used up: the person's where it is, and otherwise that of the organisation.
    pub(super) fn owner(&self, is_of_person: bool) -> ShareOwner<'_> {
        match &self.organisation {
            Some(id) if !is_of_person => ShareOwner::Organisation(id),
            _ => ShareOwner::Person(&self.person),
        }
    }
}
