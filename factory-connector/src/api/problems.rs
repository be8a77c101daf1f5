//! Problems of all operations, and their conversion from errors of the connector.

use connector_state::use_cases::decide::DecisionError;
use daemon::web::{Problem, problem::ProblemFault};
use disclosure::CapExcess;
use mapping_engine::{EngineError, MappingDiagnostic, Severity};
use shop_floor::ShopFloorError;
use utoipa::IntoResponses;

use crate::{coordinator::CoordinatorError, store::StoreError};

/// The problems of any operation.
#[derive(IntoResponses)]
#[allow(dead_code)]
pub enum Problems {
    /// The request cannot be understood.
    #[response(status = 400, content_type = "application/problem+json")]
    BadRequest(Problem),
    /// No user is signed in.
    #[response(status = 401, content_type = "application/problem+json")]
    Unauthorized(Problem),
    /// The role does not allow it, or the CSRF token is wrong.
    #[response(status = 403, content_type = "application/problem+json")]
    Forbidden(Problem),
    /// The resource does not exist.
    #[response(status = 404, content_type = "application/problem+json")]
    NotFound(Problem),
    /// The call does not fit the present state.
    #[response(status = 409, content_type = "application/problem+json")]
    Conflict(Problem),
    /// Understood, but wrong in its meaning; each fault with its JSON pointer.
    #[response(status = 422, content_type = "application/problem+json")]
    Unprocessable(Problem),
    /// A part that is needed is not there at the moment.
    #[response(status = 503, content_type = "application/problem+json")]
    Unavailable(Problem),
}

/// Problems of operations that check a password or a code.
#[derive(IntoResponses)]
#[allow(dead_code)]
pub enum AttemptProblems {
    /// The request cannot be understood.
    #[response(status = 400, content_type = "application/problem+json")]
    BadRequest(Problem),
    /// No user is signed in.
    #[response(status = 401, content_type = "application/problem+json")]
    Unauthorized(Problem),
    /// The role does not allow it, or the CSRF token is wrong.
    #[response(status = 403, content_type = "application/problem+json")]
    Forbidden(Problem),
    /// The resource does not exist.
    #[response(status = 404, content_type = "application/problem+json")]
    NotFound(Problem),
    /// The call does not fit the present state.
    #[response(status = 409, content_type = "application/problem+json")]
    Conflict(Problem),
    /// Understood, but wrong in its meaning; each fault with its JSON pointer.
    #[response(status = 422, content_type = "application/problem+json")]
    Unprocessable(Problem),
    /// Too many attempts were made.
    #[response(status = 429, content_type = "application/problem+json")]
    TooManyRequests(Problem),
    /// A part that is needed is not there at the moment.
    #[response(status = 503, content_type = "application/problem+json")]
    Unavailable(Problem),
}

impl From<StoreError> for Problem {
    fn from(error: StoreError) -> Self {
        if let StoreError::TooExpensive { .. } = error {
            tracing::warn!(%error, "A page asked for more than can be read in its time.");
            return Self::unavailable(
                "TOO_EXPENSIVE",
                "This takes longer to read than a page may keep others waiting. Ask for less at once, as a smaller limit \
                 or one field or recipient alone, or try again later.",
            );
        }
        Self::internal(&error)
    }
}

/// Returns the problem of a decision that is not taken.
pub(super) fn decision_problem(error: DecisionError) -> Problem {
    match error {
        DecisionError::UnknownField => Problem::not_found("such field"),
        DecisionError::Policy(faults) => {
            let faults = faults
                .into_iter()
                .map(|fault| ProblemFault {
                    pointer: format!("/disclosure/{}", fault.member),
                    code: "INVALID_POLICY".to_owned(),
                    message: fault.message,
                })
                .collect();
            Problem::unprocessable(
                "INVALID_POLICY",
                "The disclosure policy does not fit the field.",
                faults,
            )
        }
        DecisionError::OverCap(excesses) => over_cap(&excesses, "/disclosure"),
        DecisionError::AnotherPreview => Problem::conflict(
            "PREVIEW_OF_ANOTHER_POLICY",
            "A policy was changed since the preview was shown. Look at the preview again.",
        ),
        DecisionError::DecidedSince => Problem::conflict(
            "DECIDED_SINCE",
            "The field is not as it was shown any more: another decision was taken, or the request \
             was changed. Look at it before you decide.",
        ),
        other => Problem::unprocessable("INVALID_DECISION", format!("{other}."), Vec::new()),
    }
}

/// Returns the problem of a change that would let partners learn more than caps allow; `pointer` is
/// the member that would do so.
pub(super) fn over_cap(excesses: &[CapExcess], pointer: &str) -> Problem {
    let faults = excesses.iter().map(|excess| over_cap_fault(excess, pointer.to_owned()));
    let detail = "Partners would get more information than a cap allows. Nothing was changed.";
    Problem::unprocessable("OVER_CAP", detail, faults.collect())
}

/// Returns the fault at `pointer`, which would let partners learn more than a cap allows.
pub(super) fn over_cap_fault(excess: &CapExcess, pointer: String) -> ProblemFault {
    ProblemFault { pointer, code: "OVER_CAP".to_owned(), message: excess.to_string() }
}

impl From<CoordinatorError> for Problem {
    fn from(error: CoordinatorError) -> Self {
        match error {
            CoordinatorError::NotWritten => Self::unavailable(
                "NOT_WRITTEN",
                "It could not be written to disk, so nothing was changed. Check the disk of the data directory.",
            ),
            CoordinatorError::Stopped => {
                Self::unavailable("STOPPING", "The connector is stopping.")
            }
        }
    }
}

/// Converts an error of the mapping engine.
pub fn engine(error: EngineError) -> Problem {
    match error {
        EngineError::Rejected(diagnostics) => mapping_faults(diagnostics),
        EngineError::Stopped => Problem::unavailable("STOPPING", "The connector is stopping."),
        other => Problem::conflict("LIMIT_REACHED", format!("{other}.")),
    }
}

/// Converts an error of a local server or of its connection.
pub fn shop_floor(error: ShopFloorError) -> Problem {
    Problem::unprocessable("SOURCE_REFUSED", format!("{error}."), Vec::new())
}

/// Returns the problem that lists all errors of a mapping.
pub fn mapping_faults(diagnostics: Vec<MappingDiagnostic>) -> Problem {
    let faults = diagnostics
        .into_iter()
        .filter(|diagnostic| diagnostic.severity == Severity::Error)
        .map(|diagnostic| ProblemFault {
            pointer: format!("/mapping{}", diagnostic.pointer),
            code: "INVALID_MAPPING".to_owned(),
            message: diagnostic.message,
        })
        .collect();
    Problem::unprocessable("INVALID_MAPPING", "The mapping has errors.", faults)
}
