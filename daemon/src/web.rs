//! Web server of a daemon: problem answers, sessions, embedded pages and live events.

pub mod address_range;
pub mod api;
pub mod assets;
pub mod client_address;
mod composition;
mod compressed;
pub mod events;
pub mod extract;
pub mod headers;
pub mod health;
mod held_body;
mod in_flight;
pub mod page_listener;
pub mod problem;
mod responses;
pub mod roles;
pub mod server;
pub mod session;
pub mod shares;

pub use extract::{ApiJson, ApiPath, ApiQuery};
pub use problem::Problem;
