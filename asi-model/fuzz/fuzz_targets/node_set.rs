//! Any document is read or refused, and what is read is written and read alike.
#![no_main]

#[path = "../inputs/node_set.rs"]
mod node_set;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| node_set::node_set(bytes));
