//! A broker may send anything: packets are read or refused, within bounds.
#![no_main]

#[path = "../inputs/broker.rs"]
mod broker;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| broker::broker(bytes));
