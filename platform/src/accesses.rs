//! Accesses: values of factories leave the platform only through a record of who got them.
//!
//! Values are read from the store as [`Withheld`], and live events carry them so. Only an
//! [`AccessRecorder`] opens them, after the access is on record. It depends on a store through
//! [`AccessStorage`], so that the store, which withholds, lies above it.
//!
//! # What is written when
//! The first read of a request's fields by an agent in one way is an entry, which is durable before
//! the values are handed out. Further reads are counted, and an entry each minute has their sums. An
//! agent that reads nothing for a minute begins again. So a page that is looked at for an hour is
//! about sixty entries, and a crash loses at most a minute's counts and never that a person read a
//! field.

mod coalescing;
mod contents;
mod reading;
mod recorder;
mod withheld;

pub use coalescing::Coalescer;
pub use contents::{Contents, Values};
pub use reading::{Reader, Reading};
pub use recorder::{AccessRecorder, AccessStorage, NotRecorded};
pub use withheld::Withheld;
