//! The whole connector in this process, over real machines of the simulator; the platform stays away.

mod mappings;
mod plant;
