//! Adding and removing single dynamic data requests: each a new revision.

use std::time::Duration;

use asi_model::{
    DynamicDataRequestId, OperationId, OperationNetworkId, messages::Fault,
    network::DynamicDataRequest,
};

use super::{
    author::Author,
    change::{PutNetwork, put},
    outcome::{ChangeError, ChangeOutcome},
};
use crate::store::{NetworkRow, Work};

/// Adds a request to an operation. The same request again changes nothing.
///
/// # Errors
/// [`ChangeError`]; then nothing of it happened once the work is dropped.
pub async fn add_request(
    work: &mut Work,
    network: &OperationNetworkId,
    operation: &OperationId,
    request: DynamicDataRequest,
    author: &Author,
    resend_after: Duration,
) -> Result<ChangeOutcome, ChangeError> {
    let mut row = shown(work, network, author).await?;
    let not_found = || ChangeError::NotFound(format!("operation {operation} in {network}"));
    let mut operations = row.network.operation_list.iter();
    let index = operations.position(|candidate| candidate.operation_id == *operation);
    let index = index.ok_or_else(not_found)?;
    let list = &mut row.network.operation_list[index].dynamic_data_request_list;
    let number = list.iter().position(|known| *known == request).unwrap_or(list.len());
    if number == list.len() {
        list.push(request);
    }
    let place = format!("/operationList/{index}/dynamicDataRequestList/{number}");
    put_again(work, row, author, resend_after).await.map_err(|error| match error {
        ChangeError::Faulty(faults) => {
            ChangeError::Faulty(faults.into_iter().map(|fault| within(&place, fault)).collect())
        }
        other => other,
    })
}

/// Returns a fault with a pointer into the request that the author sent.
fn within(place: &str, fault: Fault) -> Fault {
    let pointer = fault.pointer.strip_prefix(place).map(str::to_owned);
    Fault { pointer: pointer.unwrap_or(fault.pointer), ..fault }
}

/// Removes a request: nodes and mappings go at the factory, the history stays.
///
/// # Errors
/// [`ChangeError`]; then nothing of it happened once the work is dropped.
pub async fn remove_request(
    work: &mut Work,
    network: &OperationNetworkId,
    operation: &OperationId,
    request: &DynamicDataRequestId,
    author: &Author,
    resend_after: Duration,
) -> Result<ChangeOutcome, ChangeError> {
    let mut row = shown(work, network, author).await?;
    let not_found =
        || ChangeError::NotFound(format!("request {request} of {operation} in {network}"));
    let target = row
        .network
        .operation_list
        .iter_mut()
        .find(|candidate| candidate.operation_id == *operation);
    let list = &mut target.ok_or_else(not_found)?.dynamic_data_request_list;
    let position = list
        .iter()
        .position(|known| known.dynamic_data_request_id == *request)
        .ok_or_else(not_found)?;
    let is_own = author.organisation_id.as_ref() == Some(&list[position].requester_id);
    if !is_own && !author.is_administrator {
        return Err(ChangeError::NotAllowed);
    }
    list.remove(position);
    put_again(work, row, author, resend_after).await
}

/// Returns a network in force as the author sees it.
async fn shown(
    work: &mut Work,
    id: &OperationNetworkId,
    author: &Author,
) -> Result<NetworkRow, ChangeError> {
    let row = work.networks().lookup(&author.scope, id).await?;
    let row = row.filter(|row| row.withdrawn_at.is_none());
    let row = row.ok_or_else(|| ChangeError::NotFound(format!("operation network {id}")))?;
    if author.may_plan { Ok(row) } else { Err(ChangeError::NotAllowed) }
}

/// Puts what the author sees, with its change, in place.
async fn put_again(
    work: &mut Work,
    row: NetworkRow,
    author: &Author,
    resend_after: Duration,
) -> Result<ChangeOutcome, ChangeError> {
    let change = PutNetwork {
        collaboration_id: row.collaboration_id,
        network: row.network,
        expected_revision: Some(row.revision),
    };
    put(work, change, author, resend_after).await
}
