//! Any bytes that a client signs and encrypts in a request to open a channel are decrypted and judged, or refused.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| opcua_stack_fuzz::opening(bytes));
