//! What people enter about operations that no machine tells of: started, one more, done, a problem,
//! a typed value.
//!
//! Pages keep entries while they are offline and deliver them later, in any order and perhaps
//! twice. So an entry has an id and a time of its own, and what the fields say follows from the set
//! of entries alone: see [`Journal`]. This module is pure; values that follow go through the
//! disclosure gate as all others do.

mod entry;
mod journal;

pub use entry::{Action, EntryFault, EntryId, OperationKey, OperatorEntry, Piece};
pub use journal::{Answer, Journal, Problem, Standing};
