//! Conversions of values, through the stack's binary encoding and back.

mod round_trip;
mod structures;
