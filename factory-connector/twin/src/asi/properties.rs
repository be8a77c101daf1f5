//! Parts of a node - properties, component variables and methods - with their values, computed from
//! the network and the records.

use asi_model::network::{OperationKind, OperationState};
use opcua_stack::{
    opcua::types::{DataValue, StatusCode, Variant},
    values::{status_to_stack, time_to_stack},
};

use super::{
    data_types::argument_values,
    data_values::{fixed, status_only},
    definitions,
    field_properties::{self, engineering_units},
    interface::Interface,
    model::{
        self, FIELD_PARTS, INPUT_ARGUMENTS, Method, OUTPUT_ARGUMENTS, Part, PartKind, UNIT_PART,
        parts_of_type,
    },
    node_address::NodeAddress,
};

impl Interface {
    /// Returns the object type of an address; fields are variables and have none.
    pub fn type_of(&self, address: NodeAddress) -> Option<u32> {
        Some(match address {
            NodeAddress::Interface => model::INTERFACE_TYPE,
            NodeAddress::OperationNetwork => model::OPERATION_NETWORK_TYPE,
            NodeAddress::Operation(operation) => match self.operation(operation).kind {
                OperationKind::Production { .. } => model::PRODUCTION_OPERATION_TYPE,
                OperationKind::Inspection { .. } => model::INSPECTION_OPERATION_TYPE,
                OperationKind::Transportation { .. } => model::TRANSPORTATION_OPERATION_TYPE,
            },
            NodeAddress::Requirement(..) => model::EQUIPMENT_REQUIREMENT_TYPE,
            NodeAddress::Relation(_) => model::OPERATION_RELATION_TYPE,
            NodeAddress::Condition(..) => model::RELATION_CONDITION_TYPE,
            NodeAddress::Request(_) => model::DYNAMIC_DATA_REQUEST_TYPE,
            NodeAddress::ReportDataFormat(_) => model::REPORT_DATA_FORMAT_TYPE,
            NodeAddress::Field(_) => return None,
        })
    }

    /// Returns the parts that a node has at present. Component objects have addresses of their own
    /// and are not among them.
    pub fn parts(&self, address: NodeAddress) -> Vec<&'static Part> {
        self.possible_parts(address)
            .into_iter()
            .filter(|part| self.has_part(address, part))
            .collect()
    }

    /// Returns the part of a node with this name, if it has one at present.
    pub fn part(&self, address: NodeAddress, name: &str) -> Option<&'static Part> {
        self.possible_parts(address)
            .into_iter()
            .find(|part| part.name == name && self.has_part(address, part))
    }

    /// Returns the parts that a node of this type can have.
    pub fn possible_parts(&self, address: NodeAddress) -> Vec<&'static Part> {
        match self.type_of(address) {
            Some(id) => {
                parts_of_type(id).filter(|part| !matches!(part.kind, PartKind::Object(_))).collect()
            }
            None => FIELD_PARTS.iter().collect(),
        }
    }

    fn has_part(&self, address: NodeAddress, part: &Part) -> bool {
        matches!(part.kind, PartKind::Method(_)) || self.part_value(address, part).is_some()
    }

    /// Returns the properties of a part: a method's arguments, a component's unit.
    pub fn parts_of_part(&self, address: NodeAddress, part: &Part) -> Vec<&'static Part> {
        match part.kind {
            PartKind::Method(method) => arguments_of(method),
            PartKind::Component(_) if self.unit_of(address, part).is_some() => vec![&UNIT_PART],
            _ => Vec::new(),
        }
    }

    /// Computes the value of a part's property.
    pub fn part_of_part_value(
        &self,
        address: NodeAddress,
        part: &Part,
        below: &Part,
        types: u16,
    ) -> Option<DataValue> {
        match part.kind {
            PartKind::Method(method) => {
                Some(fixed(argument_values(method, below, types), self.received_at))
            }
            _ => Some(fixed(
                engineering_units(self.unit_of(address, part)?).into(),
                self.received_at,
            )),
        }
    }

    /// Returns the unit of a component variable.
    pub fn unit_of(&self, address: NodeAddress, part: &Part) -> Option<&str> {
        match (address, part.name) {
            (NodeAddress::Operation(operation), "PlannedQuantity") => {
                self.operation(operation).quantity_unit.as_deref()
            }
            _ => None,
        }
    }

    /// Computes the value of a property or component variable; `None` if the node does not have it.
    pub fn part_value(&self, address: NodeAddress, part: &Part) -> Option<DataValue> {
        if part.name == "NodeVersion" {
            return Some(fixed(Variant::from(self.version(address).to_string()), self.received_at));
        }
        if let NodeAddress::Field(field) = address {
            let (_, definition) = self.field(field);
            return field_properties::property(
                definition,
                self.planned_quantity(field),
                &self.records.read()[field as usize],
                part,
            )
            .map(|value| value.unwrap_or_else(|variant| fixed(variant, self.received_at)));
        }
        if let (NodeAddress::Operation(operation), "State") = (address, part.name) {
            return (!self.operation(operation).stub).then(|| self.state(operation));
        }
        definitions::property(self, address, part.name)
            .map(|variant| fixed(variant, self.received_at))
    }

    fn planned_quantity(&self, field: u32) -> Option<f64> {
        let (request, definition) = self.field(field);
        let operation = self.operation(self.slot(request).operation);
        (operation.quantity_unit == definition.unit).then_some(operation.planned_quantity).flatten()
    }

    /// Computes the operation's state as its report field discloses it.
    fn state(&self, operation: u32) -> DataValue {
        let Some(field) = self.state_field(operation) else {
            return status_only(StatusCode::BadWaitingForInitialData);
        };
        let shown = self.record(field).shown_value();
        let state = shown.value.as_scalar().and_then(|scalar| match scalar.as_str() {
            Some(name) => OperationState::from_name(name),
            None => usize::try_from(scalar.as_i128()?)
                .ok()
                .and_then(|i| OperationState::ALL.get(i).copied()),
        });
        let status = match (&state, shown.status.is_bad()) {
            (None, false) => StatusCode::BadOutOfRange,
            _ => status_to_stack(shown.status),
        };
        DataValue {
            value: state.map(|state| Variant::Int32(state as i32)),
            status: Some(status),
            source_timestamp: shown.source_timestamp.map(time_to_stack),
            ..DataValue::default()
        }
    }
}

/// Returns the properties of a method that list its arguments.
fn arguments_of(method: &'static Method) -> Vec<&'static Part> {
    let inputs = (!method.inputs.is_empty()).then_some(&INPUT_ARGUMENTS);
    let outputs = (!method.outputs.is_empty()).then_some(&OUTPUT_ARGUMENTS);
    inputs.into_iter().chain(outputs).collect()
}
