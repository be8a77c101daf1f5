//! Status codes that are disclosed: of 32 bits that machine, script or client chose, as few as the
//! policy says.

use asi_model::StatusCode;
use serde::{Deserialize, Serialize};

/// Resolution of the disclosed status codes, from the finest to the coarsest.
#[derive(
    Debug,
    Clone,
    Copy,
    PartialEq,
    Eq,
    PartialOrd,
    Ord,
    Hash,
    Default,
    Serialize,
    Deserialize,
    utoipa::ToSchema,
)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum StatusCodes {
    /// Every status code as it is, with sub-code and info bits.
    Full,
    /// A small fixed set; any other code is replaced by its severity.
    #[default]
    Common,
    /// One of Good, Uncertain and Bad.
    Severity,
}

/// The codes of [`StatusCodes::Common`], beside which there is none. A reader of reports needs them
/// to tell whether a value can be used and whether to wait for another one: whether the source is
/// reachable, out of service or without data, and whether a value is the last one before that. All
/// other sub-codes name causes within the plant, and the maker of a value chooses info bits.
pub(super) const COMMON: [StatusCode; 9] = [
    StatusCode::GOOD,
    StatusCode::UNCERTAIN,
    StatusCode::UNCERTAIN_LAST_USABLE_VALUE,
    StatusCode::UNCERTAIN_NO_COMMUNICATION_LAST_USABLE_VALUE,
    StatusCode::BAD,
    StatusCode::BAD_NO_DATA,
    StatusCode::BAD_NOT_CONNECTED,
    StatusCode::BAD_OUT_OF_SERVICE,
    // The gate's own, for a value of another type than the field's.
    StatusCode::BAD_TYPE_MISMATCH,
];

impl StatusCodes {
    /// Returns true for the resolution of a policy that says nothing about status codes.
    #[must_use]
    pub fn is_common(&self) -> bool {
        *self == Self::Common
    }

    /// Coarsens a status code. A coarse one stays as it is.
    #[must_use]
    pub(super) fn coarsen(self, status: StatusCode) -> StatusCode {
        match self {
            Self::Full => status,
            Self::Common if COMMON.contains(&status) => status,
            Self::Common | Self::Severity => severity(status),
        }
    }
}

/// Returns the code that says nothing but the severity; the reserved one counts as Bad.
const fn severity(status: StatusCode) -> StatusCode {
    if status.is_good() {
        StatusCode::GOOD
    } else if status.is_uncertain() {
        StatusCode::UNCERTAIN
    } else {
        StatusCode::BAD
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_status_code_has_the_resolution_of_the_policy() {
        for (full, common, severity) in [
            (StatusCode::GOOD, StatusCode::GOOD, StatusCode::GOOD),
            (StatusCode::GOOD_CLAMPED, StatusCode::GOOD, StatusCode::GOOD),
            // Info bits of a limit and of a structure that changed.
            (StatusCode(0x0000_4701), StatusCode::GOOD, StatusCode::GOOD),
            (StatusCode(0x408F_0001), StatusCode::UNCERTAIN, StatusCode::UNCERTAIN),
            (
                StatusCode::UNCERTAIN_LAST_USABLE_VALUE,
                StatusCode::UNCERTAIN_LAST_USABLE_VALUE,
                StatusCode::UNCERTAIN,
            ),
            (StatusCode(0x4000_002A), StatusCode::UNCERTAIN, StatusCode::UNCERTAIN),
            (StatusCode::BAD_OUT_OF_SERVICE, StatusCode::BAD_OUT_OF_SERVICE, StatusCode::BAD),
            (StatusCode::BAD_SENSOR_FAILURE, StatusCode::BAD, StatusCode::BAD),
            // The reserved severity.
            (StatusCode(0xC000_0007), StatusCode::BAD, StatusCode::BAD),
        ] {
            assert_eq!(StatusCodes::Full.coarsen(full), full);
            assert_eq!(StatusCodes::Common.coarsen(full), common, "{full}");
            assert_eq!(StatusCodes::Severity.coarsen(full), severity, "{full}");
        }
    }
}
