//! Outcomes of commands.

/// How a command ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// All is well.
    Valid,
    /// The input is not valid.
    Invalid,
}
