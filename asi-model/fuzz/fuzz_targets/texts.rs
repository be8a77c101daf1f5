//! Texts with a form of their own: what is read and written reads alike.
#![no_main]

#[path = "../inputs/texts.rs"]
mod texts;

libfuzzer_sys::fuzz_target!(|text: &str| texts::texts(text));
