//! The shop floor against real OPC UA servers in this process.

#![allow(clippy::disallowed_methods, reason = "tests run by the machine's clock")]

mod browse;
mod controllers;
mod events;
mod foreign;
mod gaps;
mod hostile;
mod inquiry;
mod monitor;
mod peer;
mod profiles;
mod recovery;
mod security;
mod small_controllers;
mod support;
