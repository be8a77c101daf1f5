//! New revisions and withdrawals.

use std::{
    collections::{HashMap, HashSet},
    time::Duration,
};

use asi_model::{
    CollaborationId, DynamicDataRequestId, OperationId, OperationNetworkId, OrganisationId,
    network::OperationNetwork,
};
use daemon::web::shares::{ShareOwner, count_refusal};

use super::{
    author::Author,
    effect::{Terms, take_effect},
    faults::{Context, Revision, conflict, faults},
    merge::merge,
    outcome::{ChangeError, ChangeOutcome},
};
use crate::store::{Collaboration, NetworkOwners, NetworkRow, Scope, Visibility, Work};

/// Most networks that an organisation draws; withdrawn ones stay and count.
pub const NETWORKS_PER_ORGANISATION_MAX: usize = 1_000;
/// Most requests of an organisation in one network; the ids of removed ones stay and count.
pub const REQUESTS_PER_NETWORK_MAX: usize = 5_000;

/// A document to put in place of what its author sees of a network.
#[derive(Debug, Clone)]
pub struct PutNetwork {
    /// The collaboration it belongs to.
    pub collaboration_id: CollaborationId,
    /// The network as its author sees it, each operation with its owner.
    pub network: OperationNetwork,
    /// The only revision to replace (`If-Match`); 0 where there must be none.
    pub expected_revision: Option<u64>,
}

/// Puts a document in place of what its author sees of the network; what is hidden stays. The same
/// document again changes nothing.
///
/// # Errors
/// [`ChangeError`]; then nothing of it happened.
pub async fn put(
    work: &mut Work,
    change: PutNetwork,
    author: &Author,
    resend_after: Duration,
) -> Result<ChangeOutcome, ChangeError> {
    if !author.may_plan {
        return Err(ChangeError::NotAllowed);
    }
    let collaboration = work
        .collaborations()
        .lookup(&author.scope, &change.collaboration_id)
        .await?
        .ok_or_else(|| ChangeError::NoCollaboration(change.collaboration_id.clone()))?;
    let terms = Terms { author, resend_after };
    let id = &change.network.operation_network_id;
    let before = work.networks().lookup(&Scope::Platform, id).await?;
    let shown = work.networks().lookup(&author.scope, id).await?;
    if shown.is_none() && is_reserved_for_another(id, author) {
        return Err(ChangeError::Reserved);
    }
    if before.is_some() && shown.is_none() {
        return Err(ChangeError::Taken);
    }
    if before.as_ref().is_some_and(|before| before.collaboration_id != change.collaboration_id) {
        return Err(ChangeError::OtherCollaboration);
    }
    // What the author does not see may have changed since; that is merged.
    let revision = shown.as_ref().map_or(0, |shown| shown.revision);
    if change.expected_revision.is_some_and(|expected| expected != revision) {
        return Err(ChangeError::RevisionConflict { revision });
    }
    match (before, shown) {
        (Some(before), Some(shown)) if before.withdrawn_at.is_none() => {
            if shown.network == change.network {
                return Ok(ChangeOutcome::unchanged(revision));
            }
            revise(work, before, &shown, change.network, &collaboration, &terms).await
        }
        (before, _) => draw(work, change.network, before, &collaboration, &terms).await,
    }
}

/// Returns true for an id that ends in `@` and an organisation which is not the author's: such ids are for
/// that organisation alone, so that nobody takes them in advance or learns by trying which are in use.
/// Whether there is such a network or organisation makes no difference.
fn is_reserved_for_another(id: &OperationNetworkId, author: &Author) -> bool {
    let owner = id.as_str().rsplit_once('@').and_then(|(_, owner)| owner.parse().ok());
    let owner: Option<OrganisationId> = owner;
    !author.is_administrator && owner.is_some() && owner != author.organisation_id
}

/// Draws a network where there is none in force. A withdrawn one stays with its owner.
async fn draw(
    work: &mut Work,
    document: OperationNetwork,
    withdrawn: Option<NetworkRow>,
    collaboration: &Collaboration,
    terms: &Terms<'_>,
) -> Result<ChangeOutcome, ChangeError> {
    let author = terms.author;
    let (revision, drawn_by) = match withdrawn {
        Some(row) if !author.owns(&row) => return Err(ChangeError::NotAllowed),
        Some(row) => (row.revision, row.drawn_by),
        None => {
            check_networks(work, author).await?;
            (0, author.organisation_id.clone())
        }
    };
    let row = NetworkRow {
        collaboration_id: collaboration.collaboration_id.clone(),
        revision: revision + 1,
        network: document,
        updated_at: author.now,
        updated_by: author.name.clone(),
        author_organisation: author.organisation_id.clone(),
        withdrawn_at: None,
        drawn_by,
    };
    let mut owners = work.networks().owners(&row).await?;
    owners.drawers.clear();
    check(work, &row.network, None, &owners, collaboration, author).await?;
    add_drawers(&mut owners, &row.network, None, author);
    take_effect(work, row, &owners, terms).await
}

/// Replaces what the author sees of the revision in force.
async fn revise(
    work: &mut Work,
    before: NetworkRow,
    shown: &NetworkRow,
    document: OperationNetwork,
    collaboration: &Collaboration,
    terms: &Terms<'_>,
) -> Result<ChangeOutcome, ChangeError> {
    let author = terms.author;
    let mut owners = work.networks().owners(&before).await?;
    let revision = Revision { whole: &before.network, shown: &shown.network };
    check(work, &document, Some(&revision), &owners, collaboration, author).await?;
    let visibility = Visibility::new(&before.network, &owners, &author.scope);
    let organisation = author.organisation_id.as_ref();
    let performs = |operation: &_| {
        author.is_administrator
            || (organisation.is_some() && owners.performer(operation) == organisation)
    };
    let merged = merge(&before.network, &visibility, performs, author.owns(&before), &document);
    if merged == before.network {
        return Ok(ChangeOutcome::unchanged(shown.revision));
    }
    if shown.network != before.network
        && let Some(fault) = conflict(&merged)
    {
        return Err(ChangeError::Faulty(vec![fault]));
    }
    add_drawers(&mut owners, &merged, Some(&before.network), author);
    let row = NetworkRow {
        revision: before.revision + 1,
        network: merged,
        updated_at: author.now,
        updated_by: author.name.clone(),
        author_organisation: author.organisation_id.clone(),
        ..before
    };
    take_effect(work, row, &owners, terms).await
}

async fn check(
    work: &mut Work,
    document: &OperationNetwork,
    revision: Option<&Revision<'_>>,
    owners: &NetworkOwners,
    collaboration: &Collaboration,
    author: &Author,
) -> Result<(), ChangeError> {
    let requesters = work.ownership().requesters(&document.operation_network_id).await?;
    check_requests(document, &requesters, author)?;
    let context = Context { collaboration, owners, requesters: &requesters, author };
    let faults = faults(document, revision, &context);
    if faults.is_empty() { Ok(()) } else { Err(ChangeError::Faulty(faults)) }
}

/// Checks that the author's organisation may draw one more network.
async fn check_networks(work: &mut Work, author: &Author) -> Result<(), ChangeError> {
    let Some(organisation) = &author.organisation_id else { return Ok(()) };
    let drawn = work.quotas().networks(organisation).await?;
    let limit = NETWORKS_PER_ORGANISATION_MAX;
    if usize::try_from(drawn).is_ok_and(|drawn| drawn < limit) {
        return Ok(());
    }
    count_refusal("networks", ShareOwner::Organisation(organisation.as_str()));
    Err(ChangeError::QuotaExceeded { quota: "networks, withdrawn ones included", limit })
}

/// Checks that the author's organisation uses no more request ids in a network than it may, those of
/// removed requests included: these stay its own.
fn check_requests(
    document: &OperationNetwork,
    requesters: &HashMap<DynamicDataRequestId, OrganisationId>,
    author: &Author,
) -> Result<(), ChangeError> {
    let Some(organisation) = &author.organisation_id else { return Ok(()) };
    let used = requesters.values().filter(|requester| *requester == organisation).count();
    let new = document.requests().filter(|(key, _, request)| {
        request.requester_id == *organisation
            && !requesters.contains_key(&key.dynamic_data_request_id)
    });
    let (new, limit) = (new.count(), REQUESTS_PER_NETWORK_MAX);
    if new == 0 || used + new <= limit {
        return Ok(());
    }
    count_refusal("requests_of_network", ShareOwner::Organisation(organisation.as_str()));
    let quota = "requests in this network, removed ones included";
    Err(ChangeError::QuotaExceeded { quota, limit })
}

/// Notes the author's organisation as the one that drew the operations that are new.
fn add_drawers(
    owners: &mut NetworkOwners,
    network: &OperationNetwork,
    before: Option<&OperationNetwork>,
    author: &Author,
) {
    let Some(organisation) = &author.organisation_id else { return };
    let known: HashSet<&OperationId> =
        before.iter().flat_map(|n| &n.operation_list).map(|o| &o.operation_id).collect();
    let new =
        network.operation_list.iter().map(|o| &o.operation_id).filter(|id| !known.contains(id));
    owners.drawers.extend(new.map(|id| (id.clone(), organisation.clone())));
}

/// Withdraws a network: at every factory its nodes and mappings go; the revision stays as a
/// tombstone. Only its owner does so.
///
/// # Errors
/// [`ChangeError`]; then nothing of it happened.
pub async fn withdraw(
    work: &mut Work,
    id: &OperationNetworkId,
    author: &Author,
    resend_after: Duration,
) -> Result<ChangeOutcome, ChangeError> {
    let not_found = || ChangeError::NotFound(format!("operation network {id}"));
    let shown = work.networks().lookup(&author.scope, id).await?.ok_or_else(not_found)?;
    let before = work.networks().lookup(&Scope::Platform, id).await?.ok_or_else(not_found)?;
    if !author.may_plan || !author.owns(&before) {
        return Err(ChangeError::NotAllowed);
    }
    if before.withdrawn_at.is_some() {
        return Ok(ChangeOutcome::unchanged(shown.revision));
    }
    let owners = work.networks().owners(&before).await?;
    let row = NetworkRow {
        revision: before.revision + 1,
        updated_at: author.now,
        updated_by: author.name.clone(),
        author_organisation: author.organisation_id.clone(),
        withdrawn_at: Some(author.now),
        ..before
    };
    take_effect(work, row, &owners, &Terms { author, resend_after }).await
}
