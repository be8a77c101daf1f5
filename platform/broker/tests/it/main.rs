//! The link and the broker against each other, over real sockets and real files.

#![allow(clippy::disallowed_methods, reason = "tests run by the machine's clock")]

mod broker;
mod foreign;
mod link;
mod outage;
mod process;
mod proxy;
mod support;
mod websocket;
