//! The parts of a place: properties, component variables and methods, with values computed from the
//! network and the records.

use asi_model::{
    DateTime,
    messages::MappingState,
    network::{OperationKind, OperationState, ReportField, Semantic},
    units,
};
use opcua_stack::{
    opcua::types::{
        Argument, DataTypeId, DataValue, EUInformation, ExtensionObject, LocalizedText, NodeId,
        Range, StatusCode, UAString, Variant,
    },
    values::{status_to_stack, time_to_stack},
};

use super::{
    interface::Interface,
    model::{
        self, DataType, DeclaredArgument, FIELD_PARTS, INPUT_ARGUMENTS, Method, OUTPUT_ARGUMENTS,
        Part, PartKind, UNIT_PART, parts_of_type,
    },
    place::Place,
};
use crate::document::FieldRecord;

impl Interface {
    /// The object type of a place; fields are variables and have none.
    pub fn type_of(&self, place: Place) -> Option<u32> {
        Some(match place {
            Place::Interface => model::INTERFACE_TYPE,
            Place::OperationNetwork => model::OPERATION_NETWORK_TYPE,
            Place::Operation(operation) => match self.operation(operation).kind {
                OperationKind::Production { .. } => model::PRODUCTION_OPERATION_TYPE,
                OperationKind::Inspection { .. } => model::INSPECTION_OPERATION_TYPE,
                OperationKind::Transportation { .. } => model::TRANSPORTATION_OPERATION_TYPE,
            },
            Place::Requirement(..) => model::EQUIPMENT_REQUIREMENT_TYPE,
            Place::Relation(_) => model::OPERATION_RELATION_TYPE,
            Place::Condition(..) => model::RELATION_CONDITION_TYPE,
            Place::Request(_) => model::DYNAMIC_DATA_REQUEST_TYPE,
            Place::ReportDataFormat(_) => model::REPORT_DATA_FORMAT_TYPE,
            Place::Field(_) => return None,
        })
    }

    /// The parts that this place has now. Component objects are places of their own and not among
    /// them.
    pub fn parts(&self, place: Place) -> Vec<&'static Part> {
        self.possible_parts(place).into_iter().filter(|part| self.has_part(place, part)).collect()
    }

    /// The part of this place with a name, if it has it now.
    pub fn part(&self, place: Place, name: &str) -> Option<&'static Part> {
        self.possible_parts(place)
            .into_iter()
            .find(|part| part.name == name && self.has_part(place, part))
    }

    /// The parts that a place of this kind can have.
    pub fn possible_parts(&self, place: Place) -> Vec<&'static Part> {
        match self.type_of(place) {
            Some(id) => {
                parts_of_type(id).filter(|part| !matches!(part.kind, PartKind::Object(_))).collect()
            }
            None => FIELD_PARTS.iter().collect(),
        }
    }

    fn has_part(&self, place: Place, part: &Part) -> bool {
        matches!(part.kind, PartKind::Method(_)) || self.part_value(place, part).is_some()
    }

    /// The properties below a part: a method's arguments, a component's unit.
    pub fn parts_of_part(&self, place: Place, part: &Part) -> Vec<&'static Part> {
        match part.kind {
            PartKind::Method(method) => method_parts(method),
            PartKind::Component(_) if self.unit_of(place, part).is_some() => vec![&UNIT_PART],
            _ => Vec::new(),
        }
    }

    /// The value of a property below a part.
    pub fn part_of_part_value(
        &self,
        place: Place,
        part: &Part,
        below: &Part,
        types: u16,
    ) -> Option<DataValue> {
        match part.kind {
            PartKind::Method(method) => {
                Some(fixed(argument_values(method, below, types), self.received_at))
            }
            _ => {
                Some(fixed(engineering_units(self.unit_of(place, part)?).into(), self.received_at))
            }
        }
    }

    /// The unit of a component variable.
    pub fn unit_of(&self, place: Place, part: &Part) -> Option<&str> {
        match (place, part.name) {
            (Place::Operation(operation), "PlannedQuantity") => {
                self.operation(operation).quantity_unit.as_deref()
            }
            _ => None,
        }
    }

    /// The value of a property or component variable; `None` where the place does not have it.
    pub fn part_value(&self, place: Place, part: &Part) -> Option<DataValue> {
        if part.name == "NodeVersion" {
            return Some(fixed(Variant::from(self.version(place).to_string()), self.received_at));
        }
        if let Place::Field(field) = place {
            let (_, definition) = self.field(field);
            return field_part(
                definition,
                self.planned_quantity(field),
                &self.records.read()[field as usize],
                part,
            )
            .map(|value| value.unwrap_or_else(|variant| fixed(variant, self.received_at)));
        }
        if let (Place::Operation(operation), "State") = (place, part.name) {
            return (!self.operation(operation).stub).then(|| self.state(operation));
        }
        self.definition(place, part.name).map(|variant| fixed(variant, self.received_at))
    }

    fn planned_quantity(&self, field: u32) -> Option<f64> {
        let (request, definition) = self.field(field);
        let operation = self.operation(self.slot(request).operation);
        (operation.quantity_unit == definition.unit).then_some(operation.planned_quantity).flatten()
    }

    /// The operation's state as its report field discloses it.
    fn state(&self, operation: u32) -> DataValue {
        let Some(field) = self.state_field(operation) else {
            return absent(StatusCode::BadWaitingForInitialData);
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

    /// What the network says itself.
    fn definition(&self, place: Place, name: &str) -> Option<Variant> {
        match place {
            Place::Interface => self.interface_part(name),
            Place::OperationNetwork => {
                let network = self.network();
                match name {
                    "OperationNetworkId" => text(network.operation_network_id.as_str()),
                    "Name" => optional_text(network.name.as_ref()),
                    "Description" => optional_text(network.description.as_ref()),
                    _ => None,
                }
            }
            Place::Operation(operation) => self.operation_part(operation, name),
            Place::Requirement(operation, at) => self.requirement_part(operation, at, name),
            Place::Relation(relation) => self.relation_part(relation, name),
            Place::Condition(relation, at) => self.condition_part(relation, at, name),
            Place::Request(request) => self.request_part(request, name),
            Place::ReportDataFormat(request) => match name {
                "ReportName" => text(&self.request(request).report_data_format.report_name),
                _ => None,
            },
            Place::Field(_) => None,
        }
    }

    fn interface_part(&self, name: &str) -> Option<Variant> {
        match name {
            "CollaborationId" => text(self.message.collaboration_id.as_str()),
            "Revision" => Some(self.message.revision.into()),
            "ReceivedTime" => Some(time(self.received_at)),
            _ => None,
        }
    }

    fn operation_part(&self, operation: u32, name: &str) -> Option<Variant> {
        let operation = self.operation(operation);
        match name {
            "OperationId" => text(operation.operation_id.as_str()),
            "Name" => optional_text(operation.name.as_ref()),
            "Description" => optional_text(operation.description.as_ref()),
            "OwningFactoryId" => {
                operation.owning_factory_id.as_ref().and_then(|id| text(id.as_str()))
            }
            "PlannedStart" => operation.planned_start.map(time),
            "PlannedEnd" => operation.planned_end.map(time),
            "PlannedQuantity" => operation.planned_quantity.map(Variant::from),
            _ => match &operation.kind {
                OperationKind::Production { product_id } if name == "ProductId" => {
                    optional_text(product_id.as_ref())
                }
                OperationKind::Inspection { inspected_operation_id: Some(id), .. }
                    if name == "InspectedOperationId" =>
                {
                    text(id.as_str())
                }
                OperationKind::Inspection { characteristic, .. } if name == "Characteristic" => {
                    optional_text(characteristic.as_ref())
                }
                OperationKind::Transportation { origin, .. } if name == "Origin" => {
                    optional_text(origin.as_ref())
                }
                OperationKind::Transportation { destination, .. } if name == "Destination" => {
                    optional_text(destination.as_ref())
                }
                _ => None,
            },
        }
    }

    fn requirement_part(&self, operation: u32, at: u32, name: &str) -> Option<Variant> {
        let requirement = &self.operation(operation).equipment_requirement_list[at as usize];
        match name {
            "EquipmentRequirementId" => text(requirement.equipment_requirement_id.as_str()),
            "EquipmentType" => text(&requirement.equipment_type),
            "Capability" => optional_text(requirement.capability.as_ref()),
            "Quantity" => requirement.quantity.map(Variant::from),
            "AssetId" => requirement.asset_id.as_ref().and_then(|id| text(id.as_str())),
            _ => None,
        }
    }

    fn relation_part(&self, relation: u32, name: &str) -> Option<Variant> {
        let relation = self.relation(relation);
        match name {
            "OperationRelationId" => text(relation.operation_relation_id.as_str()),
            "RelationType" => Some((relation.relation_type as i32).into()),
            "PredecessorOperationId" => text(relation.predecessor_operation_id.as_str()),
            "SuccessorOperationId" => text(relation.successor_operation_id.as_str()),
            _ => None,
        }
    }

    fn condition_part(&self, relation: u32, at: u32, name: &str) -> Option<Variant> {
        let condition = &self.relation(relation).condition_list[at as usize];
        match name {
            "ConditionId" => text(condition.condition_id.as_str()),
            "ConditionKind" => Some((condition.condition_kind as i32).into()),
            "Time" => condition.time.map(time),
            "Duration" => {
                condition.duration.map(|duration| (duration.0.as_secs_f64() * 1000.0).into())
            }
            _ => None,
        }
    }

    fn request_part(&self, number: u32, name: &str) -> Option<Variant> {
        let request = self.request(number);
        match name {
            "DynamicDataRequestId" => text(request.dynamic_data_request_id.as_str()),
            "DynamicDataRequestPublisherId" => {
                request.dynamic_data_request_publisher_id.as_ref().and_then(|id| text(id.as_str()))
            }
            "RequesterId" => text(request.requester_id.as_str()),
            "Recipients" => {
                let recipients: Vec<String> =
                    request.recipient_list.iter().map(ToString::to_string).collect();
                Some(recipients.into())
            }
            "Purpose" => text(&request.purpose),
            "ValidFrom" => request.valid_from.map(time),
            "ValidUntil" => request.valid_until.map(time),
            "Description" => optional_text(request.description.as_ref()),
            "BufferId" => optional_text(request.buffer_id.as_ref()),
            "UpdateFrequency" => request.update_frequency.map(Variant::from),
            "UpdateFrequencyUnit" => request.update_frequency_unit.map(|unit| (unit as i32).into()),
            "DataSetWriterId" => self.slot(number).data_set_writer_id.map(Variant::from),
            _ => None,
        }
    }
}

fn text(text: &str) -> Option<Variant> {
    Some(Variant::from(text))
}

fn optional_text(text: Option<&String>) -> Option<Variant> {
    text.map(|text| Variant::from(text.as_str()))
}

fn time(time: DateTime) -> Variant {
    time_to_stack(time).into()
}

fn fixed(value: Variant, since: DateTime) -> DataValue {
    DataValue {
        value: Some(value),
        status: Some(StatusCode::Good),
        source_timestamp: Some(time_to_stack(since)),
        ..DataValue::default()
    }
}

fn absent(status: StatusCode) -> DataValue {
    DataValue { status: Some(status), ..DataValue::default() }
}

/// A property of a field: `Err` with a value that the request fixed, `Ok` with one that the record
/// says.
fn field_part(
    definition: &ReportField,
    planned_quantity: Option<f64>,
    record: &FieldRecord,
    part: &Part,
) -> Option<Result<DataValue, Variant>> {
    let decided = |value: Variant, status: StatusCode| DataValue {
        value: Some(value),
        status: Some(status),
        source_timestamp: record.decision_time.map(time_to_stack),
        ..DataValue::default()
    };
    let decided_text = |text: Option<&std::sync::Arc<str>>| {
        let text = text.map_or_else(UAString::null, |text| UAString::from(text.as_ref()));
        Some(Ok(decided(text.into(), StatusCode::Good)))
    };
    match part.name {
        "EngineeringUnits" if definition.field_type.0.is_numeric() => {
            definition.unit.as_deref().map(|unit| Err(engineering_units(unit).into()))
        }
        "EURange" if definition.field_type.0.is_numeric() => {
            engineering_range(definition, planned_quantity)
                .map(|range| Err(ExtensionObject::from_message(range).into()))
        }
        "Semantic" => {
            definition.semantic.as_ref().map(|semantic| Err(Variant::from(semantic.as_str())))
        }
        "IsMapped" => Some(Ok(match record.mapping_state {
            MappingState::Pending => decided(false.into(), StatusCode::UncertainInitialValue),
            MappingState::Mapped => decided(true.into(), StatusCode::Good),
            MappingState::Refused => decided(false.into(), StatusCode::Good),
        })),
        "MappingState" => Some(Ok(decided((record.mapping_state as i32).into(), StatusCode::Good))),
        "ValueSource" => Some(Ok(match record.value_source {
            Some(source) => decided((source as i32).into(), StatusCode::Good),
            None => absent(StatusCode::BadNoData),
        })),
        "Disclosure" => decided_text(record.disclosure.as_ref()),
        "DecisionReason" => decided_text(record.reason.as_ref()),
        "DecidedBy" => decided_text(record.decided_by.as_ref()),
        "DecisionTime" => Some(Ok(match record.decision_time {
            Some(at) => decided(time(at), StatusCode::Good),
            None => absent(StatusCode::BadNoData),
        })),
        _ => None,
    }
}

/// The range that a field's values normally lie in, where its meaning tells.
pub(super) fn engineering_range(
    definition: &ReportField,
    planned_quantity: Option<f64>,
) -> Option<Range> {
    let high = match definition.semantic.as_ref()? {
        Semantic::PercentComplete => 100.0,
        Semantic::ProducedQuantity | Semantic::GoodQuantity | Semantic::ScrapQuantity => {
            planned_quantity?
        }
        _ => return None,
    };
    (high > 0.0).then_some(Range { low: 0.0, high })
}

/// The unit as OPC 10000-8 §5.6.3 writes it; one that the table does not know keeps its name only.
pub(super) fn engineering_units(unit: &str) -> ExtensionObject {
    let known = units::lookup(unit);
    let text = |text: &str| LocalizedText::new("en", text);
    ExtensionObject::from_message(EUInformation {
        namespace_uri: units::UNECE_NAMESPACE_URI.into(),
        unit_id: known.map_or(-1, |known| known.unit_id()),
        display_name: text(known.map_or(unit, |known| known.display_name)),
        description: text(known.map_or(unit, |known| known.description)),
    })
}

fn method_parts(method: &'static Method) -> Vec<&'static Part> {
    let inputs = (!method.inputs.is_empty()).then_some(&INPUT_ARGUMENTS);
    let outputs = (!method.outputs.is_empty()).then_some(&OUTPUT_ARGUMENTS);
    inputs.into_iter().chain(outputs).collect()
}

/// The value of a method's InputArguments or OutputArguments.
pub(super) fn argument_values(method: &Method, part: &Part, types: u16) -> Variant {
    let arguments = if part.name == INPUT_ARGUMENTS.name { method.inputs } else { method.outputs };
    let objects: Vec<ExtensionObject> = arguments
        .iter()
        .map(|argument| ExtensionObject::from_message(argument_value(argument, types)))
        .collect();
    Variant::from(objects)
}

fn argument_value(argument: &DeclaredArgument, types: u16) -> Argument {
    Argument {
        name: argument.name.into(),
        data_type: data_type_id(argument.data_type, types),
        value_rank: -1,
        array_dimensions: None,
        description: LocalizedText::new("en", argument.description),
    }
}

/// The NodeId of a data type; `types` is the index of the type namespace.
pub(super) fn data_type_id(data_type: DataType, types: u16) -> NodeId {
    match data_type {
        DataType::Standard(id) => NodeId::new(0, id),
        DataType::Enumeration(model) => NodeId::new(types, model.id),
    }
}

/// The NodeId of a built-in type as a DataType (OPC 10000-6 §5.1.2: the same numbers; Variant is
/// BaseDataType).
pub(super) fn built_in_type_id(built_in: asi_model::BuiltInType) -> NodeId {
    match built_in {
        asi_model::BuiltInType::Variant => DataTypeId::BaseDataType.into(),
        // Structure is the DataType of what the built-in type ExtensionObject carries.
        other => NodeId::new(0, u32::from(other.id())),
    }
}
