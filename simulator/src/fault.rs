//! Faults that can be injected into a machine.

use serde::{Deserialize, Serialize};

/// A fault. In JSON an object with the member `fault`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(
    tag = "fault",
    rename_all = "camelCase",
    rename_all_fields = "camelCase",
    deny_unknown_fields
)]
pub enum MachineFault {
    /// Heals all faults and starts a killed server again; the layout stays.
    None,
    /// Cuts all connections; new ones are accepted at once.
    DropConnections,
    /// The network swallows everything, both ways; connections stay open.
    HangNetwork,
    /// Values stand still.
    StopUpdating,
    /// Subscriptions that exist now are told nothing any more, although values go on, reads show
    /// them and keep-alives are sent. New subscriptions work.
    StallSubscriptions,
    /// All variables, or one, have this status.
    BadStatus {
        status: u32,
        /// The variable's key; all if absent.
        #[serde(default)]
        variable: Option<String>,
    },
    /// The machine's clock is wrong: source and server times are ahead by so much (negative:
    /// behind).
    WrongClock { ahead_ms: i64 },
    /// The server ends without closing its sessions.
    Kill,
    /// The server ends without closing its sessions, and comes back after a while.
    Restart {
        /// Namespaces and node ids after the restart.
        #[serde(default)]
        layout: Layout,
        /// Time until the restart, in milliseconds.
        #[serde(default)]
        down_ms: u64,
    },
}

/// Namespace indexes and node ids of a server; the default is that of a first start.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", default, deny_unknown_fields)]
pub struct Layout {
    /// Number of further namespaces before the machine's (at most 100), which
    /// come in reverse order.
    pub namespaces_before: u16,
    /// Other than 0: nodes have other ids, and ids that existed before name other nodes where they
    /// are numbers.
    pub renumbered: u32,
}
