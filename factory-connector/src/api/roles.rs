//! Extractors that authorise: the first argument of every handler behind a session.
//!
//! A handler without one of them cannot be registered (see [`daemon::web::roles`]), and the
//! description of the API names the role that the handler's signature asks for.

use std::ops::Deref;

use axum::{extract::FromRequestParts, http::request::Parts};
use daemon::web::{Problem, roles::RequiredRole, session::SignedIn};

use super::accounts::Principal;
use crate::store::Role;

/// Any person who is signed in.
pub struct Viewer(SignedIn<Principal>);

/// A person who may enter values: an operator or an engineer. Only a request of such a person makes
/// it:
///
/// ```compile_fail,E0423
/// fn promote(user: daemon::web::session::SignedIn<factory_connector::api::Principal>) {
///     let _ = factory_connector::api::Operator(user);
/// }
/// ```
pub struct Operator(SignedIn<Principal>);

/// A person who may decide and configure: an engineer. Only a request of such a person makes it:
///
/// ```compile_fail,E0423
/// fn promote(user: daemon::web::session::SignedIn<factory_connector::api::Principal>) {
///     let _ = factory_connector::api::Engineer(user);
/// }
/// ```
///
/// ```
/// fn name(user: &factory_connector::api::Engineer) -> &str {
///     &user.principal.user_name
/// }
/// ```
pub struct Engineer(SignedIn<Principal>);

/// Proof that an answer goes to an operator or engineer, who may see what is before the gate. Only
/// such a person's request makes it:
///
/// ```compile_fail,E0423
/// let _ = factory_connector::api::BeforeGate(());
/// ```
///
/// ```compile_fail,E0277
/// fn see(user: &factory_connector::api::Viewer) -> factory_connector::api::BeforeGate {
///     user.into()
/// }
/// ```
///
/// ```
/// fn see(user: &factory_connector::api::Operator) -> factory_connector::api::BeforeGate {
///     user.into()
/// }
/// ```
#[derive(Debug, Clone, Copy)]
pub struct BeforeGate(());

impl mapping_engine::SeesUnreleased for BeforeGate {}

impl From<&Operator> for BeforeGate {
    fn from(_: &Operator) -> Self {
        Self(())
    }
}

impl From<&Engineer> for BeforeGate {
    fn from(_: &Engineer) -> Self {
        Self(())
    }
}

impl Viewer {
    /// Returns the proof if the person is more than a viewer.
    pub(super) fn before_gate(&self) -> Option<BeforeGate> {
        match self.principal.role {
            Role::Operator | Role::Engineer => Some(BeforeGate(())),
            Role::Viewer => None,
        }
    }

    /// Returns the person's session.
    pub(super) fn into_session(self) -> SignedIn<Principal> {
        self.0
    }
}

impl Deref for Viewer {
    type Target = SignedIn<Principal>;

    fn deref(&self) -> &SignedIn<Principal> {
        &self.0
    }
}

impl Deref for Operator {
    type Target = SignedIn<Principal>;

    fn deref(&self) -> &SignedIn<Principal> {
        &self.0
    }
}

impl Deref for Engineer {
    type Target = SignedIn<Principal>;

    fn deref(&self) -> &SignedIn<Principal> {
        &self.0
    }
}

impl RequiredRole for Viewer {
    const ROLE: &'static str = Role::Viewer.name();
}

impl RequiredRole for Operator {
    const ROLE: &'static str = Role::Operator.name();
}

impl RequiredRole for Engineer {
    const ROLE: &'static str = Role::Engineer.name();
}

impl<S: Send + Sync> FromRequestParts<S> for Viewer {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, Problem> {
        SignedIn::from_request_parts(parts, state).await.map(Self)
    }
}

impl<S: Send + Sync> FromRequestParts<S> for Operator {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, Problem> {
        let user: SignedIn<Principal> = SignedIn::from_request_parts(parts, state).await?;
        match user.principal.role {
            Role::Operator | Role::Engineer => Ok(Self(user)),
            Role::Viewer => {
                Err(Problem::forbidden("This needs the role of an operator or engineer."))
            }
        }
    }
}

impl<S: Send + Sync> FromRequestParts<S> for Engineer {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, Problem> {
        let user: SignedIn<Principal> = SignedIn::from_request_parts(parts, state).await?;
        match user.principal.role {
            Role::Engineer => Ok(Self(user)),
            Role::Operator | Role::Viewer => {
                Err(Problem::forbidden("This needs the role of an engineer."))
            }
        }
    }
}
