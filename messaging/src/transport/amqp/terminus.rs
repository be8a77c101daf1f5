//! Names and capabilities of AMQP links, the same for senders and receivers.

use fe2o3_amqp::types::primitives::{Array, Symbol};

use crate::profile::Terminus;

/// Returns a link name that is unique per attempt: a broker may still have a link of the same name
/// from a connection that was given up.
pub(super) fn link_name(direction: &str, terminus: &Terminus) -> String {
    format!("{direction} {} {}", terminus.address, uuid::Uuid::new_v4().simple())
}

/// Returns the capabilities by which some brokers tell queues from topics.
pub(super) fn capabilities(terminus: &Terminus) -> Option<Array<Symbol>> {
    terminus
        .capability
        .as_ref()
        .map(|capability| Array::from(vec![Symbol::from(capability.as_str())]))
}
