//! The provider of Activity Status Interfaces: every node is computed from a compact record when it
//! is asked for.
//!
//! - [`model`]: the types, as data; they also say which parts each instance has.
//! - [`interface`]: one ASI - the network as received, its indexes, a record per field.
//! - [`place`]: where a node sits in an ASI, and the readable NodeIds.
//! - [`parts`]: properties, component variables and methods with their values.
//! - [`nodes`], [`references`]: what the nodes are, and how they hang together.
//! - [`difference`]: what changed between two states of an ASI, in terms of nodes.
//! - [`provider`]: the whole as a [`NodeProvider`](crate::provider::NodeProvider).
//! - [`updates`]: applying documents, decisions and values, and telling subscribers.
//! - [`writes`]: what clients write and call.

mod difference;
mod interface;
pub(crate) mod model;
mod nodes;
mod parts;
mod place;
mod provider;
mod references;
mod types;
mod updates;
mod writes;

pub(crate) use provider::{AsiProvider, AsiSurroundings};
pub(crate) use types::TypeProvider;
