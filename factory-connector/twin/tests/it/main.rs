//! The twin as its clients see it: a real server on loopback, real sessions.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should say where")]

mod address_space;
mod changes;
mod foreign;
mod harness;
mod providers;
mod security;
mod writes;
