//! How messages reach the wire.
