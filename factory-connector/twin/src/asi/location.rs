//! Search of nodes by their NodeIds.

use std::sync::Arc;

use asi_model::instance::FOLDER_ID;
use opcua_stack::opcua::types::{Identifier, NodeId};
use parking_lot::RwLock;

use super::{
    identifiers::InstanceIdentifier,
    interface::Interface,
    interfaces::Interfaces,
    model::{FOLDER_PARTS, Part},
    node_address::NodeAddress,
    node_ids::NodeIds,
};

/// A node that was found.
pub(super) enum Located {
    /// The folder of all interfaces, or a property of it.
    Folder(Option<&'static Part>),
    Node(Location),
}

/// A node within an interface: an object or field, a part of it, or a property of that part.
pub(super) struct Location {
    pub interface: Arc<Interface>,
    pub address: NodeAddress,
    pub part: Option<&'static Part>,
    /// Property of the part.
    pub below: Option<&'static Part>,
}

/// Finds the node with this NodeId.
pub(super) fn locate(
    ids: NodeIds,
    interfaces: &RwLock<Interfaces>,
    node_id: &NodeId,
) -> Option<Located> {
    let Identifier::String(identifier) = &node_id.identifier else { return None };
    let identifier = identifier.as_ref();
    if node_id.namespace != ids.instances {
        return None;
    }
    if let Some(rest) = identifier.strip_prefix(FOLDER_ID) {
        let part = match rest.strip_prefix('#') {
            Some(name) => Some(FOLDER_PARTS.iter().find(|part| part.name == name)?),
            None if rest.is_empty() => None,
            None => return None,
        };
        return Some(Located::Folder(part));
    }
    let parsed = InstanceIdentifier::parse(identifier)?;
    let interface = interfaces.read().get(&parsed.network)?;
    let (address, names) = parsed.locate(&interface)?;
    let (part, below) = match names {
        [] => (None, None),
        [name] => (Some(interface.part(address, name)?), None),
        [name, below] => {
            let part = interface.part(address, name)?;
            let parts = interface.parts_of_part(address, part);
            (Some(part), Some(parts.into_iter().find(|p| p.name == *below)?))
        }
        _ => return None,
    };
    Some(Located::Node(Location { interface, address, part, below }))
}
