//! A definitions file for RabbitMQ 3.10 and later (`load_definitions`, or import in its management
//! page).

use base64::{Engine, engine::general_purpose::STANDARD};
use serde_json::{Value, json};
use sha2::{Digest, Sha256};

use super::{BrokerPlan, Rights};
use crate::address::LogicalAddress;

/// The exchange that all messages are written to; the routing key is the logical address.
const EXCHANGE: &str = "verbund";
/// The exchange of messages that no queue is bound for: without it, the broker would accept and drop
/// them.
const UNROUTED: &str = "verbund.unrouted";
/// The exchange of rejected messages.
const DEAD: &str = "verbund.dead";
/// Connections of an account at the same time, as at the embedded broker. RabbitMQ 3 counts those that have a session.
const CONNECTIONS_MAX: u32 = 16;
/// Channels of an account, of which a session has one, and a second one while a link is attached.
const CHANNELS_MAX: u32 = 64;

/// Generates the definitions of one virtual host. `salt` returns four new random bytes per call,
/// for the password hashes.
///
/// Queues are quorum queues with a single active consumer. They keep on disk what was consumed until
/// their common log is rolled over, and what has expired becomes a dead letter. Permissions to write are decided by the
/// routing key, so the users need none on any other exchange; in particular none on the default
/// exchange, which reaches every queue. Connections of an account are bounded, but for the platform's, which has links
/// for all.
#[must_use]
pub fn rabbitmq_definitions(
    plan: &BrokerPlan,
    virtual_host: &str,
    mut salt: impl FnMut() -> [u8; 4],
) -> Value {
    let addresses = plan.queues();
    let names: Vec<String> = addresses.iter().map(ToString::to_string).collect();
    let mut queues: Vec<Value> =
        addresses.iter().map(|address| queue(plan, virtual_host, address)).collect();
    let dead_letters = LogicalAddress::DeadLetters.to_string();
    queues.push(json!({
        "name": dead_letters, "vhost": virtual_host, "durable": true, "auto_delete": false,
        "arguments": { "x-queue-type": "quorum", "x-max-length-bytes": plan.limits.bytes_max },
    }));
    let mut bindings: Vec<Value> =
        names.iter().map(|name| binding(virtual_host, EXCHANGE, name, name)).collect();
    bindings.extend([UNROUTED, DEAD].map(|from| binding(virtual_host, from, &dead_letters, "")));
    let rights = plan.rights();
    json!({
        "vhosts": [ { "name": virtual_host } ],
        "users": rights.iter().map(|r| {
            let is_platform = r.account.user_name == plan.platform.user_name;
            user(r, salt(), is_platform)
        }).collect::<Vec<_>>(),
        "permissions": rights.iter().map(|r| json!({
            "user": r.account.user_name, "vhost": virtual_host,
            "configure": "^$", "write": format!("^{EXCHANGE}$"), "read": any_of(&r.consume),
        })).collect::<Vec<_>>(),
        "topic_permissions": rights.iter().map(|r| json!({
            "user": r.account.user_name, "vhost": virtual_host, "exchange": EXCHANGE,
            "write": any_of(&r.produce), "read": "^$",
        })).collect::<Vec<_>>(),
        "exchanges": [
            exchange(virtual_host, EXCHANGE, "topic", &json!({ "alternate-exchange": UNROUTED })),
            exchange(virtual_host, UNROUTED, "fanout", &json!({})),
            exchange(virtual_host, DEAD, "fanout", &json!({})),
        ],
        "queues": queues,
        "bindings": bindings,
    })
}

fn queue(plan: &BrokerPlan, virtual_host: &str, address: &LogicalAddress) -> Value {
    json!({
        "name": address.to_string(), "vhost": virtual_host, "durable": true, "auto_delete": false,
        "arguments": {
            "x-queue-type": "quorum",
            "x-single-active-consumer": address.has_single_active_consumer(),
            "x-delivery-limit": plan.limits.deliveries_max,
            "x-dead-letter-exchange": DEAD,
            "x-dead-letter-strategy": "at-least-once",
            "x-max-length-bytes": plan.limits.bytes_max,
            "x-overflow": "reject-publish",
        },
    })
}

fn exchange(virtual_host: &str, name: &str, kind: &str, arguments: &Value) -> Value {
    json!({
        "name": name, "vhost": virtual_host, "type": kind, "durable": true, "auto_delete": false, "internal": false,
        "arguments": arguments,
    })
}

fn binding(virtual_host: &str, source: &str, queue: &str, key: &str) -> Value {
    json!({
        "source": source, "vhost": virtual_host, "destination": queue, "destination_type": "queue",
        "routing_key": key, "arguments": {},
    })
}

/// Returns an account with the hash that RabbitMQ stores: the salt, then SHA-256 over salt and password.
fn user(rights: &Rights<'_>, salt: [u8; 4], is_platform: bool) -> Value {
    let digest = Sha256::new()
        .chain_update(salt)
        .chain_update(rights.account.password.as_bytes())
        .finalize();
    let hash = STANDARD.encode([salt.as_slice(), digest.as_slice()].concat());
    let mut user = json!({
        "name": rights.account.user_name, "password_hash": hash,
        "hashing_algorithm": "rabbit_password_hashing_sha256", "tags": [],
    });
    if !is_platform {
        user["limits"] =
            json!({ "max-connections": CONNECTIONS_MAX, "max-channels": CHANNELS_MAX });
    }
    user
}

/// A regular expression for exactly these addresses.
fn any_of(addresses: &[LogicalAddress]) -> String {
    let names: Vec<_> = addresses.iter().map(|a| a.to_string().replace('.', "\\.")).collect();
    format!("^({})$", names.join("|"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::definitions::{Account, QueueLimits};

    fn account(name: &str) -> Account {
        Account { user_name: name.to_owned(), password: name.to_owned().into() }
    }

    #[test]
    fn a_factory_reads_its_requests_and_writes_its_ingress_only() {
        let plan = BrokerPlan {
            platform: account("platform"),
            factories: vec![("f1".parse().expect("an id"), account("f1"))],
            tools: vec![],
            limits: QueueLimits::default(),
        };
        let definitions = rabbitmq_definitions(&plan, "/", || [0x90, 0x8D, 0xC6, 0x0A]);
        insta::assert_json_snapshot!(definitions["permissions"][1], @r#"
        {
          "user": "f1",
          "vhost": "/",
          "configure": "^$",
          "write": "^verbund$",
          "read": "^(factory\\.f1\\.requests|factory\\.f1\\.leases)$"
        }
        "#);
        insta::assert_json_snapshot!(definitions["topic_permissions"][1], @r#"
        {
          "user": "f1",
          "vhost": "/",
          "exchange": "verbund",
          "write": "^(factory\\.f1\\.ingress)$",
          "read": "^$"
        }
        "#);
        assert_eq!(
            definitions["topic_permissions"][0]["write"],
            "^(factory\\.f1\\.requests|factory\\.f1\\.leases)$"
        );
        assert_eq!(definitions["queues"].as_array().map(Vec::len), Some(4));
        assert_eq!(definitions["users"][1]["limits"]["max-connections"], 16);
        assert!(definitions["users"][0]["limits"].is_null(), "the platform has links for all");
        assert!(!definitions.to_string().contains("\"password\""));
    }

    #[test]
    fn password_hashes_are_those_of_rabbitmq() {
        // The example of RabbitMQ's documentation on password hashing.
        let rights = Rights {
            account: &Account { user_name: "u".into(), password: "test12".to_owned().into() },
            consume: vec![],
            produce: vec![],
        };
        let user = user(&rights, [0x90, 0x8D, 0xC6, 0x0A], false);
        assert_eq!(user["password_hash"], "kI3GCqW5JLMJa4iX1lo7X4D6XbYqlLgxIs30+P6tENUV2POR");
    }
}
