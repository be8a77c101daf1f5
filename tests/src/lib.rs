//! Tests across the parts: the demo, the end-to-end tests, chaos and the benchmarks of the whole
//! path.
//!
//! - [`harness`]: starts the real programs in a folder of their own, on free ports, and talks to
//!   them from outside.
//! - [`mod@bench`]: latency and throughput of the whole path.
//! - [`mod@chaos`]: everything that can go wrong, seeded, and the proof that nothing is lost or
//!   doubled.
//! - [`demo`]: the frame order played for a person, or checked without one.
//! - [`mod@probes`]: attacks that once worked, replayed, and many at once.
//! - [`world`]: two factories and a cloud, configured and running.
//! - [`course`]: when the demo's order is planned and worked off.
//! - [`frame_order`]: partners, operations and requests of the order that two factories share.
//! - [`scenario`]: the frame order from the first message to the last value; the demo, its check and
//!   the tests all play it.

#![allow(clippy::disallowed_methods, reason = "tests run by the machine's clock")]

pub mod bench;
pub mod chaos;
pub mod course;
pub mod demo;
pub mod frame_order;
pub mod harness;
pub mod probes;
pub mod scenario;
pub mod world;
