//! The Collaborative Process Twin: an OPC UA server whose address space holds every Activity Status
//! Interface (ASI) of a factory.
//!
//! The connector gives it documents ([`AsiDocument`]) and newly disclosed values; standard OPC UA
//! clients of the plant browse, read, subscribe and - where the engineer decided so - write. *What
//! the node shows is what the partner gets.*
//!
//! - `host`: our own node manager in the OPC UA stack, host of several [`provider`]s of nodes.
//! - `asi`: the provider of the interfaces, which computes nodes from compact records.
//! - `events`: model changes and the audit trail.
//! - `discovery`: being found by clients.
//! - `security`: own certificate, trust list, users and roles.

mod access;
mod asi;
mod config;
mod discovery;
mod document;
mod error;
mod events;
mod handle;
mod host;
pub mod provider;
mod security;
mod server;

pub use access::{Authenticator, FieldDecision, FieldWriter, Role, TwinUser};
pub use config::{DiscoveryConfig, SecurityConfig, TwinConfig, TwinLimits};
pub use document::{Applied, AsiDocument, FieldRecord};
pub use error::TwinError;
pub use handle::TwinHandle;
pub use security::own::{ApplicationCertificate, OwnCertificate, RequestedSubject};
pub use security::trust::{
    Authority, CertificateState, ClientCertificate, Rejection, RejectionReason,
    RevocationKnowledge, RevocationList, TrustFault, TrustList,
};
pub use server::Twin;
