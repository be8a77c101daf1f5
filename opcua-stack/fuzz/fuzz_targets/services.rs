//! Any body of a request or response behind a channel is decoded or refused, and what is decoded is written.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| opcua_stack_fuzz::services(bytes));
