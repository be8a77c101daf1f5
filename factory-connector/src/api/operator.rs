//! Operator's page: the operations of a day, and entries about them.

pub mod entries;
pub mod operations;
