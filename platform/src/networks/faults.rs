//! Validation of a revision beyond the wire contract: against the collaboration and the author's
//! rights.

use std::collections::HashMap;

use asi_model::{
    DynamicDataRequestId, OrganisationId,
    messages::Fault,
    network::{DynamicDataRequest, OperationNetwork},
    validation::validate_network,
};

use super::{author::Author, fault::fault, rights, taken};
use crate::store::{Collaboration, NetworkOwners};

/// Revision in force that a document shall replace.
pub(super) struct Revision<'a> {
    pub(super) whole: &'a OperationNetwork,
    /// The network as the author sees it.
    pub(super) shown: &'a OperationNetwork,
}

/// Surroundings in which a document is judged.
pub(super) struct Context<'a> {
    pub(super) collaboration: &'a Collaboration,
    pub(super) owners: &'a NetworkOwners,
    /// The first requester of each request id that was ever used in the network.
    pub(super) requesters: &'a HashMap<DynamicDataRequestId, OrganisationId>,
    pub(super) author: &'a Author,
}

/// Finds all faults of an author's document at once, with pointers into it. Without a revision in
/// force, the author draws the network.
pub(super) fn faults(
    document: &OperationNetwork,
    revision: Option<&Revision<'_>>,
    context: &Context<'_>,
) -> Vec<Fault> {
    let shown = revision.map(|revision| revision.shown);
    let mut faults = structure(document);
    operations(document, shown, context, &mut faults);
    let both = revision.map(|revision| (revision.whole, revision.shown));
    faults.extend(taken::faults(document, both, context.requesters));
    if let Some(shown) = shown
        && !context.author.is_administrator
    {
        let author = context.author.organisation_id.as_ref();
        faults.extend(rights::faults(shown, document, context.owners, author));
    }
    faults
}

/// Finds the fault of a revision that is right by itself, but not together with what its author
/// does not see.
pub(super) fn conflict(merged: &OperationNetwork) -> Option<Fault> {
    let message = "This does not fit the part of the network that is not shown to you.";
    let is_faulty = !validate_network(merged).is_empty();
    is_faulty.then(|| fault(String::new(), "HIDDEN_CONFLICT", message.to_owned()))
}

/// Faults by the wire contract. A request may be added to a stub, where the platform knows the
/// whole operation.
pub(crate) fn structure(document: &OperationNetwork) -> Vec<Fault> {
    let mut whole = document.clone();
    for operation in &mut whole.operation_list {
        operation.stub = false;
    }
    validate_network(&whole)
}

fn operations(
    document: &OperationNetwork,
    shown: Option<&OperationNetwork>,
    context: &Context<'_>,
    faults: &mut Vec<Fault>,
) {
    let known: HashMap<_, _> = shown
        .iter()
        .flat_map(|network| &network.operation_list)
        .map(|operation| (&operation.operation_id, operation))
        .collect();
    for (index, operation) in document.operation_list.iter().enumerate() {
        let at = format!("/operationList/{index}");
        let old = known.get(&operation.operation_id);
        match &operation.owning_factory_id {
            None => faults.push(fault(
                format!("{at}/owningFactoryId"),
                "MISSING_OWNER",
                "In a whole network every operation names the factory that carries it out."
                    .to_owned(),
            )),
            Some(factory) if !context.collaboration.factories.contains(factory) => {
                faults.push(fault(
                    format!("{at}/owningFactoryId"),
                    "UNKNOWN_FACTORY",
                    format!("{factory} is no factory of the collaboration; add it there first."),
                ));
            }
            Some(_) => {}
        }
        // For others' operations it says nothing but that the author saw them in part.
        let author = context.author;
        let is_written = author.is_administrator
            || old.is_none()
            || context.owners.performer(operation) == author.organisation_id.as_ref();
        if operation.stub && is_written && !old.is_some_and(|old| old.stub) {
            faults.push(fault(
                format!("{at}/stub"),
                "STUB_IN_WHOLE",
                "Only operations of others that are shown to you are stubs.".to_owned(),
            ));
        }
        let old = old.map(|old| old.dynamic_data_request_list.as_slice()).unwrap_or_default();
        for (number, request) in operation.dynamic_data_request_list.iter().enumerate() {
            if !old.contains(request) {
                let at = format!("{at}/dynamicDataRequestList/{number}");
                request_faults(request, &at, context, faults);
            }
        }
    }
}

/// Finds faults of a request: it asks in the author's own name, and only members get the answers.
fn request_faults(
    request: &DynamicDataRequest,
    at: &str,
    context: &Context<'_>,
    faults: &mut Vec<Fault>,
) {
    let author = context.author;
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
        if !context.collaboration.members.contains(organisation) {
            faults.push(fault(
                pointer,
                "UNKNOWN_ORGANISATION",
                format!("{organisation} is no member of the collaboration."),
            ));
        }
    }
}
