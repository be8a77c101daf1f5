//! The signed-in user of an API call, and the rights that follow from its role.

use access_log::AgentKind;
use asi_model::OrganisationId;

use crate::{
    accesses::Reader,
    store::{Role, Scope, User},
};

/// The signed-in user of an API call.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Principal {
    pub user: User,
}

impl Principal {
    /// Returns the part of the partners' data that the user may see.
    #[must_use]
    pub fn scope(&self) -> Scope {
        match (self.user.role, &self.user.organisation_id) {
            (Role::Administrator, organisation) => {
                Scope::Administration { looking_for: organisation.clone() }
            }
            (_, Some(organisation)) => Scope::Organisation(organisation.clone()),
            (_, None) => Scope::Nothing,
        }
    }

    /// Returns true for those who run the platform.
    #[must_use]
    pub fn is_administrator(&self) -> bool {
        self.user.role == Role::Administrator
    }

    /// Returns true for those who may change networks and requests.
    #[must_use]
    pub fn may_plan(&self) -> bool {
        self.user.role != Role::Viewer
    }

    /// Returns the user as one that reads values for its organisation; `None` without one.
    #[must_use]
    pub fn reader(&self) -> Option<Reader> {
        Some(Reader {
            organisation_id: self.user.organisation_id.clone()?,
            kind: AgentKind::User,
            name: self.user.user_name.clone(),
            role: Some(self.user.role.as_str()),
        })
    }

    /// Returns the organisation for which the user acts.
    #[must_use]
    pub const fn organisation(&self) -> Option<&OrganisationId> {
        self.user.organisation_id.as_ref()
    }
}
