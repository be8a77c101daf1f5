//! The link and the broker against each other, over real sockets and real files.

mod broker;
mod link;
mod proxy;
mod support;
