//! What crosses the parts, proven with the real programs.
#![allow(clippy::unwrap_used)]

mod chaos;
mod demo;
mod house;
