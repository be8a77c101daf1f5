//! The embedded broker: in a process of its own, so that the pages outlive it, or in this one.
//!
//! The platform starts its own program as the process and talks with it by lines of JSON over
//! standard input and output: first what to listen on and who may sign in, then orders and their
//! answers. Users and queues are kept here, too, so that a process that is started again has what
//! was said while there was none. The process ends with its input, so also with a platform that is
//! killed.

mod embedded;
mod lines;
mod supervised;
mod supervisor;
mod wire;

pub use embedded::{EmbeddedBroker, EmbeddedBrokerError};
pub use supervised::{SupervisedError, run_supervised};
pub use supervisor::{BrokerProcess, BrokerProcessError, BrokerProcessHandle};
pub use wire::{ListenerSetup, Setup};
