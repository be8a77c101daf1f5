//! Collaborative Process Twin: an OPC UA server whose address space contains every Activity Status
//! Interface (ASI) of a factory.
//!
//! The connector gives it documents ([`AsiDocument`]) and newly disclosed values. Standard OPC UA
//! clients of the plant browse, read, subscribe and, if the engineer decided so, write. A node shows
//! the same value that the partner gets.
//!
//! - `host`: a node manager in the OPC UA stack that hosts several [`provider`]s of nodes.
//! - `asi`: the provider of the interfaces, which computes nodes from compact records.
//! - `events`: model changes and the audit trail.
//! - `discovery`: registration and announcement of the server.
//! - `security`: application certificate, trust list, users and roles.
//! - `standard_nodes`: what the twin has of the standard's own nodes.

mod access;
mod asi;
mod certificate_error;
mod clock;
mod config;
mod discovery;
mod document;
mod error;
mod events;
mod handle;
mod host;
mod host_names;
pub mod provider;
mod security;
mod server;
mod session_token;
mod sessions;
mod standard_nodes;
mod trust_fault;

pub use access::{Authenticator, FieldWriter, Role, SignInRefusal, TwinDecision, TwinUser};
pub use config::{DiscoveryConfig, SecurityConfig, TwinConfig, TwinLimits};
pub use document::{AppliedDocument, AsiDocument, FieldRecord};
pub use error::TwinError;
pub use handle::TwinHandle;
pub use security::{
    application_certificate::{ApplicationCertificate, InstalledCertificate, RequestedSubject},
    approvals::Approval,
    rejected_clients::{ConnectionRejection, RejectionReason},
    trust::{
        Authority, CertificateState, ClientCertificate, RevocationKnowledge, RevocationList,
        TrustList,
    },
};
pub use server::Twin;
pub use sessions::TwinSession;
pub use trust_fault::TrustFault;
