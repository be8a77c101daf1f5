//! A read of values, and the person or tool that read.

use access_log::{AccessKind, AgentKind};
use asi_model::{DateTime, OrganisationId};

use super::Contents;

/// Person or tool that reads values for its organisation.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Reader {
    pub organisation_id: OrganisationId,
    pub kind: AgentKind,
    /// User name or tool id, which only its own organisation is shown.
    pub name: String,
    /// Role of a user; none for tools.
    pub role: Option<&'static str>,
}

/// Values of one request that one reader got in one way.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Reading {
    pub reader: Reader,
    pub kind: AccessKind,
    pub contents: Contents,
    /// Time of the first read that it counts.
    pub since: DateTime,
}

impl Reading {
    /// Adds a later read of the same values.
    pub(super) fn add(&mut self, other: &Self) {
        self.contents.add(&other.contents);
        self.since = self.since.min(other.since);
    }
}
