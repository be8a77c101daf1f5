//! Entries of operators about operations without a machine: started, one more piece, done, a
//! problem, a typed value.
//!
//! Pages store entries while they are offline and deliver them later, in any order and perhaps
//! twice. So an entry has an id and a time of its own, and the values of fields follow from the set
//! of entries alone: see [`Journal`]. These values go through the disclosure gate like all others.

mod entry;
mod journal;
mod typed_value;

pub use entry::{Action, EntryFault, EntryId, OperationKey, OperatorEntry, Piece};
pub use journal::{Journal, OperationStatus, OperatorProblem, OperatorStatement};
pub use typed_value::typed_value;
