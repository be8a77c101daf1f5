//! The twin as its clients see it: a real server on loopback with real sessions.

#![allow(clippy::disallowed_methods, reason = "tests run by the machine's clock")]
#![allow(clippy::unwrap_used, reason = "a test that cannot go on should say where")]
#![allow(
    clippy::print_stdout,
    reason = "figures and seeds are shown when a test fails or is run with --nocapture"
)]

mod address_space;
mod application_certificate;
mod approvals;
mod audit;
mod audit_of_writes;
mod authority;
mod changes;
mod conformance;
mod corpus;
mod discovery;
mod edge;
mod end_of_trust;
mod fair_shares;
mod flood;
mod foreign;
mod harness;
mod hostile;
mod providers;
mod publishing;
mod raw_client;
mod raw_session;
mod scale;
mod security;
mod sign_in;
mod wire;
mod writes;
