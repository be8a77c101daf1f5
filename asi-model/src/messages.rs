//! The messages of the wire contract besides reports: each self-contained, with `messageType` and
//! `messageId`.

mod asset;
mod comment;
mod disclosure;
mod from_factory;
mod lease;
mod ledger;
mod past_release;
mod revocation;
mod to_factory;

pub use asset::{AssetKind, AssetOffer, AssetRequest};
pub use comment::Comment;
pub use disclosure::{
    AggregateStatement, DisclosureStatement, HoursStatement, RateStatement, StatusResolution,
};
pub use from_factory::{
    Acknowledgement, AcknowledgementResult, Decision, DecisionTarget, FactoryMessage, Fault, Gap,
    GapCause, MappingState, ReceiptRequest, ValueSource, WriterSequences,
};
pub use lease::{Lease, LeaseParty, LeaseRequest, LeaseResult};
pub use ledger::{LedgerCheckpoint, LedgerCheckpointResult, LedgerCosignature, ledger_log_origin};
pub use past_release::{PastRelease, ReportRange};
pub use revocation::SignedRevocation;
pub use to_factory::{OperationNetworkMessage, PlatformMessage, Receipt, Withdraw, WriterReceipt};

/// Largest body of a message to a factory, in bytes after compression.
pub const REQUEST_BYTES_MAX: usize = 1024 * 1024;
/// Largest body of any other message, in bytes.
pub const MESSAGE_BYTES_MAX: usize = 256 * 1024;
