//! The Collaborative Process Twin: an OPC UA server whose address space holds every Activity Status Interface (ASI) of
//! a factory.
//!
//! The connector gives it documents ([`AsiDocument`]) and newly disclosed values; standard OPC UA clients of the plant
//! browse, read, subscribe and - where the engineer decided so - write. *What the node shows is what the partner gets.*

mod access;
mod config;
mod document;
mod error;
mod handle;
mod server;

pub use access::{Authenticator, FieldDecision, FieldWriter, Role, TwinUser};
pub use config::{DiscoveryConfig, SecurityConfig, TwinConfig, TwinLimits};
pub use document::{Applied, AsiDocument, FieldRecord};
pub use error::TwinError;
pub use handle::TwinHandle;
pub use server::Twin;
