//! Reading lists that must not be empty.

use std::collections::HashSet;

use super::{FaultCode, LIST_MAX, reader::Reader};
use crate::{
    ids::OrganisationId,
    json::{JsonNode, Kind},
};

/// Notes a list that is there and empty.
pub(super) fn not_empty(reader: &mut Reader, object: JsonNode<'_, '_>, name: &str) {
    if let Some(list) = object.get(name)
        && list.kind() == Kind::Array
        && list.elements().next().is_none()
    {
        reader.fault(list, FaultCode::EmptyList, "The list must have at least one element.");
    }
}

/// The organisations that may see what is asked for, each once.
pub(super) fn recipients(reader: &mut Reader, object: JsonNode<'_, '_>) -> Vec<OrganisationId> {
    let mut seen = HashSet::new();
    let recipients = reader.list(object, "recipientList", LIST_MAX, |reader, node| {
        let id: OrganisationId = reader.id(node)?;
        if !seen.insert(id.clone()) {
            reader.fault(node, FaultCode::DuplicateId, "The recipient is listed twice.");
        }
        Some(id)
    });
    not_empty(reader, object, "recipientList");
    recipients
}
