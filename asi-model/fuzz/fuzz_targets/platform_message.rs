//! Any request is accepted or has faults; an accepted one is accepted again, splits, differs and is
//! scheduled.
#![no_main]

#[path = "../inputs/platform_message.rs"]
mod platform_message;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| platform_message::platform_message(bytes));
