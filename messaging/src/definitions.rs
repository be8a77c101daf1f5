//! Definitions of external brokers: queues, routing, permissions, dead letters, limits. Generated,
//! so that no broker's configuration is written by hand or drifts from the
//! [profiles](crate::profile).
//!
//! The permissions alone separate the factories: a factory's user reads its own requests and writes
//! its own ingress, and cannot declare anything.

mod activemq;
mod mosquitto;
mod rabbitmq;

use asi_model::{FactoryId, ToolId};
use zeroize::Zeroizing;

pub use activemq::artemis_broker_xml;
pub use mosquitto::{mosquitto_acl, mosquitto_queue_limits};
pub use rabbitmq::rabbitmq_definitions;

use crate::address::LogicalAddress;

/// The users of a broker, with the bounds of its queues.
#[derive(Debug, Clone)]
pub struct BrokerPlan {
    pub platform: Account,
    pub factories: Vec<(FactoryId, Account)>,
    pub tools: Vec<(ToolId, Account)>,
    pub limits: QueueLimits,
}

/// A user of the broker with its secret.
#[derive(Clone)]
pub struct Account {
    pub user_name: String,
    /// Wiped from memory when dropped; not in the debug output.
    pub password: Zeroizing<String>,
}

impl std::fmt::Debug for Account {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Account").field("user_name", &self.user_name).finish_non_exhaustive()
    }
}

/// Bounds of one queue.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct QueueLimits {
    /// Most bytes stored. Beyond them the broker refuses messages, which stay with the publishers.
    pub bytes_max: u64,
    /// Deliveries without success after which a message becomes a dead letter. Some brokers count
    /// lost connections, too, so this is large: a connector that is restarted often must not turn
    /// good requests into dead letters.
    pub deliveries_max: u32,
}

impl Default for QueueLimits {
    fn default() -> Self {
        Self { bytes_max: 1024 * 1024 * 1024, deliveries_max: 50 }
    }
}

/// Permissions of one user.
struct Rights<'a> {
    account: &'a Account,
    consume: Vec<LogicalAddress>,
    produce: Vec<LogicalAddress>,
}

impl BrokerPlan {
    /// Returns the addresses of all queues but that of the dead letters.
    fn queues(&self) -> Vec<LogicalAddress> {
        let factories = self.factories.iter().flat_map(|(id, _)| {
            [
                LogicalAddress::FactoryRequests(id.clone()),
                LogicalAddress::FactoryLeases(id.clone()),
                LogicalAddress::FactoryIngress(id.clone()),
            ]
        });
        let tools = self.tools.iter().flat_map(|(id, _)| {
            [LogicalAddress::ToolRequests(id.clone()), LogicalAddress::ToolReports(id.clone())]
        });
        factories.chain(tools).collect()
    }

    /// Returns the permissions of all users, the platform's first.
    fn rights(&self) -> Vec<Rights<'_>> {
        let (to_platform, from_platform): (Vec<_>, Vec<_>) =
            self.queues().into_iter().partition(|a| {
                matches!(a, LogicalAddress::FactoryIngress(_) | LogicalAddress::ToolRequests(_))
            });
        let platform = Rights {
            account: &self.platform,
            consume: to_platform.into_iter().chain([LogicalAddress::DeadLetters]).collect(),
            produce: from_platform,
        };
        let factories = self.factories.iter().map(|(id, account)| Rights {
            account,
            consume: vec![
                LogicalAddress::FactoryRequests(id.clone()),
                LogicalAddress::FactoryLeases(id.clone()),
            ],
            produce: vec![LogicalAddress::FactoryIngress(id.clone())],
        });
        let tools = self.tools.iter().map(|(id, account)| Rights {
            account,
            consume: vec![LogicalAddress::ToolReports(id.clone())],
            produce: vec![LogicalAddress::ToolRequests(id.clone())],
        });
        std::iter::once(platform).chain(factories).chain(tools).collect()
    }
}
