//! A person or partner may send any document: it is read and judged, or refused.
#![no_main]

#[path = "../inputs/document.rs"]
mod document;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| document::document(bytes));
