//! The daemon in each factory.

pub mod disclosure;
pub mod ledger;
