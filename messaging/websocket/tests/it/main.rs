//! Both sides against each other, and each against a peer that speaks by hand.

mod bytes;
mod corpus;
mod handshake;
mod hostile;
mod raw;
