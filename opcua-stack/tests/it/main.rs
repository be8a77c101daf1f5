//! What goes through the stack's binary encoding comes back as it was.

mod round_trip;
mod structures;
