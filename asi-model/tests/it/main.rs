//! What can only be seen from outside the crate: allocations, and time that stays linear.
#![allow(unsafe_code, clippy::unwrap_used)] // The counting allocator has to pass on to the system's.

mod allocations;
mod corpus;
mod foreign;
mod linear;
mod vectors;

#[global_allocator]
static ALLOCATOR: allocations::Counting = allocations::Counting;
