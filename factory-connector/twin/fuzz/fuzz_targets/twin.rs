//! Any requests of a client that has signed in are answered or refused by a running twin, and others are served.
#![no_main]
#![allow(dead_code, unused_imports, reason = "parts of the tests that this target has no use for")]

#[path = "../inputs/entry.rs"]
mod entry;
#[path = "../../tests/it/harness.rs"]
mod harness;
#[path = "../../tests/it/raw_client.rs"]
mod raw_client;
#[path = "../../tests/it/raw_session.rs"]
mod raw_session;
#[path = "../inputs/requests.rs"]
mod requests;
#[path = "../../tests/it/wire.rs"]
mod wire;
