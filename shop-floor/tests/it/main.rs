//! The shop floor against real OPC UA servers in this process.

mod browse;
mod foreign;
mod monitor;
mod recovery;
mod security;
mod support;
