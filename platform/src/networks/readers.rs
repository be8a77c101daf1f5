//! Readers of a revision: the organisations that see a difference to the one before. For all others
//! nothing has happened.

use std::collections::BTreeSet;

use asi_model::OrganisationId;

use crate::store::{NetworkOwners, NetworkRow, Scope, StoreError, Visibility, Work, viewers};

/// Returns the organisations that see a difference between the revision in force and a new one that
/// is about to replace it, be they members of the collaboration at present or not.
///
/// # Errors
/// [`StoreError`].
pub(super) async fn of_change(
    work: &mut Work,
    new: &NetworkRow,
    owners: &NetworkOwners,
) -> Result<BTreeSet<OrganisationId>, StoreError> {
    let id = &new.network.operation_network_id;
    let mut readers = all(new, owners);
    let Some(former) = work.networks().lookup(&Scope::Platform, id).await? else {
        return Ok(readers);
    };
    let former_owners = work.networks().owners(&former).await?;
    readers.extend(all(&former, &former_owners));
    if former.withdrawn_at == new.withdrawn_at {
        readers.retain(|reader| {
            Visibility::of(&former.network, &former_owners, reader).project()
                != Visibility::of(&new.network, owners, reader).project()
        });
    }
    Ok(readers)
}

fn all(row: &NetworkRow, owners: &NetworkOwners) -> BTreeSet<OrganisationId> {
    let viewers = viewers(&row.network, owners).into_iter().map(|(organisation, _)| organisation);
    viewers.chain(owners.drawn_by.clone()).collect()
}
