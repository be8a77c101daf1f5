//! Any bytes are met without panic by what decodes frames and messages.
#![no_main]

#[path = "../inputs/decode.rs"]
mod decode;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| decode::decode(bytes));
