//! A client may send anything: its requests are answered or its connection ends, and no answer says that the
//! daemon is at fault.
#![no_main]

#[path = "../inputs/client.rs"]
mod client;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| client::client(bytes));
