//! Entry of the OPC UA stack into the workspace: no other crate depends on it.
//!
//! The stack (`async-opcua`) is pinned to an exact version and changes its API between minor
//! versions, so everything that speaks OPC UA imports it from here as [`opcua`], and what is easy
//! to get wrong stands here once:
//!
//! - [`values`]: conversion between [`asi_model::values`] and the stack's values, both ways. Ours
//!   name namespaces by URI and the stack's by index, so each conversion takes the peer's
//!   [`NamespaceTable`].
//! - [`notifications`]: data changes decoded straight into our values, which is what a connector
//!   does all day.
//! - [`limits`]: limits of servers and clients. Several defaults of the stack lose data silently.

pub use opcua;

pub mod limits;
mod namespaces;
pub mod notifications;
pub mod values;

pub use namespaces::NamespaceTable;
