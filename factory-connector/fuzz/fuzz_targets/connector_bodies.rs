//! Anybody with a session may send any body to the connector's API: it is read and judged, or refused with a problem.
#![no_main]

#[path = "../inputs/body.rs"]
mod body;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| body::body(bytes));
