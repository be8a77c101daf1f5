//! The twin's two questions to the connector: who is this, and may this value become the field's?

use std::{fmt, sync::Arc};

use asi_model::{DataValue, FieldKey, StatusCode, messages::MappingState};
use async_trait::async_trait;

/// What a user may do. Each role may do what the ones after it may.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Role {
    /// Decides fields and writes values.
    Engineer,
    /// Writes values of fields that were decided External.
    Operator,
    /// Looks.
    Viewer,
}

impl Role {
    /// Whether the role may write values.
    #[must_use]
    pub const fn may_write(self) -> bool {
        matches!(self, Self::Engineer | Self::Operator)
    }

    /// Whether the role may decide fields.
    #[must_use]
    pub const fn may_decide(self) -> bool {
        matches!(self, Self::Engineer)
    }

    /// Whether the role may do what the other may.
    #[must_use]
    pub const fn includes(self, other: Self) -> bool {
        self as u8 <= other as u8
    }

    /// The role's name in lower case.
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
    /// What the user may do.
    pub role: Role,
}

/// Knows the users and their passwords.
#[async_trait]
pub trait Authenticator: Send + Sync + 'static {
    /// The role of the user with this name, if the password is right. Must take as long for an
    /// unknown user as for a wrong password. Attempts are throttled before they get here.
    async fn authenticate(&self, user_name: &str, password: &str) -> Option<Role>;
}

/// What a person decides about a field through the twin's `Decide` method.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FieldDecision {
    /// The new state. Mapped means: values come from OPC UA clients (External).
    pub mapping_state: MappingState,
    /// Why.
    pub reason: Option<String>,
}

/// Takes what OPC UA clients write and decide, through the disclosure gate and into the store.
///
/// The twin has checked the user's role, the value's type and rank, and that the field was decided
/// External. It answers the client with what these return, after they returned: after the commit.
#[async_trait]
pub trait FieldWriter: Send + Sync + 'static {
    /// A client wrote a value. Good where it was taken as it is, GoodClamped where policy coarsened
    /// it, GoodCompletesAsynchronously where policy delays or aggregates it, else why it was not
    /// taken.
    async fn write(&self, field: &FieldKey, value: DataValue, user: &TwinUser) -> StatusCode;

    /// A client called `Decide`. Good where the decision holds, else why it does not.
    async fn decide(
        &self,
        field: &FieldKey,
        decision: FieldDecision,
        user: &TwinUser,
    ) -> StatusCode;
}
