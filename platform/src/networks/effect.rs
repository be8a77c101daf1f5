//! Effect of a checked revision: what is stored of it, and what each factory is sent.

use std::{collections::HashMap, time::Duration};

use asi_model::{messages::Fault, network::OperationNetwork};

use super::{
    author::Author,
    fault::fault,
    notifications::{network_changed, part_changed},
    outcome::{ChangeError, ChangeOutcome},
    parts::{self, PlannedPart},
    readers,
};
use crate::{
    entitlement,
    store::{NetworkOwners, NetworkRow, NewField, StoreError, Visibility, Work},
};

/// Author and terms of a change.
pub(super) struct Terms<'a> {
    pub(super) author: &'a Author,
    /// Time after which an unanswered part is sent again.
    pub(super) resend_after: Duration,
}

/// Stores the revision, what it asks for, and what each factory is sent of it.
pub(super) async fn take_effect(
    work: &mut Work,
    row: NetworkRow,
    owners: &NetworkOwners,
    terms: &Terms<'_>,
) -> Result<ChangeOutcome, ChangeError> {
    let id = row.network.operation_network_id.clone();
    let before = work.parts().of_network(&id).await?;
    let plan = parts::plan(&row, &before, terms.resend_after);
    let oversize = oversize(&plan, &row.network, owners, terms.author);
    if !oversize.is_empty() {
        return Err(ChangeError::Faulty(oversize));
    }
    let readers = readers::of_change(work, &row, owners).await?;
    store(work, &row, owners).await?;
    work.networks().note_seen(&row, &readers).await?;
    let mut notifications = Vec::new();
    let mut sent_to = Vec::with_capacity(plan.len());
    for planned in plan {
        work.outgoing().add(&planned.message).await?;
        work.parts().put(&planned.part).await?;
        notifications.extend(part_changed(work, &planned.part).await?);
        sent_to.push(planned.part.factory_id);
    }
    notifications.insert(0, network_changed(work, &id, row.revision, &readers).await?);
    tracing::info!(
        operation_network.id = %id, revision = row.revision, author = terms.author.name,
        parts = sent_to.len(), "A network has a new revision."
    );
    let seen = work.parts().seen(&terms.author.scope, &id).await?;
    sent_to.retain(|factory| seen.iter().any(|seen| seen.part.factory_id == *factory));
    Ok(ChangeOutcome { revision: row.revision, is_changed: true, sent_to, notifications })
}

async fn store(
    work: &mut Work,
    row: &NetworkRow,
    owners: &NetworkOwners,
) -> Result<(), StoreError> {
    let id = &row.network.operation_network_id;
    entitlement::prepare_revision(work, row).await?;
    work.networks().put(row).await?;
    work.ownership().put(&row.network, owners).await?;
    if row.withdrawn_at.is_some() {
        return work.fields().replace(id, &[]).await;
    }
    work.fields().replace(id, &fields(&row.network)).await?;
    for (_, _, request) in row.network.requests() {
        work.recipients().replace(id, request).await?;
        work.tools().publish(id, request).await?;
    }
    Ok(())
}

/// Faults of parts that are too large for a broker; of factories that the author does not see, only
/// that it does not fit.
fn oversize(
    plan: &[PlannedPart],
    network: &OperationNetwork,
    owners: &NetworkOwners,
    author: &Author,
) -> Vec<Fault> {
    let visibility = Visibility::new(network, owners, &author.scope);
    let seen = visibility.factories();
    plan.iter()
        .filter_map(|planned| {
            let found = planned.oversize()?;
            let message = "This makes the part of a factory that is not shown to you too large.";
            Some(match seen.contains(&planned.part.factory_id) {
                true => found,
                false => fault(found.pointer, "TOO_LARGE", message.to_owned()),
            })
        })
        .collect()
}

fn fields(network: &OperationNetwork) -> Vec<NewField> {
    let owners: HashMap<_, _> = network
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
