//! Alliances: groups of partners that tell each other what they get.

use std::collections::BTreeSet;

use asi_model::OrganisationId;
use serde::{Deserialize, Serialize};

use super::cap::{CapSubject, name_fault};
use crate::{RuleFault, Versioned};

/// Most members of an alliance.
pub const ALLIANCE_MEMBERS_MAX: usize = 100;

/// A group of partners of which the engineer assumes that they tell each other what they get. No
/// partner is told of it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Alliance {
    /// Name for people, 1 to 120 characters.
    pub name: String,
    /// The organisations, 2 to 100.
    #[schema(min_items = 2, max_items = 100)]
    pub member_list: BTreeSet<OrganisationId>,
    /// True when its members are no longer assumed to tell each other.
    #[serde(default)]
    pub is_retired: bool,
}

impl Alliance {
    /// Returns all faults of the alliance by itself and beside the other ones. Who tells each other
    /// forms one group: with an organisation in two alliances, both would know everything.
    pub fn faults<'a>(&self, others: impl Iterator<Item = &'a Versioned<Self>>) -> Vec<RuleFault> {
        let mut faults: Vec<RuleFault> = name_fault(&self.name).into_iter().collect();
        if !(2..=ALLIANCE_MEMBERS_MAX).contains(&self.member_list.len()) {
            let message = format!("An alliance has 2 to {ALLIANCE_MEMBERS_MAX} members.");
            faults.push(RuleFault { pointer: "/memberList".to_owned(), message });
        }
        if self.is_retired {
            return faults;
        }
        for other in others.filter(|other| !other.document.is_retired) {
            for (index, member) in self.member_list.iter().enumerate() {
                if other.document.member_list.contains(member) {
                    let message = format!(
                        "{member} is in the alliance {} already: add the members there, or take \
                         it out first.",
                        other.document.name
                    );
                    faults.push(RuleFault { pointer: format!("/memberList/{index}"), message });
                }
            }
        }
        faults
    }
}

/// Returns the organisations whose information a cap counts together: the partner with its allies,
/// or the members of the alliance; none for an alliance that is retired or unknown.
#[must_use]
pub fn readers<'a>(
    subject: &CapSubject,
    mut alliances: impl Iterator<Item = &'a Versioned<Alliance>>,
) -> BTreeSet<OrganisationId> {
    let found = alliances.find(|alliance| {
        let is_subject = match subject {
            CapSubject::Partner(partner) => alliance.document.member_list.contains(partner),
            CapSubject::AllianceId(id) => alliance.key.id == *id,
        };
        is_subject && !alliance.document.is_retired
    });
    let members = found.map(|alliance| alliance.document.member_list.clone());
    match subject {
        CapSubject::Partner(partner) => {
            let mut readers = members.unwrap_or_default();
            readers.insert(partner.clone());
            readers
        }
        CapSubject::AllianceId(_) => members.unwrap_or_default(),
    }
}
