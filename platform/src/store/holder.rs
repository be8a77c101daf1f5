//! Holders of credentials at the broker: connectors and tools.

use std::fmt;

use asi_model::{FactoryId, ToolId};
use messaging::LogicalAddress;

/// Holder of a broker credential.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum Holder {
    Factory(FactoryId),
    Tool(ToolId),
}

impl Holder {
    /// Returns the name to sign in to the broker with.
    #[must_use]
    pub fn user_name(&self) -> String {
        match self {
            Self::Factory(id) => format!("factory.{id}"),
            Self::Tool(id) => format!("tool.{id}"),
        }
    }

    /// Returns the addresses that it alone reads.
    #[must_use]
    pub fn reads(&self) -> Vec<LogicalAddress> {
        match self {
            Self::Factory(id) => vec![
                LogicalAddress::FactoryRequests(id.clone()),
                LogicalAddress::FactoryLeases(id.clone()),
            ],
            Self::Tool(id) => vec![LogicalAddress::ToolReports(id.clone())],
        }
    }

    /// Returns the holder that reads or writes an address; none for dead letters.
    #[must_use]
    pub fn of(address: &LogicalAddress) -> Option<Self> {
        let factory = address.factory_id().cloned().map(Self::Factory);
        factory.or_else(|| address.tool_id().cloned().map(Self::Tool))
    }

    pub(super) const fn kind(&self) -> &'static str {
        match self {
            Self::Factory(_) => "FACTORY",
            Self::Tool(_) => "TOOL",
        }
    }

    pub(super) fn id(&self) -> &str {
        match self {
            Self::Factory(id) => id.as_str(),
            Self::Tool(id) => id.as_str(),
        }
    }
}

impl fmt::Display for Holder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.user_name())
    }
}
