//! Scope of a query on partners' data: the viewer's rights.

use asi_model::OrganisationId;

/// Part of the partners' data that a query may see.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Scope {
    /// The platform itself: ingest, sending, reconciling. Never handed to an API handler that shows
    /// partners' data.
    Platform,
    /// Structure that an administrator needs to run the platform: organisations, factories,
    /// collaborations, networks; but no reports, values or decisions beyond those of the organisation that the
    /// administrator looks for.
    Administration {
        /// The administrator's organisation, if any.
        looking_for: Option<OrganisationId>,
    },
    /// Data granted to one organisation by its collaborations.
    Organisation(OrganisationId),
    Nothing,
}

/// Matches nothing: no organisation has the empty id.
const NOBODY: &str = "";

impl Scope {
    /// Returns for statements on structure the organisation whose membership is required, or
    /// nothing where all is visible. Used as `(CAST($n AS TEXT) IS NULL OR ... = $n)`.
    pub(super) fn member(&self) -> Option<&str> {
        match self {
            Self::Platform | Self::Administration { .. } => None,
            Self::Organisation(id) => Some(id.as_str()),
            Self::Nothing => Some(NOBODY),
        }
    }

    /// Returns for statements on reports and decisions the recipient that is required, or nothing
    /// where all is visible.
    pub(super) fn recipient(&self) -> Option<&str> {
        match self {
            Self::Platform => None,
            Self::Administration { looking_for } => {
                Some(looking_for.as_ref().map_or(NOBODY, OrganisationId::as_str))
            }
            Self::Organisation(id) => Some(id.as_str()),
            Self::Nothing => Some(NOBODY),
        }
    }
}
