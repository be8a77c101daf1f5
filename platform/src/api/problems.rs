//! Problem responses of the operations, and their mapping from inner errors.

use asi_model::messages::Fault;
use daemon::web::{Problem, problem::ProblemFault, session::HashingError};
use utoipa::IntoResponses;

use crate::{
    accesses::NotRecorded, administrator::AdministratorError, broker_access::BrokerAccessError,
    config::BrokerPasswordError, enrolment::EnrolmentError, networks::ChangeError,
    store::StoreError,
};

/// Problems of operations that read.
#[derive(IntoResponses)]
#[allow(dead_code)]
pub enum ReadProblems {
    /// The request cannot be understood.
    #[response(status = 400, content_type = "application/problem+json")]
    BadRequest(Problem),
    /// No user is signed in.
    #[response(status = 401, content_type = "application/problem+json")]
    Unauthorized(Problem),
    /// The role does not allow it, or the CSRF token is wrong.
    #[response(status = 403, content_type = "application/problem+json")]
    Forbidden(Problem),
    /// The resource does not exist, or the viewer has no part in it.
    #[response(status = 404, content_type = "application/problem+json")]
    NotFound(Problem),
    /// Reading takes too long; ask for less at once.
    #[response(status = 503, content_type = "application/problem+json")]
    Unavailable(Problem),
}

/// Problems of operations that change something.
#[derive(IntoResponses)]
#[allow(dead_code)]
pub enum ChangeProblems {
    /// The request cannot be understood.
    #[response(status = 400, content_type = "application/problem+json")]
    BadRequest(Problem),
    /// No user is signed in.
    #[response(status = 401, content_type = "application/problem+json")]
    Unauthorized(Problem),
    /// The role does not allow it, or the CSRF token is wrong.
    #[response(status = 403, content_type = "application/problem+json")]
    Forbidden(Problem),
    /// The resource does not exist, or the viewer has no part in it.
    #[response(status = 404, content_type = "application/problem+json")]
    NotFound(Problem),
    /// The call does not fit the present state.
    #[response(status = 409, content_type = "application/problem+json")]
    Conflict(Problem),
    /// Understood, but wrong in its meaning; each fault with its JSON pointer.
    #[response(status = 422, content_type = "application/problem+json")]
    Unprocessable(Problem),
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
    /// The resource does not exist, or the viewer has no part in it.
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
    /// Too many people are signing in at once.
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
                 or one network or request alone, or try again later.",
            );
        }
        Self::internal(&error)
    }
}

impl From<NotRecorded> for Problem {
    fn from(error: NotRecorded) -> Self {
        Self::internal(&error)
    }
}

impl From<EnrolmentError> for Problem {
    fn from(error: EnrolmentError) -> Self {
        match error {
            EnrolmentError::TokenRefused => Self::new(
                axum::http::StatusCode::FORBIDDEN,
                "TOKEN_REFUSED",
                "The token is unknown, used or too old; ask an administrator of the platform for a new one.",
            ),
            EnrolmentError::NoAccount(BrokerPasswordError::Missing { user_name }) => {
                Self::conflict(
                    "NO_ACCOUNT",
                    format!(
                        "The broker is administered elsewhere and has no account {user_name} that the platform knows of; \
                         add it to the file broker.external.password_file."
                    ),
                )
                .with("userName", user_name)
            }
            EnrolmentError::NoAccount(error) => Self::internal(&error),
            EnrolmentError::Store(error) => Self::internal(&error),
        }
    }
}

impl From<BrokerAccessError> for Problem {
    fn from(error: BrokerAccessError) -> Self {
        Self::internal(&error)
    }
}

impl From<AdministratorError> for Problem {
    fn from(error: AdministratorError) -> Self {
        match error {
            AdministratorError::Password(HashingError::Busy) => {
                Self::unavailable("BUSY", "Too many passwords wait to be checked; try again.")
            }
            AdministratorError::Password(HashingError::Password(reason)) => Self::unprocessable(
                "PASSWORD_REFUSED",
                format!("The password is refused: {reason}."),
                vec![ProblemFault {
                    pointer: "/password".to_owned(),
                    code: "PASSWORD_REFUSED".to_owned(),
                    message: format!("{reason}."),
                }],
            ),
            error @ AdministratorError::NameWasUsed(_) => {
                Self::conflict("NAME_WAS_USED", format!("{error}."))
            }
            other => Self::internal(&other),
        }
    }
}

impl From<ChangeError> for Problem {
    fn from(error: ChangeError) -> Self {
        match error {
            ChangeError::NoCollaboration(id) => Self::not_found(format_args!("collaboration {id}")),
            ChangeError::NotFound(what) => Self::not_found(what),
            ChangeError::NotAllowed => Self::forbidden(
                "This needs the role of a planner in the organisation that asks or drew it, or an administrator.",
            ),
            ChangeError::Taken => taken("network"),
            ChangeError::Reserved => Self::conflict(
                "ID_RESERVED",
                "Ids that end in @ and an organisation are for that organisation. Choose another.",
            ),
            ChangeError::OtherCollaboration => Self::conflict(
                "OTHER_COLLABORATION",
                "A network with this id belongs to another collaboration.",
            ),
            ChangeError::RevisionConflict { revision } => Self::conflict(
                "REVISION_CONFLICT",
                format!(
                    "Another change was faster: the revision in effect is {revision}. Read it and try again."
                ),
            )
            .with("revision", revision),
            ChangeError::QuotaExceeded { .. } => quota_exceeded(&error.to_string()),
            ChangeError::Faulty(faults) => faulty(faults, ""),
            ChangeError::Store(error) => error.into(),
        }
    }
}

/// Returns the problem of a document with faults; `prefix` is its JSON pointer in the request body.
pub fn faulty(faults: Vec<Fault>, prefix: &str) -> Problem {
    let detail = match faults.len() {
        1 => "The document has a fault.".to_owned(),
        count => format!("The document has {count} faults."),
    };
    let faults = faults
        .into_iter()
        .map(|fault| ProblemFault {
            pointer: format!("{prefix}{}", fault.pointer),
            code: fault.code,
            message: fault.message,
        })
        .collect();
    Problem::unprocessable("INVALID_DOCUMENT", detail, faults)
}

/// Returns the problem of a reference to something that does not exist.
pub fn unknown_reference(pointer: &str, what: &str) -> Problem {
    let message = format!("There is no {what}; add it first.");
    Problem::unprocessable(
        "UNKNOWN_REFERENCE",
        message.clone(),
        vec![ProblemFault {
            pointer: pointer.to_owned(),
            code: "UNKNOWN_REFERENCE".to_owned(),
            message,
        }],
    )
}

/// Returns the problem of a member that has as much as it may have; the reason names quota and limit.
pub fn quota_exceeded(reason: &str) -> Problem {
    let detail = format!("This exceeds a quota: {reason}.");
    Problem::conflict("QUOTA_EXCEEDED", detail)
}

/// Returns the problem of an id that is already in use.
pub fn taken(what: &str) -> Problem {
    Problem::conflict("ALREADY_EXISTS", format!("There is a {what} with this id already."))
}
