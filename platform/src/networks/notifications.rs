//! Live events about networks, each to those who may read the same by a query.

use std::collections::BTreeSet;

use asi_model::{OperationNetworkId, OrganisationId, messages::Fault};

use crate::{
    live::{LiveEvent, Notification},
    opaque_id::OpaqueId,
    store::{NetworkPart, StoreError, Work},
};

/// Makes the event of a new revision or a withdrawal, for those of the network's readers who see a
/// difference.
///
/// # Errors
/// [`StoreError`].
pub(super) async fn network_changed(
    work: &mut Work,
    id: &OperationNetworkId,
    revision: u64,
    concerned: &BTreeSet<OrganisationId>,
) -> Result<Notification, StoreError> {
    let mut readers = work.ownership().readers(id).await?;
    readers.retain(|reader| concerned.contains(reader));
    let event = LiveEvent::Network { operation_network_id: id.clone(), revision };
    Ok(event.to(readers))
}

/// Makes the events of a stored part: the whole state for its factory, the drawer and
/// administrators, the bare state for others who see an operation of the factory.
///
/// # Errors
/// [`StoreError`].
pub(crate) async fn part_changed(
    work: &mut Work,
    part: &NetworkPart,
) -> Result<Vec<Notification>, StoreError> {
    let (whole, others) =
        work.parts().readers(&part.operation_network_id, &part.factory_id).await?;
    let event = |revision: Option<u64>, fault_list: Vec<Fault>| LiveEvent::Part {
        operation_network_id: part.operation_network_id.clone(),
        factory_id: part.factory_id.clone(),
        revision,
        state: part.state,
        fault_list,
    };
    let mut bare = event(None, Vec::new()).to(others);
    // Administrators are told the whole already.
    bare.is_structure = false;
    Ok(vec![event(Some(part.revision), part.fault_list.clone()).to(whole), bare])
}

/// Makes the event of a stored comment, for those who may read it.
///
/// # Errors
/// [`StoreError`].
pub(crate) async fn comment_added(
    work: &mut Work,
    network: &OperationNetworkId,
    comment: &OpaqueId,
) -> Result<Notification, StoreError> {
    let readers = work.comments().readers(comment).await?;
    let event =
        LiveEvent::Comment { operation_network_id: network.clone(), comment_id: comment.clone() };
    Ok(event.to(readers))
}
