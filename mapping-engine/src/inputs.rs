//! Where values come from: the seam to the shop floor.

pub use shop_floor::{InputChange, InputKey, SourceId};
