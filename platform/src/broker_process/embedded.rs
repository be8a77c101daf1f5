//! The embedded broker, wherever it runs.

use std::{collections::HashMap, net::SocketAddr};

use broker::{
    BrokerDeadLetter, BrokerError, BrokerHandle, BrokerUser, ConnectionStatus, DiskState,
    QueueName, QueueOptions, QueueStatus,
};

use super::{
    supervisor::BrokerProcessHandle,
    wire::{Answer, BrokerRequest},
};

/// Handle to the embedded broker; clones share it.
#[derive(Clone)]
pub enum EmbeddedBroker {
    /// In this process.
    Here(BrokerHandle),
    /// In a process of its own.
    Process(BrokerProcessHandle),
}

/// The embedded broker did not do what it was told to.
#[derive(Debug, thiserror::Error)]
pub enum EmbeddedBrokerError {
    #[error(transparent)]
    Broker(#[from] BrokerError),
    /// The broker has failed, and is started again.
    #[error("the broker is away at the moment")]
    Away,
    #[error("the broker failed: {reason}")]
    Failed { reason: String },
}

impl EmbeddedBroker {
    /// Returns the addresses of the listeners, with the real ports.
    #[must_use]
    pub fn addresses(&self) -> &[SocketAddr] {
        match self {
            Self::Here(broker) => broker.local_addresses(),
            Self::Process(process) => process.addresses(),
        }
    }

    /// Replaces the users of a process. A broker in this process reads the table of users itself.
    pub async fn set_users(&self, users: &HashMap<String, BrokerUser>) {
        if let Self::Process(process) = self {
            process.set_users(users).await;
        }
    }

    /// Creates a queue, or changes the bounds of an existing one; as soon as there is a process.
    ///
    /// # Errors
    /// [`EmbeddedBrokerError`].
    pub async fn declare_queue(
        &self,
        queue: &QueueName,
        options: QueueOptions,
    ) -> Result<(), EmbeddedBrokerError> {
        match self {
            Self::Here(broker) => Ok(broker.declare_queue(queue, options).await?),
            Self::Process(process) => match process.declare_queue(queue, options).await {
                Answer::Failed(reason) => Err(EmbeddedBrokerError::Failed { reason }),
                _ => Ok(()),
            },
        }
    }

    /// Deletes a queue with its messages, if it is there; as soon as there is a process. Returns the
    /// number of the messages, as far as it is known.
    ///
    /// # Errors
    /// [`EmbeddedBrokerError`].
    pub async fn delete_queue(&self, queue: &QueueName) -> Result<u64, EmbeddedBrokerError> {
        match self {
            Self::Here(broker) => match broker.delete_queue(queue).await {
                Err(BrokerError::UnknownQueue { .. }) => Ok(0),
                deleted => Ok(deleted?),
            },
            Self::Process(process) => match process.delete_queue(queue).await {
                Some(Answer::Failed(reason)) => Err(EmbeddedBrokerError::Failed { reason }),
                Some(Answer::Count(messages)) => Ok(messages),
                _ => Ok(0),
            },
        }
    }

    /// Closes all connections of a user; returns their number.
    pub async fn disconnect_user(&self, user_name: &str) -> usize {
        match self {
            Self::Here(broker) => broker.disconnect_user(user_name),
            Self::Process(process) => {
                let request = BrokerRequest::Disconnect { user_name: user_name.to_owned() };
                match process.ask(request).await {
                    Some(Answer::Count(count)) => usize::try_from(count).unwrap_or(usize::MAX),
                    _ => 0,
                }
            }
        }
    }

    /// Returns the status of all queues; none while the broker is away.
    pub async fn queues(&self) -> Option<Vec<QueueStatus>> {
        match self {
            Self::Here(broker) => Some(broker.queues()),
            Self::Process(process) => match process.ask(BrokerRequest::Queues).await {
                Some(Answer::Queues(queues)) => Some(queues),
                _ => None,
            },
        }
    }

    /// Returns all connections, oldest first; none while the broker is away.
    pub async fn connections(&self) -> Option<Vec<ConnectionStatus>> {
        match self {
            Self::Here(broker) => Some(broker.connections()),
            Self::Process(process) => match process.ask(BrokerRequest::Connections).await {
                Some(Answer::Connections(connections)) => Some(connections),
                _ => None,
            },
        }
    }

    /// Returns how much room is on its disk; none while the broker is away.
    pub async fn disk(&self) -> Option<DiskState> {
        match self {
            Self::Here(broker) => Some(broker.disk()),
            Self::Process(process) => match process.ask(BrokerRequest::Disk).await {
                Some(Answer::Disk(state)) => Some(state),
                _ => None,
            },
        }
    }

    /// Returns at most `limit` dead letters with ids above `after`, oldest first.
    ///
    /// # Errors
    /// [`EmbeddedBrokerError`].
    pub async fn dead_letters(
        &self,
        after: i64,
        limit: u32,
    ) -> Result<Vec<BrokerDeadLetter>, EmbeddedBrokerError> {
        match self {
            Self::Here(broker) => Ok(broker.dead_letters(after, limit).await?),
            Self::Process(process) => {
                match process.ask(BrokerRequest::DeadLetters { after, limit }).await {
                    Some(Answer::DeadLetters(letters)) => Ok(letters),
                    other => Err(failure(other)),
                }
            }
        }
    }

    /// Appends dead letters to their former queues; returns their number.
    ///
    /// # Errors
    /// [`EmbeddedBrokerError`].
    pub async fn replay_dead_letters(&self, ids: &[i64]) -> Result<u64, EmbeddedBrokerError> {
        match self {
            Self::Here(broker) => Ok(broker.replay_dead_letters(ids).await?),
            Self::Process(process) => {
                match process.ask(BrokerRequest::ReplayDeadLetters { ids: ids.to_vec() }).await {
                    Some(Answer::Count(count)) => Ok(count),
                    other => Err(failure(other)),
                }
            }
        }
    }
}

fn failure(answer: Option<Answer>) -> EmbeddedBrokerError {
    match answer {
        Some(Answer::Failed(reason)) => EmbeddedBrokerError::Failed { reason },
        _ => EmbeddedBrokerError::Away,
    }
}
