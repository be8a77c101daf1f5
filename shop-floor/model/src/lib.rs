//! Plain data about sources and their variables: identities, monitoring options, browsed nodes.
//!
//! Pure: mappings, stored configuration and suggestions name variables with these types and do not
//! need the OPC UA client.

mod browse_path;
mod event;
mod input;
mod node;
mod profile;
mod source_id;

pub use browse_path::{BrowsePath, InvalidBrowsePath, PATH_ELEMENTS_MAX};
pub use event::{EventSelection, EventValue, SEVERITY_MAX};
pub use input::{InputChange, InputKey, MonitorOptions, MonitorRequest};
pub use node::{
    BrowsedNode, ListedVariable, NodeClass, NodeType, SourceCallResult, UnitName, VariableList,
};
pub use profile::{
    AdvisedIntervals, EvidenceKind, ProfileFigure, ProfileLimit, ProfileNote, ServerProfile,
};
pub use source_id::{InvalidSourceId, SourceId};
