//! The web side of a daemon: one way to answer, to sign in, to show pages and to tell news.

pub mod api;
pub mod assets;
pub mod events;
pub mod extract;
pub mod headers;
pub mod health;
pub mod problem;
pub mod server;
pub mod session;
pub mod shared_responses;

pub use extract::{ApiJson, ApiPath, ApiQuery};
pub use problem::Problem;
