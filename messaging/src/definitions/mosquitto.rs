//! Access control for Mosquitto (`acl_file`). Passwords belong into its own password file
//! (`mosquitto_passwd`).

use std::fmt::Write;

use super::BrokerPlan;
use crate::profile::BrokerProfile;

/// Lines of `mosquitto.conf` that bound what waits for a client.
///
/// Mosquitto bounds what waits for each client, over all of its topics, by `max_queued_bytes`, and drops further
/// messages without a word to their publisher. The receipts make good for reports once there is room
/// again, and for nothing else. There is one number for all clients, so it is that of those with most topics, which are
/// the factories: the platform is a client for each of its topics, so that what one factory has waiting is bounded by
/// itself. The number of messages is not bounded, whose default of 1000 would be reached within
/// minutes.
#[must_use]
pub fn mosquitto_queue_limits(plan: &BrokerPlan) -> String {
    let others = plan.rights().into_iter().skip(1);
    let queues = others.map(|rights| rights.consume.len() as u64).max();
    let bytes_max = plan.limits.bytes_max.saturating_mul(queues.unwrap_or(1).max(1));
    format!("max_queued_messages 0\nmax_queued_bytes {bytes_max}\n")
}

/// Comments on the listeners. Mosquitto ends the connection of a client whose id another one gives as its own, of any
/// user; the platform is known by several ids.
const LISTENERS: [&str; 3] = [
    "The listener of factories and tools needs `use_username_as_clientid true`: without it each of them can end the",
    "connections of others, and of the platform, by their client ids. The platform needs a listener of its own without that",
    "line, which factories and tools do not reach.",
];

/// The access control list: each user reads and writes its own topics, and nothing else. Its first
/// lines are comments with what belongs into `mosquitto.conf`.
///
/// Mosquitto stores its queue after it has acknowledged messages, all of it each time. The receipts make
/// good for reports that a crash loses in between, and a link counts all other messages as sent only when
/// Mosquitto has had the time to store them. Its file shrinks with the first storing after messages were consumed or
/// have expired.
#[must_use]
pub fn mosquitto_acl(plan: &BrokerPlan) -> String {
    let profile = BrokerProfile::mqtt();
    let mut acl = String::from("# Generated. mosquitto.conf needs these lines:\n");
    let limits = mosquitto_queue_limits(plan);
    let storing = ["persistence true", "autosave_interval 1", "autosave_on_changes true"];
    for line in storing.into_iter().chain(limits.lines()) {
        let _ = writeln!(acl, "#   {line}");
    }
    for line in LISTENERS {
        let _ = writeln!(acl, "# {line}");
    }
    acl.push_str("# Without a user nothing is permitted.\n");
    for rights in plan.rights() {
        let _ = writeln!(acl, "\nuser {}", rights.account.user_name);
        for (kind, addresses) in [("read", &rights.consume), ("write", &rights.produce)] {
            for address in addresses {
                let topic = profile.consume(address).address;
                let _ = writeln!(acl, "topic {kind} {topic}\ntopic {kind} {topic}/replay");
            }
        }
    }
    acl
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;
    use crate::definitions::{Account, QueueLimits};

    fn plan_for(factories: &[&str]) -> BrokerPlan {
        let account =
            |name: &str| Account { user_name: name.to_owned(), password: String::new().into() };
        let factories =
            factories.iter().copied().map(|id| (id.parse().expect("an id"), account(id)));
        BrokerPlan {
            platform: account("platform"),
            factories: factories.collect(),
            tools: vec![("t1".parse().expect("an id"), account("t1"))],
            limits: QueueLimits::default(),
        }
    }

    fn acl_for(factories: &[&str]) -> String {
        mosquitto_acl(&plan_for(factories))
    }

    /// A tree of topics that many read would show each report to all of them.
    #[test]
    fn no_topic_has_two_readers_or_covers_others() {
        let acl = acl_for(&["f1", "f2"]);
        let read: Vec<&str> =
            acl.lines().filter_map(|line| line.strip_prefix("topic read ")).collect();
        assert_eq!(read.iter().collect::<HashSet<_>>().len(), read.len(), "{acl}");
        assert!(read.len() >= 10 && !acl.contains('+'), "{acl}");
        assert!(!read.iter().any(|topic| topic.contains('#')), "{acl}");
    }

    #[test]
    fn a_factory_has_its_own_topics() {
        let acl = acl_for(&["f1"]);
        assert!(acl.contains("#   max_queued_bytes 2147483648\n"), "{acl}");
        assert!(acl.lines().take(10).any(|line| line.contains("use_username_as_clientid true")));
        // The bound is for each client, of which the platform has one for each factory.
        let limits = mosquitto_queue_limits(&plan_for(&["f1", "f2", "f3"]));
        assert!(limits.contains("max_queued_bytes 2147483648\n"), "{limits}");
        let of_f1 = acl.split("user f1\n").nth(1).expect("its part");
        let of_f1 = of_f1.split("\nuser ").next().expect("its lines");
        insta::assert_snapshot!(of_f1, @r"
        topic read verbund/v1/factory/f1/requests
        topic read verbund/v1/factory/f1/requests/replay
        topic read verbund/v1/factory/f1/leases
        topic read verbund/v1/factory/f1/leases/replay
        topic write verbund/v1/factory/f1/ingress
        topic write verbund/v1/factory/f1/ingress/replay
        ");
    }
}
