//! Links: authorisation of an attach, and the two directions of a link.

mod dispatch;
mod ingest;

use std::sync::Arc;

use fe2o3_amqp::types::{
    definitions::{self, AmqpError, Role},
    messaging::TargetArchetype,
    performatives::Attach,
};

use crate::{
    address::QueueName, amqp_error::amqp_error, core::Core, error::BrokerError, queue::Queue,
};

pub(crate) use dispatch::dispatch;
pub(crate) use ingest::{Publisher, ingest};

/// Authorises an attach and returns its queue, created if the configuration says so. The error is
/// the one to detach the link with.
pub(crate) async fn authorise(
    core: &Core,
    user_name: &str,
    attach: &Attach,
) -> Result<Arc<Queue>, definitions::Error> {
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
        return Err(amqp_error(
            AmqpError::NotImplemented,
            "links without an address and dynamic nodes are not offered",
        ));
    };
    let unauthorized = || {
        amqp_error(
            AmqpError::UnauthorizedAccess,
            format!("{user_name} may not use {address} this way"),
        )
    };
    // An invalid name is answered like a forbidden one, so that names cannot be probed.
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
        return Ok(queue);
    }
    if !core.config.auto_created.iter().any(|pattern| pattern.matches(&queue)) {
        return Err(amqp_error(AmqpError::NotFound, format!("there is no queue {queue}")));
    }
    match core.queue_or_declare(&queue, core.config.queue_options).await {
        Ok(queue) => Ok(queue),
        Err(problem @ BrokerError::TooManyQueues { .. }) => {
            Err(amqp_error(AmqpError::ResourceLimitExceeded, problem.to_string()))
        }
        Err(problem) => {
            tracing::error!(error = %problem, %queue, "a queue could not be created");
            Err(amqp_error(AmqpError::InternalError, "the queue could not be created"))
        }
    }
}
