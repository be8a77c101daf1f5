//! Whatever a connection carries, both sides meet it without panic, and take no more of it than a chunk.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| opcua_stack_fuzz::chunks(bytes));
