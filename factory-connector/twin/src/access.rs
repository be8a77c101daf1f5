//! Interfaces to the connector: authentication of users, and writes and decisions of clients.

use std::{fmt, net::IpAddr, sync::Arc};

use asi_model::{DataValue, FieldKey, StatusCode, messages::MappingState};
use async_trait::async_trait;

/// Role of a user. Each role includes the ones after it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Role {
    /// Decides fields and writes values.
    Engineer,
    /// Writes values of fields that were decided External.
    Operator,
    /// Reads and subscribes, the least role.
    Viewer,
}

impl Role {
    /// Returns whether the role may write values.
    #[must_use]
    pub const fn may_write(self) -> bool {
        matches!(self, Self::Engineer | Self::Operator)
    }

    /// Returns whether the role may decide fields.
    #[must_use]
    pub const fn may_decide(self) -> bool {
        matches!(self, Self::Engineer)
    }

    /// Returns whether the role has all rights of the other.
    #[must_use]
    pub const fn includes(self, other: Self) -> bool {
        self as u8 <= other as u8
    }

    /// Returns the role's name in lower case.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Engineer => "engineer",
            Self::Operator => "operator",
            Self::Viewer => "viewer",
        }
    }

    pub(crate) fn from_name(name: &str) -> Option<Self> {
        [Self::Engineer, Self::Operator, Self::Viewer].into_iter().find(|role| role.name() == name)
    }
}

impl fmt::Display for Role {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// The user of a session.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TwinUser {
    /// The name the user signed in with; `anonymous` for the development endpoint.
    pub name: Arc<str>,
    pub role: Role,
}

/// Checks names and passwords.
#[async_trait]
pub trait Authenticator: Send + Sync + 'static {
    /// Returns the role of the user, if the password is right; a code of a second factor may follow it in the same
    /// text. Must take as long for an unknown user as for a wrong password. The client's address is none where the
    /// twin opened the connection.
    ///
    /// # Errors
    /// [`SignInRefusal`], which the client does not learn.
    async fn authenticate(
        &self,
        user_name: &str,
        password: &str,
        client: Option<IpAddr>,
    ) -> Result<Role, SignInRefusal>;
}

/// Reason for which a user is not signed in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SignInRefusal {
    /// User name, password or code is wrong.
    WrongCredentials,
    /// The password is right, but the user's second factor cannot be given in a text.
    SecondFactorImpossible,
    /// Too many attempts failed, here or on the pages.
    TooManyAttempts,
    /// The credentials could not be checked now.
    NotChecked,
}

impl SignInRefusal {
    pub(crate) const fn reason(self) -> &'static str {
        match self {
            Self::WrongCredentials => "the user name, password or code is wrong",
            Self::SecondFactorImpossible => {
                "the user's only second factor is a passkey, which OPC UA clients cannot show; turn codes of an app on, too"
            }
            Self::TooManyAttempts => "too many attempts failed, here or on the pages",
            Self::NotChecked => "the credentials could not be checked now",
        }
    }
}

/// A person's decision about a field through the twin's `Decide` method.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TwinDecision {
    /// The new state. For `Mapped` the values come from OPC UA clients (External).
    pub mapping_state: MappingState,
    pub reason: Option<String>,
}

/// Receives values and decisions of OPC UA clients, for the disclosure gate and the store.
///
/// The twin has checked the user's role, the value's type and rank, and that the field was decided
/// External. The client gets the returned status after the commit.
#[async_trait]
pub trait FieldWriter: Send + Sync + 'static {
    /// Accepts a value that a client wrote. Returns Good if it is accepted unchanged, GoodClamped if
    /// policy coarsens it, GoodCompletesAsynchronously if policy delays or aggregates it, otherwise
    /// the cause of the refusal.
    async fn write(&self, field: &FieldKey, value: DataValue, user: &TwinUser) -> StatusCode;

    /// Applies a decision of a client. Returns Good, or the cause for which it is not accepted.
    async fn decide(&self, field: &FieldKey, decision: TwinDecision, user: &TwinUser)
    -> StatusCode;
}
