//! The crate as seen from outside: round trips of whole networks, foreign stacks, allocations,
//! linear time.
#![allow(unsafe_code, clippy::unwrap_used)] // The counting allocator has to pass on to the system's.

mod allocations;
mod corpus;
mod foreign;
mod foreign_messages;
mod linear;
mod networks;
mod open62541;
mod round_trip;
mod units;
mod vectors;

#[global_allocator]
static ALLOCATOR: allocations::Counting = allocations::Counting;
