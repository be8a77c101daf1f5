//! The engine as its callers see it: built-in functions, routing, restarts, back-pressure, and a
//! real shop floor.

#![allow(clippy::disallowed_methods, reason = "tests run by the machine's clock")]

#[path = "../conformance/bench.rs"]
mod bench;
mod publishing;
mod routing;
mod survey;
mod walls;
