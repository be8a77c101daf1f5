//! Tests of the protocol from outside.

mod corpus;
