//! Any bytes of a connection are met by both sides without panic, and no more is taken of them than a chunk.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| opcua_stack_fuzz::chunks(bytes));
