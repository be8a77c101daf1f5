//! Roles of operations, taken from the signatures of their handlers.
//!
//! The first argument of a handler behind a session is an extractor that authorises. Operations
//! are registered with [`guarded!`](crate::guarded), which does not compile for another handler and
//! writes the role into the description of the operation, so that code and description agree.

use utoipa::openapi::security::SecurityRequirement;
use utoipa_axum::router::UtoipaMethodRouter;

use super::responses::operations_of;

/// Name of the security scheme that stands for a session.
pub const SESSION: &str = "session";

/// An extractor that rejects requests of people without a role.
pub trait RequiredRole {
    /// Least role that passes, as the API names it.
    const ROLE: &'static str;
}

/// A handler whose first argument authorises.
pub trait GuardedHandler<Arguments> {
    /// Least role that passes, as the API names it.
    const ROLE: &'static str;
}

macro_rules! guarded_handler {
    ($($argument:ident),*) => {
        impl<F, R, $($argument,)* A> GuardedHandler<(R, $($argument,)*)> for F
        where
            F: Fn(R, $($argument),*) -> A,
            R: RequiredRole,
        {
            const ROLE: &'static str = R::ROLE;
        }
    };
}

guarded_handler!();
guarded_handler!(A1);
guarded_handler!(A1, A2);
guarded_handler!(A1, A2, A3);
guarded_handler!(A1, A2, A3, A4);
guarded_handler!(A1, A2, A3, A4, A5);
guarded_handler!(A1, A2, A3, A4, A5, A6);

/// Adds the role of a handler to its operations: as a sentence for readers, and for programs where
/// OpenAPI 3.1 has roles of any security scheme, in the list beside the scheme's name.
pub fn with_role<S, H, Arguments>(
    (schemas, mut paths, router): UtoipaMethodRouter<S>,
    _: &H,
) -> UtoipaMethodRouter<S>
where
    H: GuardedHandler<Arguments>,
{
    for operation in paths.paths.values_mut().flat_map(operations_of) {
        let sentence = format!("Least role: {}.", H::ROLE);
        operation.description = Some(match operation.description.take() {
            Some(text) => format!("{text}\n\n{sentence}"),
            None => sentence,
        });
        operation.security = Some(vec![SecurityRequirement::new(SESSION, [H::ROLE])]);
    }
    (schemas, paths, router)
}

/// Registers one handler whose first argument is a [`RequiredRole`], for `OpenApiRouter::routes`.
#[macro_export]
macro_rules! guarded {
    ($($part:ident)::+) => {
        $crate::web::roles::with_role(::utoipa_axum::routes!($($part)::+), &$($part)::+)
    };
}
