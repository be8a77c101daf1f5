//! script-protocol.
