//! Decisions about messages that wait to be sent, without I/O, runtime or clock: rows go in, row
//! ids and gaps to commit come out.
//!
//! A *spool* is a store-and-forward queue in its owner's database. Two kinds of owner use it:
//!
//! - The *connector* retains a report until the platform has receipted it. After the broker
//!   accepted it, a row is merely *sent*; [`apply_receipt`] and [`overdue`] decide which rows may
//!   be removed and which must be sent again, [`coalesce`] and [`expire`] bound the size.
//! - The *platform* deletes a row when the broker accepted it.
//!
//! A waiting row is in one of two streams. *Control* rows (acknowledgements, decisions, gaps,
//! everything of the platform) travel strictly in their order. *Report* rows belong to a data set
//! writer; after an outage the newest row of each writer travels first, then the backlog in order,
//! marked as replay, while new rows continue to travel live. [`LaneScheduler`] shares the
//! throughput between the two.

mod backlog;
mod gap;
mod lanes;
mod outcome;
mod receipts;
mod rejection;
mod removal;
mod row;

pub use backlog::Backlog;
pub use gap::{SequenceGap, gaps_of, join};
pub use lanes::{LaneScheduler, NextLane, ReplayShare};
pub use outcome::{RowOutcome, SendOutcome};
pub use receipts::{OverduePolicy, ReceiptEffect, apply_receipt, overdue};
pub use rejection::{ATTEMPTS_MAX, Rejection, RejectionAction, after_rejection};
pub use removal::{Removal, coalesce, expire};
pub use row::{ReportRow, RowId};
