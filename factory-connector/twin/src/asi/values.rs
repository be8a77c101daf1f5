//! Values of variables, as clients of this server read them.

use opcua_stack::{
    NamespaceTable,
    opcua::types::{DataValue, StatusCode},
    values::to_stack,
};

use super::{
    data_values::status_only, interface::Interface, node_address::NodeAddress, node_ids::NodeIds,
};
use crate::document::FieldRecord;

/// Encodes values for this server.
pub(super) struct ValueEncoder {
    pub namespaces: NamespaceTable,
    pub ids: NodeIds,
}

impl ValueEncoder {
    /// Encodes the value that a client reads from a field's variable.
    pub(super) fn field(&self, record: &FieldRecord) -> DataValue {
        to_stack(&record.shown_value(), &self.namespaces).unwrap_or_else(|error| {
            tracing::warn!(%error, "A value cannot be encoded in OPC UA Binary.");
            status_only(StatusCode::BadEncodingError)
        })
    }

    /// Returns all variables of a node by identifier: the field itself, the parts, their
    /// properties.
    pub(super) fn variables(
        &self,
        interface: &Interface,
        address: NodeAddress,
        identifier: &str,
    ) -> Vec<(String, DataValue)> {
        let mut variables = Vec::new();
        if let NodeAddress::Field(field) = address {
            let value = self.field(&interface.records.read()[field as usize]);
            variables.push((identifier.to_owned(), value));
        }
        for part in interface.parts(address) {
            let part_id = format!("{identifier}#{}", part.name);
            for below in interface.parts_of_part(address, part) {
                let value = interface.part_of_part_value(address, part, below, self.ids.types);
                variables.extend(value.map(|value| (format!("{part_id}#{}", below.name), value)));
            }
            variables.extend(interface.part_value(address, part).map(|value| (part_id, value)));
        }
        variables
    }
}
