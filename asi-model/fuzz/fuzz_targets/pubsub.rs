//! Any bytes are met without panic, and what is read is read alike again after it was written.
#![no_main]

#[path = "../inputs/pubsub.rs"]
mod pubsub;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| pubsub::pubsub(bytes));
