//! OPC UA client sessions to any number of local servers.
//!
//! The only crate that speaks OPC UA as a client. Callers name the variables that they need, or the
//! events of a notifier with the value that they make ([`ShopFloorHandle::monitor`]), and receive
//! changes with value, status and source time. The crate connects, secures sessions, observes the
//! server's limits, subscribes again and finds renumbered nodes.
//!
//! - One task and at most one session per source, which is the only owner of its subscriptions.
//! - Node ids are named by namespace URI; indexes are looked up again in every session, and a
//!   node that is gone is found by its browse path.
//! - A source that is lost yields `BadNotConnected` for each of its inputs; a connection that looks
//!   alive but delivers nothing is recovered.
//! - A slow consumer never blocks a session: changes are then coalesced to the newest per input,
//!   and counted.

mod certificates;
mod change_queue;
mod clock;
mod config;
mod context;
mod error;
mod handle;
mod monitor_options;
mod offer;
mod registry;
mod service;
mod source;
mod status;

pub use certificates::{OwnCertificate, OwnCertificates, PeerCertificate, TrustState};
pub use config::{
    Config, Identity, MessageSecurity, Password, SecurityChoice, SecurityPolicy, SourceConfig,
};
pub use error::ShopFloorError;
pub use handle::ShopFloorHandle;
pub use offer::{EndpointOffer, OfferedCertificate, ServerFinding, ServerOffer, TestedServer};
pub use service::ShopFloor;
pub use shop_floor_model::{
    BrowsePath, BrowsedNode, EventSelection, EventValue, InputChange, InputKey, InvalidBrowsePath,
    InvalidSourceId, ListedVariable, MonitorOptions, MonitorRequest, NodeClass, NodeType,
    ServerProfile, SourceCallResult, SourceId, UnitName, VariableList,
};
pub use status::{
    ChosenEndpoint, CoarseInput, FilledInput, GrantedIntervals, InputProblem, ServerLimits,
    ServerProduct, SourceProblem, SourceProblemKind, SourceState, SourceStatus,
};
