//! Access control for Mosquitto (`acl_file`). Passwords belong into its own password file
//! (`mosquitto_passwd`).

use std::fmt::Write;

use super::BrokerPlan;
use crate::profile::BrokerProfile;

/// The access control list: each user reads and writes its own topics, and nothing else.
///
/// Mosquitto stores its queue only now and then: `persistence true`, `autosave_interval 1`,
/// `autosave_on_changes true` and `max_queued_messages 0` belong beside this, and the receipts make
/// good for what a crash still loses.
#[must_use]
pub fn mosquitto_acl(plan: &BrokerPlan) -> String {
    let profile = BrokerProfile::mqtt();
    let mut acl = String::from("# Generated. Without a user nothing is permitted.\n");
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
    use super::*;
    use crate::definitions::{Account, QueueLimits};

    #[test]
    fn a_factory_has_its_own_topics() {
        let account =
            |name: &str| Account { user_name: name.to_owned(), password: String::new().into() };
        let plan = BrokerPlan {
            platform: account("platform"),
            factories: vec![("f1".parse().expect("an id"), account("f1"))],
            tools: Vec::new(),
            limits: QueueLimits::default(),
        };
        let acl = mosquitto_acl(&plan);
        let of_f1 = acl.split("user f1\n").nth(1).expect("its part");
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
