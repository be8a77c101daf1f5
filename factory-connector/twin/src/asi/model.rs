//! Type model of [`asi_types`](asi_model::asi_types), with the few parts that no type declares.

pub(crate) use asi_model::asi_types::{
    ASI_MODEL_VERSION, ASI_NAMESPACE_URI, Argument as DeclaredArgument, DYNAMIC_DATA_REQUEST_TYPE,
    DataType, ENUMERATIONS, EQUIPMENT_REQUIREMENT_TYPE, Enumeration, FIELD_PARTS, HAS_OPERATION,
    INSPECTION_OPERATION_TYPE, INTERFACE_TYPE, Method, OBJECT_TYPES, OPERATION_NETWORK_TYPE,
    OPERATION_RELATION_TYPE, ObjectType, PRODUCTION_OPERATION_TYPE, Part, PartKind,
    REFERENCE_TYPES, RELATION_CONDITION_TYPE, REPORT_DATA_FORMAT_TYPE, ReferenceSupertype,
    TRANSPORTATION_OPERATION_TYPE, ValueType, dependency, instance_namespace_uri, object_type,
    parts_of_type,
};
use opcua_stack::opcua::types::{DataTypeId, VariableTypeId};

use crate::access::Role;

/// The type definition of properties.
pub(crate) const PROPERTY_TYPE: VariableTypeId = VariableTypeId::PropertyType;

/// The property of a component variable that has a unit.
pub(crate) static UNIT_PART: Part = standard("EngineeringUnits", DataTypeId::EUInformation, -1);
/// A property of a method.
pub(crate) static INPUT_ARGUMENTS: Part = standard("InputArguments", DataTypeId::Argument, 1);
/// A property of a method.
pub(crate) static OUTPUT_ARGUMENTS: Part = standard("OutputArguments", DataTypeId::Argument, 1);
/// The properties of the folder of all interfaces.
pub(crate) static FOLDER_PARTS: [Part; 1] = [standard("NodeVersion", DataTypeId::String, -1)];

const fn standard(name: &'static str, data_type: DataTypeId, value_rank: i32) -> Part {
    let value = ValueType { data_type: DataType::Standard(data_type as u32), value_rank };
    Part { name, is_standard: true, is_mandatory: false, kind: PartKind::Property(value) }
}

/// Returns the least role that may call a method.
pub(crate) fn callable_by(method_name: &str) -> Role {
    if method_name == "Decide" { Role::Engineer } else { Role::Viewer }
}
