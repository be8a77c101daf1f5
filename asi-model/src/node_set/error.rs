//! Reasons to refuse a NodeSet2 document.

/// Error for a document that is not a node set or breaks a limit.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum NodeSetError {
    /// The document breaks a limit.
    #[error("the document has more than {count_max} {what}")]
    TooLarge {
        /// Plural name of what is counted.
        what: &'static str,
        count_max: usize,
    },
    /// The document is not XML or not a NodeSet2.
    #[error("at byte {position}: {message}")]
    Malformed {
        /// Position in bytes, where the reader noticed.
        position: u64,
        message: String,
    },
    /// A node is not as it should be.
    #[error("node {node_id}: {message}")]
    Node {
        /// The node as the document names it, cut after 120 characters.
        node_id: String,
        message: String,
    },
}

impl NodeSetError {
    pub(super) fn malformed(position: u64, message: &str) -> Self {
        Self::Malformed { position, message: message.to_owned() }
    }
}
