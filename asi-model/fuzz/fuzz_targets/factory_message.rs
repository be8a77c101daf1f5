//! Any message from a factory is accepted or has faults.
#![no_main]

#[path = "../inputs/factory_message.rs"]
mod factory_message;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| factory_message::factory_message(bytes));
