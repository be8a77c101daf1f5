//! Enumerations that columns store by name.

use asi_model::messages::{GapCause, MappingState, ValueSource};

/// Enumeration with a name for each variant, as tables store it.
///
/// Conditions on a state are written into statements as literals all the same: SQLite uses a
/// partial index (`WHERE state = 'WAITING'`) for a literal only, never for a parameter.
pub(super) trait Named: Copy + 'static {
    const ALL: &'static [Self];

    fn name(self) -> &'static str;

    /// Returns the variant with this name.
    fn from_name(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|variant| variant.name() == name)
    }
}

impl Named for MappingState {
    const ALL: &'static [Self] = &[Self::Pending, Self::Mapped, Self::Refused];

    fn name(self) -> &'static str {
        match self {
            Self::Pending => "PENDING",
            Self::Mapped => "MAPPED",
            Self::Refused => "REFUSED",
        }
    }
}

impl Named for GapCause {
    const ALL: &'static [Self] = &[Self::Coalesced, Self::Expired, Self::Withdrawn, Self::Revoked];

    fn name(self) -> &'static str {
        match self {
            Self::Coalesced => "COALESCED",
            Self::Expired => "EXPIRED",
            Self::Withdrawn => "WITHDRAWN",
            Self::Revoked => "REVOKED",
        }
    }
}

impl Named for ValueSource {
    const ALL: &'static [Self] = &[Self::Mapping, Self::Manual, Self::External];

    fn name(self) -> &'static str {
        match self {
            Self::Mapping => "MAPPING",
            Self::Manual => "MANUAL",
            Self::External => "EXTERNAL",
        }
    }
}
