//! The shared language of Verbund: messages between partners' tools, factory connectors and the
//! platform.
//!
//! The crate defines content, never transport. It is pure: no I/O, no async, no clock,
//! no randomness.
//!
//! - [`ids`]: identifiers that cannot be malformed.
//! - [`values`]: OPC UA built-in values (OPC 10000-6 §5.1) as plain Rust data.
//! - [`network`]: operation networks, dynamic data requests and report formats.
//! - [`messages`]: every message of the wire contract besides reports.
//! - [`plain_value`]: values as plain JSON, without their types.
//! - [`pubsub`]: reports as OPC UA PubSub messages, meaning apart from encoding.
//! - [`opcua_json`]: the OPC UA JSON encoding of values (OPC 10000-6 §5.4).
//! - [`validation`]: checks of foreign messages, all faults at once.
//! - [`difference`]: differences of revisions, with their effects on mappings and consent.
//! - [`split`]: the part of a network that concerns one factory.
//! - [`schedule`]: earliest and latest times, slack and the critical path of a network.
//! - [`schema`]: JSON Schemas of every message.
//! - [`units`]: UNECE units, their aliases and conversion.
//! - [`asi_types`]: the OPC UA type model of the Activity Status Interface.
//! - [`instance`]: Activity Status Interfaces as nodes, and back.
//! - [`node_set`]: OPC UA nodes as NodeSet2 documents.
//! - [`json`]: the bounded reader and the plain writer that the encodings share.
//! - `openapi`: descriptions for OpenAPI documents, with the feature of that name.

pub mod asi_types;
pub mod difference;
pub mod ids;
pub mod instance;
pub mod json;
pub mod messages;
pub mod network;
pub mod node_set;
pub mod opcua_json;
#[cfg(feature = "openapi")]
pub mod openapi;
pub mod plain_value;
pub mod pubsub;
pub mod schedule;
pub mod schema;
pub mod split;
pub mod units;
pub mod validation;
pub mod values;

pub use ids::*;
pub use values::{BuiltInType, DataValue, DateTime, NodeId, Scalar, StatusCode, Variant};
