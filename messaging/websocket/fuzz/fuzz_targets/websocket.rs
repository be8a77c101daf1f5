//! A peer may send anything, before the handshake and in frames: the stream ends, within its bounds.
#![no_main]

#[path = "../inputs/peer.rs"]
mod peer;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| peer::peer(bytes));
