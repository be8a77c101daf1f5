//! The real programs, started in a folder of their own and addressed from outside.

mod api;
mod daemon;
mod files;
mod foreign;
mod steps;
mod wait;

pub use api::{Api, ApiError};
pub use daemon::{Daemon, DaemonCommand, binary, kill_started_in};
pub use files::{make_private, write_private};
pub use foreign::{python, repository};
pub use steps::{Steps, say};
pub use wait::{Deadline, eventually, until};
