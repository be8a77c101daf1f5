//! Lines between the platform and the process of its broker.

use std::{collections::HashMap, net::SocketAddr, path::PathBuf};

use broker::{
    AddressPattern, BrokerConfig, BrokerDeadLetter, BrokerUser, Carrier, ConnectionStatus,
    DiskGauge, DiskState, Listener, QueueName, QueueOptions, QueueStatus, SecretHash, TlsIdentity,
};
use daemon::telemetry::LogConfig;
use serde::{Deserialize, Serialize};

use crate::disk;

/// First line to the process: what it needs to serve.
#[derive(Clone, Serialize, Deserialize)]
pub struct Setup {
    pub listeners: Vec<ListenerSetup>,
    /// Certificate chain of the encrypted listeners.
    pub certificates_pem: String,
    pub key_pem: String,
    pub database_path: PathBuf,
    pub log: LogConfig,
    /// Users of the start, with what they may.
    pub(super) users: Vec<UserSetup>,
}

/// An address for the process to listen on.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub struct ListenerSetup {
    pub address: SocketAddr,
    pub is_encrypted: bool,
    pub is_websocket: bool,
}

/// A user of the broker. Has hashes of secrets, never secrets.
#[derive(Clone, Serialize, Deserialize)]
pub(super) struct UserSetup {
    pub name: String,
    secrets: Vec<[u8; 32]>,
    consume: Vec<AddressPattern>,
    produce: Vec<AddressPattern>,
    organisation: Option<String>,
    is_owner: bool,
}

/// A request with the number of its answer.
#[derive(Serialize, Deserialize)]
pub(super) struct Order {
    pub id: u64,
    pub request: BrokerRequest,
}

#[derive(Serialize, Deserialize)]
pub(super) enum BrokerRequest {
    /// Replace all users.
    SetUsers(Vec<UserSetup>),
    DeclareQueue {
        queue: QueueName,
        options: QueueOptions,
    },
    /// Delete a queue with its messages; one that is not there is deleted already.
    DeleteQueue {
        queue: QueueName,
    },
    /// Close the connections of a user.
    Disconnect {
        user_name: String,
    },
    Queues,
    Connections,
    Disk,
    DeadLetters {
        after: i64,
        limit: u32,
    },
    ReplayDeadLetters {
        ids: Vec<i64>,
    },
    /// Render the metrics of the process.
    Metrics,
    /// Close all connections and end.
    Stop,
}

/// A line from the process.
#[derive(Serialize, Deserialize)]
pub(super) enum Line {
    /// First line: the addresses with their real ports.
    Listening(Vec<SocketAddr>),
    Answer {
        id: u64,
        answer: Answer,
    },
}

#[derive(Serialize, Deserialize)]
pub(super) enum Answer {
    Done,
    Count(u64),
    Queues(Vec<QueueStatus>),
    Connections(Vec<ConnectionStatus>),
    Disk(DiskState),
    DeadLetters(Vec<BrokerDeadLetter>),
    Metrics(String),
    /// The broker could not do it; a sentence for people.
    Failed(String),
}

impl Setup {
    /// Returns a setup without users.
    #[must_use]
    pub fn new(config: &BrokerConfig, log: LogConfig) -> Self {
        let listeners = config.listeners.iter().map(|listener| ListenerSetup {
            address: listener.address,
            is_encrypted: listener.tls.is_some(),
            is_websocket: listener.carrier == Carrier::WebSocket,
        });
        let tls = config.listeners.iter().find_map(|listener| listener.tls.as_ref());
        let pem = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        Self {
            listeners: listeners.collect(),
            certificates_pem: tls.map(|tls| pem(&tls.certificates_pem)).unwrap_or_default(),
            key_pem: tls.map(|tls| pem(&tls.key_pem)).unwrap_or_default(),
            database_path: config.database_path.clone(),
            log,
            users: Vec::new(),
        }
    }

    /// Returns the broker's configuration; none without a listener.
    pub(super) fn broker_config(&self) -> Option<BrokerConfig> {
        let tls = TlsIdentity {
            certificates_pem: self.certificates_pem.clone().into(),
            key_pem: self.key_pem.clone().into(),
        };
        let mut listeners = self.listeners.iter().map(|setup| Listener {
            address: setup.address,
            tls: setup.is_encrypted.then(|| tls.clone()),
            carrier: if setup.is_websocket { Carrier::WebSocket } else { Carrier::Stream },
        });
        let mut config = BrokerConfig::new(listeners.next()?, &self.database_path);
        config.listeners.extend(listeners);
        config.disk = DiskGauge::new(disk::space_of);
        Some(config)
    }
}

/// Converts users for the wire, in the order of their names.
pub(super) fn to_wire(users: &HashMap<String, BrokerUser>) -> Vec<UserSetup> {
    let mut all: Vec<_> = users
        .iter()
        .map(|(name, user)| UserSetup {
            name: name.clone(),
            secrets: user.secrets.iter().map(|hash| *hash.as_bytes()).collect(),
            consume: user.permissions.consume.clone(),
            produce: user.permissions.produce.clone(),
            organisation: user.organisation.clone(),
            is_owner: user.is_owner,
        })
        .collect();
    all.sort_by(|a, b| a.name.cmp(&b.name));
    all
}

/// Converts users from the wire.
pub(super) fn from_wire(users: Vec<UserSetup>) -> HashMap<String, BrokerUser> {
    users
        .into_iter()
        .map(|setup| {
            let secrets = setup.secrets.into_iter().map(SecretHash::from_bytes).collect();
            let UserSetup { organisation, is_owner, .. } = setup;
            let mut user = BrokerUser { secrets, organisation, is_owner, ..BrokerUser::default() };
            user.permissions.consume = setup.consume;
            user.permissions.produce = setup.produce;
            (setup.name, user)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_broker_in_a_process_of_its_own_looks_at_its_disk() {
        let folder = tempfile::tempdir().expect("a folder");
        let listener =
            Listener { address: ([127, 0, 0, 1], 0).into(), tls: None, carrier: Carrier::Stream };
        let here = BrokerConfig::new(listener, folder.path().join("broker.db"));
        let setup = Setup::new(&here, LogConfig::default());
        let there = setup.broker_config().expect("a listener");
        assert!(there.disk.space_of(folder.path()).is_some());
    }

    #[test]
    fn users_survive_the_wire_and_their_secrets_are_not_on_it() {
        let user = BrokerUser::with_secret(b"a-secret-of-much-entropy")
            .may_consume("factory.A.requests".parse().expect("a pattern"))
            .may_produce("factory.A.ingress".parse().expect("a pattern"))
            .of_organisation("a");
        let users = HashMap::from([("factory.A".to_owned(), user)]);
        let line = serde_json::to_string(&to_wire(&users)).expect("a line");
        assert!(!line.contains("a-secret") && !line.contains('\n'), "{line}");
        let read = from_wire(serde_json::from_str(&line).expect("users"));
        let (sent, read) = (&users["factory.A"], &read["factory.A"]);
        assert_eq!((&sent.secrets, &sent.permissions), (&read.secrets, &read.permissions));
        assert_eq!((read.organisation.as_deref(), read.is_owner), (Some("a"), false));
    }
}
