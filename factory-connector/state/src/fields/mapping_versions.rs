//! Versions of a field's mapping, and the shadow mapping beside it.

use asi_model::DateTime;
use mapping::Mapping;

/// Bookkeeping about a field's mapping beside the decision.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MappingVersions {
    /// Number of the newest version; 0 before the first.
    pub newest: u32,
    /// The decision's mapping is the newest version: it is or was in force.
    pub is_recorded: bool,
    /// A mapping that runs beside the published one and discloses nothing.
    pub shadow: Option<Box<ShadowMapping>>,
}

impl MappingVersions {
    /// Returns the number of the decision's mapping, which it gets when it is recorded.
    #[must_use]
    pub const fn of_decision(&self) -> u32 {
        if self.is_recorded { self.newest } else { self.newest + 1 }
    }
}

/// A mapping that is observed beside the published one.
#[derive(Debug, Clone, PartialEq)]
pub struct ShadowMapping {
    /// The mapping, with an id of its own.
    pub mapping: Mapping,
    /// Name of the user who started it.
    pub author: String,
    pub started_at: DateTime,
}
