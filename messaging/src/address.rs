//! Logical addresses: sender and receiver of messages, independent of any broker.

use std::{fmt, str::FromStr};

use asi_model::{FactoryId, ToolId};

use crate::text_form::serde_as_text;

/// Address that messages are sent to and received from. Only one side sends to it, so the address
/// identifies the sender.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum LogicalAddress {
    /// `factory.<factoryId>.requests`: the platform writes, the factory's connector reads.
    FactoryRequests(FactoryId),
    /// `factory.<factoryId>.leases`: the platform writes the holder of the factory's lease, every
    /// connector of the factory reads.
    FactoryLeases(FactoryId),
    /// `factory.<factoryId>.ingress`: the factory's connector writes, the platform reads.
    FactoryIngress(FactoryId),
    /// `tool.<toolId>.requests`: a partner's tool writes, the platform reads.
    ToolRequests(ToolId),
    /// `tool.<toolId>.reports`: the platform writes, the tool reads.
    ToolReports(ToolId),
    /// `dead-letters`: messages that were rejected or delivered too often.
    DeadLetters,
}

impl LogicalAddress {
    /// Returns the factory at one end of the address.
    #[must_use]
    pub const fn factory_id(&self) -> Option<&FactoryId> {
        match self {
            Self::FactoryRequests(id) | Self::FactoryLeases(id) | Self::FactoryIngress(id) => {
                Some(id)
            }
            _ => None,
        }
    }

    /// Returns the tool at one end of the address.
    #[must_use]
    pub const fn tool_id(&self) -> Option<&ToolId> {
        match self {
            Self::ToolRequests(id) | Self::ToolReports(id) => Some(id),
            _ => None,
        }
    }

    /// Returns whether only one consumer gets messages at a time: messages keep their order though
    /// another consumer connects.
    #[must_use]
    pub const fn has_single_active_consumer(&self) -> bool {
        !matches!(self, Self::FactoryLeases(_))
    }
}

/// Fault of a text that is not a logical address.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "an address is factory.<id>.requests, factory.<id>.leases, factory.<id>.ingress, tool.<id>.requests, tool.<id>.reports or dead-letters, but this is {found:?}"
)]
pub struct InvalidAddress {
    /// The text, cut after 160 characters.
    pub found: String,
}

impl fmt::Display for LogicalAddress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::FactoryRequests(id) => write!(f, "factory.{id}.requests"),
            Self::FactoryLeases(id) => write!(f, "factory.{id}.leases"),
            Self::FactoryIngress(id) => write!(f, "factory.{id}.ingress"),
            Self::ToolRequests(id) => write!(f, "tool.{id}.requests"),
            Self::ToolReports(id) => write!(f, "tool.{id}.reports"),
            Self::DeadLetters => f.write_str("dead-letters"),
        }
    }
}

impl FromStr for LogicalAddress {
    type Err = InvalidAddress;

    fn from_str(text: &str) -> Result<Self, InvalidAddress> {
        let invalid = || InvalidAddress { found: text.chars().take(160).collect() };
        let mut parts = text.split('.');
        let parsed = match (parts.next(), parts.next(), parts.next(), parts.next()) {
            (Some("dead-letters"), None, None, None) => Some(Self::DeadLetters),
            (Some("factory"), Some(id), Some(role), None) => {
                let id = FactoryId::new(id).map_err(|_| invalid())?;
                match role {
                    "requests" => Some(Self::FactoryRequests(id)),
                    "leases" => Some(Self::FactoryLeases(id)),
                    "ingress" => Some(Self::FactoryIngress(id)),
                    _ => None,
                }
            }
            (Some("tool"), Some(id), Some(role), None) => {
                let id = ToolId::new(id).map_err(|_| invalid())?;
                match role {
                    "requests" => Some(Self::ToolRequests(id)),
                    "reports" => Some(Self::ToolReports(id)),
                    _ => None,
                }
            }
            _ => None,
        };
        parsed.ok_or_else(invalid)
    }
}

serde_as_text!(LogicalAddress);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_survive_a_round_trip() {
        for text in [
            "factory.FOR_MUC.requests",
            "factory.FOR_MUC.leases",
            "factory.a-b.ingress",
            "tool.t1.requests",
            "tool.t1.reports",
            "dead-letters",
        ] {
            assert_eq!(text.parse::<LogicalAddress>().expect("an address").to_string(), text);
        }
    }

    #[test]
    fn other_texts_are_refused() {
        for text in [
            "",
            "factory",
            "factory..requests",
            "factory.a.b.requests",
            "factory.a.other",
            "tool.ü.reports",
            "dead-letters.x",
        ] {
            assert!(text.parse::<LogicalAddress>().is_err(), "{text:?}");
        }
    }
}
