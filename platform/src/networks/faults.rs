//! Validation of a network beyond the wire contract: against the collaboration and the author's
//! rights.

use std::collections::HashMap;

use asi_model::{
    messages::Fault,
    network::{DynamicDataRequest, OperationNetwork},
};

use super::author::Author;
use crate::store::Collaboration;

/// All faults at once. `before` is the revision in effect, whose requests the author need not
/// answer for.
pub(super) fn faults(
    network: &OperationNetwork,
    before: Option<&OperationNetwork>,
    collaboration: &Collaboration,
    author: &Author,
) -> Vec<Fault> {
    let mut faults = asi_model::validation::validate_network(network);
    let known: HashMap<_, &DynamicDataRequest> = before
        .iter()
        .flat_map(|network| network.requests())
        .map(|(key, _, request)| (key, request))
        .collect();
    for (index, operation) in network.operation_list.iter().enumerate() {
        let at = format!("/operationList/{index}");
        match &operation.owning_factory_id {
            None => faults.push(fault(
                format!("{at}/owningFactoryId"),
                "MISSING_OWNER",
                "In a whole network every operation names the factory that carries it out."
                    .to_owned(),
            )),
            Some(factory) if !collaboration.factories.contains(factory) => faults.push(fault(
                format!("{at}/owningFactoryId"),
                "UNKNOWN_FACTORY",
                format!("{factory} is no factory of the collaboration; add it there first."),
            )),
            Some(_) => {}
        }
        if operation.stub {
            faults.push(fault(
                format!("{at}/stub"),
                "STUB_IN_WHOLE",
                "A whole network has no stubs; the platform makes them for each factory."
                    .to_owned(),
            ));
        }
        for (number, request) in operation.dynamic_data_request_list.iter().enumerate() {
            let at = format!("{at}/dynamicDataRequestList/{number}");
            let is_unchanged = known
                .iter()
                .any(|(key, old)| key.operation_id == operation.operation_id && **old == *request);
            if !is_unchanged {
                request_faults(request, &at, collaboration, author, &mut faults);
            }
        }
    }
    faults
}

/// Finds faults of a request: it asks in the author's own name, and only members get the answers.
fn request_faults(
    request: &DynamicDataRequest,
    at: &str,
    collaboration: &Collaboration,
    author: &Author,
    faults: &mut Vec<Fault>,
) {
    if !author.is_administrator && author.organisation_id.as_ref() != Some(&request.requester_id) {
        faults.push(fault(
            format!("{at}/requesterId"),
            "FOREIGN_REQUESTER",
            "Requests are made in the name of the own organisation.".to_owned(),
        ));
    }
    let members = [(&request.requester_id, format!("{at}/requesterId"))].into_iter().chain(
        request
            .recipient_list
            .iter()
            .enumerate()
            .map(|(index, id)| (id, format!("{at}/recipientList/{index}"))),
    );
    for (organisation, pointer) in members {
        if !collaboration.members.contains(organisation) {
            faults.push(fault(
                pointer,
                "UNKNOWN_ORGANISATION",
                format!("{organisation} is no member of the collaboration."),
            ));
        }
    }
}

fn fault(pointer: String, code: &str, message: String) -> Fault {
    Fault { pointer, code: code.to_owned(), message }
}
