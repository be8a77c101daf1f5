//! The link and the broker against each other, over real sockets and real files.

#![allow(clippy::disallowed_methods, reason = "tests run by the machine's clock")]

mod broker;
mod corpus;
mod counted;
mod dead_letters;
mod disk;
mod foreign;
mod guesses;
mod hostile;
mod hostile_broker;
mod library;
mod link;
mod order;
mod outage;
mod process;
mod proxy;
mod raw;
mod space;
mod support;
mod websocket;
