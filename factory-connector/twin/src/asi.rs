//! Provider of Activity Status Interfaces: every node is computed from a compact record on request.
//!
//! - [`model`]: the types, as data; they also declare the parts of each instance.
//! - [`interface`]: one ASI: the network as received, its indexes, a record per field.
//! - [`interfaces`]: all of them; [`location`]: search of a node by its NodeId.
//! - [`node_address`], [`identifiers`]: the position of a node in an ASI, and its readable NodeId.
//! - [`properties`], [`definitions`], [`field_properties`]: properties, component variables and
//!   methods with their values.
//! - [`nodes`], [`references`]: attributes of the nodes, and references between them.
//! - [`values`], [`difference`]: all variables of a node; changes between two states of an ASI.
//! - [`provider`]: the whole as a [`NodeProvider`](crate::provider::NodeProvider).
//! - [`updates`]: documents, decisions and values are applied and published to subscribers.
//! - [`writes`]: writes and calls of clients.

mod data_types;
mod data_values;
mod definitions;
mod difference;
mod field_properties;
mod identifiers;
mod interface;
mod interfaces;
mod location;
pub(crate) mod model;
mod node_address;
mod node_ids;
mod nodes;
mod properties;
mod provider;
mod references;
mod types;
mod updates;
mod values;
mod writes;

pub(crate) use provider::{AsiProvider, AsiSurroundings};
pub(crate) use types::TypeProvider;
