//! What others wrote of the programs and pages, with the licences.

/// The text, written by `make notices`: a line for each package, then each text once.
pub const NOTICES: &str = include_str!("../../THIRD-PARTY-NOTICES.txt");
