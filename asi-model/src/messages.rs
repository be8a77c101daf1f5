//! The messages of the wire contract besides reports: each self-contained, with `messageType` and
//! `messageId`.

mod from_factory;
mod lease;
mod to_factory;

pub use from_factory::{
    Acknowledgement, AcknowledgementResult, AggregateStatement, AssetKind, AssetOffer, Decision,
    DecisionTarget, DisclosureStatement, FactoryMessage, Fault, Gap, GapCause, HoursStatement,
    MappingState, RateStatement, ValueSource,
};
pub use lease::{Lease, LeaseParty, LeaseRequest, LeaseResult};
pub use to_factory::{
    AssetRequest, Comment, OperationNetworkMessage, PlatformMessage, Receipt, Withdraw,
    WriterReceipt,
};

/// Largest body of a message to a factory, in bytes after compression.
pub const REQUEST_BYTES_MAX: usize = 1024 * 1024;
/// Largest body of any other message, in bytes.
pub const MESSAGE_BYTES_MAX: usize = 256 * 1024;
