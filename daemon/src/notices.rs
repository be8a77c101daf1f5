//! Notices about the parts of programs and pages that others wrote, with their licences.

/// The text, written by `make notices`: a line for each package, then each text once.
pub const NOTICES: &str = include_str!("../../THIRD-PARTY-NOTICES.txt");
