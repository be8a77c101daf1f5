//! Conversions of values, through the stack's binary encoding and back.

mod corpus;
mod edge;
mod round_trip;
mod structures;
