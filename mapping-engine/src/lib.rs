//! mapping-engine.
