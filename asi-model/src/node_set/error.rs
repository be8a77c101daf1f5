//! Reasons to refuse a NodeSet2 document.

/// Why a document is not a node set we take.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum NodeSetError {
    /// It breaks a limit.
    #[error("the document has more than {count_max} {what}")]
    TooLarge {
        /// What there is too much of.
        what: &'static str,
        /// How many are accepted.
        count_max: usize,
    },
    /// It is not XML or not a NodeSet2.
    #[error("at byte {position}: {message}")]
    Malformed {
        /// Where, roughly.
        position: u64,
        /// What is wrong.
        message: String,
    },
    /// A node is not as it should be.
    #[error("node {node_id}: {message}")]
    Node {
        /// The node as the document names it, cut after 120 characters.
        node_id: String,
        /// What is wrong.
        message: String,
    },
}

impl NodeSetError {
    pub(super) fn malformed(position: u64, message: &str) -> Self {
        Self::Malformed { position, message: message.to_owned() }
    }
}
