//! Extractors that authorise: the first argument of every handler behind a session.
//!
//! A handler without one of them cannot be registered (see [`daemon::web::roles`]), and the
//! description of the API names the role that the handler's signature asks for.

use axum::{extract::FromRequestParts, http::request::Parts};
use daemon::web::{Problem, roles::RequiredRole, session::SignedIn};

use super::accounts::Principal;
use crate::store::Role;

/// Any person who is signed in.
pub struct Viewer(pub SignedIn<Principal>);

/// A person who may enter values: an operator or an engineer.
pub struct Operator(pub SignedIn<Principal>);

/// A person who may decide and configure: an engineer.
pub struct Engineer(pub SignedIn<Principal>);

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
