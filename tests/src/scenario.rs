//! The frame order: a frame is made in Munich, shipped, inspected and assembled in Hamburg, and the
//! buyer wants to know how it goes. The demo plays it, the tests check it, the benchmarks load it.

mod cast;
mod decisions;
pub(crate) mod load;
pub mod order;
pub mod story;

pub use cast::Cast;
