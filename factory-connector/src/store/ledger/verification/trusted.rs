//! Records from outside of the store that a verification trusts.

use ledger::Hash;

/// Key and checkpoints that were kept elsewhere.
#[derive(Debug, Clone, Default)]
pub struct Trusted {
    /// The key of every signature; without it, any single one is accepted.
    pub key: Option<Hash>,
    /// Checkpoints of logs, as signed notes.
    pub checkpoints: Vec<String>,
}
