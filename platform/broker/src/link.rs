//! What a link may do, and the two directions of doing it.

mod dispatch;
mod ingest;

use std::sync::Arc;

use fe2o3_amqp::types::{
    definitions::{self, AmqpError, Role},
    messaging::TargetArchetype,
    performatives::Attach,
};

use crate::{address::QueueName, connection::error, core::Core, error::BrokerError, queue::Queue};

pub(crate) use dispatch::dispatch;
pub(crate) use ingest::ingest;

/// A permitted link.
pub(crate) struct Grant {
    pub queue: Arc<Queue>,
}

/// Decides on an attach: whether the address is a queue, and whether the user may use it.
pub(crate) async fn grant(
    core: &Core,
    user_name: &str,
    attach: &Attach,
) -> Result<Grant, definitions::Error> {
    // The peer's role: its sender is our receiver.
    let is_producing = matches!(attach.role, Role::Sender);
    let address = if is_producing {
        attach.target.as_ref().and_then(|target| match &**target {
            TargetArchetype::Target(target) => target.address.clone(),
            #[allow(unreachable_patterns)]
            _ => None,
        })
    } else {
        attach.source.as_ref().and_then(|source| source.address.clone())
    };
    let Some(address) = address else {
        return Err(error(
            AmqpError::NotImplemented,
            "links without an address and dynamic nodes are not offered",
        ));
    };
    let unauthorized = || {
        error(AmqpError::UnauthorizedAccess, format!("{user_name} may not use {address} this way"))
    };
    // A name that is none is answered like a forbidden one.
    let queue: QueueName = address.parse().map_err(|_| unauthorized())?;
    let user = core.credentials.user(user_name).ok_or_else(unauthorized)?;
    let is_permitted = if is_producing {
        user.permissions.permits_producing(&queue)
    } else {
        user.permissions.permits_consuming(&queue)
    };
    if !is_permitted {
        return Err(unauthorized());
    }
    if let Some(queue) = core.queue(&queue) {
        return Ok(Grant { queue });
    }
    if !core.config.auto_created.iter().any(|pattern| pattern.matches(&queue)) {
        return Err(error(AmqpError::NotFound, format!("there is no queue {queue}")));
    }
    match core.queue_or_declare(&queue, core.config.queue_options).await {
        Ok(queue) => Ok(Grant { queue }),
        Err(problem @ BrokerError::TooManyQueues { .. }) => {
            Err(error(AmqpError::ResourceLimitExceeded, problem.to_string()))
        }
        Err(problem) => {
            tracing::error!(error = %problem, %queue, "a queue could not be made");
            Err(error(AmqpError::InternalError, "the queue could not be made"))
        }
    }
}
