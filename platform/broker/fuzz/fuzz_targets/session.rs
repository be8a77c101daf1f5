//! A peer may send anything, signed in or not: its connection ends with it, and the broker
//! serves the next one.
#![no_main]

#[path = "../inputs/session.rs"]
mod session;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| session::session(bytes));
