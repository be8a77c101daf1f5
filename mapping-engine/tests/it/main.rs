//! The engine as its callers see it: built-in functions, routing, restarts, back-pressure, and a
//! real shop floor.

#[path = "../conformance/bench.rs"]
mod bench;
mod publishing;
mod routing;
mod survey;
