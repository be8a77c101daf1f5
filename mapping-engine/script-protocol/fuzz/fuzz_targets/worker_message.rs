//! Bytes of a worker are a message or refused, and a message reads back as it was.
#![no_main]

#[allow(dead_code, reason = "the other target takes the other half")]
#[path = "../inputs/messages.rs"]
mod messages;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| messages::worker(bytes));
