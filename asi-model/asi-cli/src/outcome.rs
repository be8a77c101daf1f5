//! Outcomes of commands.

/// Result of a command that could be carried out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CommandOutcome {
    Valid,
    /// The input is not valid.
    Invalid,
}
