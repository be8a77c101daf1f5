//! Any value is met without panic in both leniencies, and written in all encodings.
#![no_main]

#[path = "../inputs/value.rs"]
mod value;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| value::value(bytes));
