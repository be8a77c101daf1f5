//! The daemon in each factory.
//!
//! - [`books`]: what the connector knows about networks, decisions and values, in memory, as pure functions.
//! - [`store`]: the durable file.
//! - [`disclosure`]: the one gate through which values leave.
//! - [`ledger`]: everything that left, provable.
//! - [`values`]: values as stored and as shown.

pub mod books;
pub mod disclosure;
pub mod ledger;
pub mod store;
pub mod values;
