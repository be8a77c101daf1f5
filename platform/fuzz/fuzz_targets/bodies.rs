//! Anybody may send any body to the platform's API: it is read and judged, or refused with a problem.
#![no_main]

#[path = "../inputs/body.rs"]
mod body;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| body::body(bytes));
