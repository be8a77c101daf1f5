//! Author of a change, with its rights.

use asi_model::{DateTime, OrganisationId, ToolId};

use crate::{
    principal::Principal,
    store::{NetworkRow, Scope},
};

/// Author of a change: a user or a tool, with its rights.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Author {
    /// The user or tool, as shown.
    pub name: String,
    pub organisation_id: Option<OrganisationId>,
    /// An administrator, who changes networks of all organisations.
    pub is_administrator: bool,
    /// True for roles that may change networks.
    pub may_plan: bool,
    pub now: DateTime,
    /// The networks the author may know of.
    pub scope: Scope,
}

impl Author {
    /// Makes the author of a signed-in user's change.
    #[must_use]
    pub fn user(principal: &Principal, now: DateTime) -> Self {
        Self {
            name: principal.user.user_name.clone(),
            organisation_id: principal.organisation().cloned(),
            is_administrator: principal.is_administrator(),
            may_plan: principal.may_plan(),
            now,
            scope: principal.scope(),
        }
    }

    /// Returns true for the organisation that drew the network, and for administrators.
    #[must_use]
    pub fn owns(&self, network: &NetworkRow) -> bool {
        let is_drawer = network.drawn_by.is_some() && network.drawn_by == self.organisation_id;
        self.is_administrator || is_drawer
    }

    /// Makes the author of a change by an organisation's tool.
    #[must_use]
    pub fn tool(tool: &ToolId, organisation: OrganisationId, now: DateTime) -> Self {
        Self {
            name: format!("tool.{tool}"),
            organisation_id: Some(organisation.clone()),
            is_administrator: false,
            may_plan: true,
            now,
            scope: Scope::Organisation(organisation),
        }
    }
}
