//! New revisions and withdrawals.

use std::time::Duration;

use asi_model::{
    CollaborationId, FactoryId, OperationNetworkId, OrganisationId, messages::Fault,
    network::OperationNetwork,
};

use super::{author::Author, faults::faults, parts};
use crate::{
    live::{LiveEvent, Notification},
    store::{Collaboration, NetworkRow, NewField, PartState, Scope, StoreError, Work},
};

/// A whole network to put in place of what is there.
#[derive(Debug, Clone)]
pub struct PutNetwork {
    /// The collaboration it belongs to.
    pub collaboration_id: CollaborationId,
    /// The network, each operation with its owner.
    pub network: OperationNetwork,
    /// The only revision to replace (`If-Match`); 0 where there must be none.
    pub expected_revision: Option<u64>,
}

/// Result of a change.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// The revision in effect.
    pub revision: u64,
    /// False where nothing differed and the revision is the old one.
    pub is_changed: bool,
    /// The factories that were sent something.
    pub sent_to: Vec<FactoryId>,
    /// Notifications to publish after the commit.
    pub notifications: Vec<Notification>,
}

/// Rejection of a change.
#[derive(Debug, thiserror::Error)]
pub enum ChangeError {
    /// The author does not know such a collaboration.
    #[error("there is no collaboration {0}")]
    NoCollaboration(CollaborationId),
    /// The author does not know such a network, operation or request.
    #[error("there is no {0}")]
    NotFound(String),
    /// The author only looks on.
    #[error("a viewer changes nothing")]
    NotAllowed,
    /// The network belongs to another collaboration.
    #[error("the network belongs to another collaboration")]
    OtherCollaboration,
    /// Another change came first.
    #[error("the revision in effect is {revision}")]
    RevisionConflict {
        /// The revision in effect.
        revision: u64,
    },
    /// The network is wrong.
    #[error("the network has {} faults", .0.len())]
    Faulty(Vec<Fault>),
    /// The store failed.
    #[error("the store failed")]
    Store(#[from] StoreError),
}

/// Puts a whole network in place. The same network again changes nothing.
///
/// # Errors
/// [`ChangeError`]; then nothing of it happened once the work is dropped.
pub async fn put(
    work: &mut Work,
    change: PutNetwork,
    author: &Author,
    resend_after: Duration,
) -> Result<Outcome, ChangeError> {
    if !author.may_plan {
        return Err(ChangeError::NotAllowed);
    }
    let collaboration = work
        .collaborations()
        .lookup(&author.scope, &change.collaboration_id)
        .await?
        .ok_or_else(|| ChangeError::NoCollaboration(change.collaboration_id.clone()))?;
    let before =
        work.networks().lookup(&Scope::Platform, &change.network.operation_network_id).await?;
    if before.as_ref().is_some_and(|before| before.collaboration_id != change.collaboration_id) {
        return Err(ChangeError::OtherCollaboration);
    }
    let revision = before.as_ref().map_or(0, |before| before.revision);
    if change.expected_revision.is_some_and(|expected| expected != revision) {
        return Err(ChangeError::RevisionConflict { revision });
    }
    let in_effect = before.as_ref().filter(|before| before.withdrawn_at.is_none());
    if in_effect.is_some_and(|before| before.network == change.network) {
        return Ok(Outcome {
            revision,
            is_changed: false,
            sent_to: Vec::new(),
            notifications: Vec::new(),
        });
    }
    let faults = faults(&change.network, in_effect.map(|row| &row.network), &collaboration, author);
    if !faults.is_empty() {
        return Err(ChangeError::Faulty(faults));
    }
    let row = NetworkRow {
        collaboration_id: change.collaboration_id,
        revision: revision + 1,
        network: change.network,
        updated_at: author.now,
        updated_by: author.name.clone(),
        withdrawn_at: None,
    };
    take_effect(work, row, &collaboration, author, resend_after).await
}

/// Withdraws a network: at every factory its nodes and mappings go; the revision stays as a
/// tombstone.
///
/// # Errors
/// [`ChangeError`]; then nothing of it happened once the work is dropped.
pub async fn withdraw(
    work: &mut Work,
    id: &OperationNetworkId,
    author: &Author,
    resend_after: Duration,
) -> Result<Outcome, ChangeError> {
    let (before, collaboration) = lookup(work, id, author).await?;
    if before.withdrawn_at.is_some() {
        return Ok(Outcome {
            revision: before.revision,
            is_changed: false,
            sent_to: Vec::new(),
            notifications: Vec::new(),
        });
    }
    let row = NetworkRow {
        revision: before.revision + 1,
        updated_at: author.now,
        updated_by: author.name.clone(),
        withdrawn_at: Some(author.now),
        ..before
    };
    take_effect(work, row, &collaboration, author, resend_after).await
}

/// Returns a network that the author may change, with its collaboration.
pub(super) async fn lookup(
    work: &mut Work,
    id: &OperationNetworkId,
    author: &Author,
) -> Result<(NetworkRow, Collaboration), ChangeError> {
    let not_found = || ChangeError::NotFound(format!("operation network {id}"));
    let before = work.networks().lookup(&author.scope, id).await?.ok_or_else(not_found)?;
    if !author.may_plan {
        return Err(ChangeError::NotAllowed);
    }
    let collaboration = work
        .collaborations()
        .lookup(&author.scope, &before.collaboration_id)
        .await?
        .ok_or_else(not_found)?;
    Ok((before, collaboration))
}

/// Stores the revision, what it asks for, and what each factory is sent of it.
async fn take_effect(
    work: &mut Work,
    row: NetworkRow,
    collaboration: &Collaboration,
    author: &Author,
    resend_after: Duration,
) -> Result<Outcome, ChangeError> {
    let id = row.network.operation_network_id.clone();
    work.networks().put(&row).await?;
    let is_withdrawn = row.withdrawn_at.is_some();
    work.fields()
        .replace(&id, &if is_withdrawn { Vec::new() } else { fields(&row.network) })
        .await?;
    if !is_withdrawn {
        for (_, _, request) in row.network.requests() {
            work.recipients().replace(&id, request).await?;
            work.tools().publish(&id, request).await?;
        }
    }
    let before = work.parts().of_network(&id).await?;
    let plan = parts::plan(&row, &before, resend_after);
    let oversize: Vec<Fault> = plan.iter().filter_map(parts::PlannedPart::oversize).collect();
    if !oversize.is_empty() {
        return Err(ChangeError::Faulty(oversize));
    }
    let members = &collaboration.members;
    let mut notifications = vec![
        LiveEvent::Network { operation_network_id: id.clone(), revision: row.revision }
            .to(members.clone()),
    ];
    let mut sent_to = Vec::with_capacity(plan.len());
    for planned in plan {
        work.outgoing().add(&planned.message).await?;
        work.parts().put(&planned.part).await?;
        sent_to.push(planned.part.factory_id.clone());
        notifications.push(part_notification(
            &id,
            &planned.part.factory_id,
            row.revision,
            PartState::Sent,
            members,
        ));
    }
    tracing::info!(
        operation_network.id = %id, revision = row.revision, author = author.name, parts = sent_to.len(),
        "A network has a new revision."
    );
    Ok(Outcome { revision: row.revision, is_changed: true, sent_to, notifications })
}

fn part_notification(
    network: &OperationNetworkId,
    factory: &FactoryId,
    revision: u64,
    state: PartState,
    members: &[OrganisationId],
) -> Notification {
    LiveEvent::Part {
        operation_network_id: network.clone(),
        factory_id: factory.clone(),
        revision,
        state,
        fault_list: Vec::new(),
    }
    .to(members.to_vec())
}

fn fields(network: &OperationNetwork) -> Vec<NewField> {
    let owners: std::collections::HashMap<_, _> = network
        .operation_list
        .iter()
        .filter_map(|operation| {
            Some((&operation.operation_id, operation.owning_factory_id.as_ref()?))
        })
        .collect();
    network
        .fields()
        .enumerate()
        .filter_map(|(position, (key, _, _))| {
            let factory_id = (*owners.get(&key.request.operation_id)?).clone();
            Some(NewField {
                key,
                factory_id,
                position: u32::try_from(position).unwrap_or(u32::MAX),
            })
        })
        .collect()
}
