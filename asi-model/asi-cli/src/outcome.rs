//! Outcomes of commands.

/// Result of a command that could be carried out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CommandOutcome {
    /// All is well.
    Valid,
    /// The input is not valid.
    Invalid,
}
