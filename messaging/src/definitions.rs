//! What an external broker must be told before anybody connects: queues, routing, who may do what,
//! dead letters, limits. Generated, so that no broker's configuration is written by hand and none
//! can drift from the [profiles](crate::profile).
//!
//! The rights keep factories apart by the broker alone: a factory's user reads its own requests and
//! writes its own ingress, and can declare nothing.

mod activemq;
mod mosquitto;
mod rabbitmq;

use asi_model::{FactoryId, ToolId};
use zeroize::Zeroizing;

pub use activemq::artemis_broker_xml;
pub use mosquitto::mosquitto_acl;
pub use rabbitmq::rabbitmq_definitions;

use crate::address::LogicalAddress;

/// Who uses the broker.
#[derive(Debug, Clone)]
pub struct Plan {
    /// The platform's own account.
    pub platform: Account,
    /// Each factory with its account.
    pub factories: Vec<(FactoryId, Account)>,
    /// Each tool with its account.
    pub tools: Vec<(ToolId, Account)>,
    /// Bounds of every queue.
    pub limits: QueueLimits,
}

/// A user of the broker with its secret.
#[derive(Clone)]
pub struct Account {
    /// The user's name.
    pub user_name: String,
    /// Its password; wiped from memory when dropped, never shown.
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
    /// Most bytes kept; beyond it publishers are refused and keep their messages.
    pub bytes_max: u64,
    /// A message delivered so often without success is set aside. Some brokers count lost
    /// connections, too, so this is generous: a connector that is restarted often must not turn
    /// sound requests into dead letters.
    pub deliveries_max: u32,
}

impl Default for QueueLimits {
    fn default() -> Self {
        Self { bytes_max: 1024 * 1024 * 1024, deliveries_max: 50 }
    }
}

/// What one user may do.
struct Rights<'a> {
    account: &'a Account,
    consume: Vec<LogicalAddress>,
    produce: Vec<LogicalAddress>,
}

impl Plan {
    /// Every queue there must be, the dead letters not among them.
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

    /// What each user may do, the platform first.
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
