//! NodeIds of data types, and the Argument values of methods.

use opcua_stack::opcua::types::{
    Argument, DataTypeId, ExtensionObject, LocalizedText, NodeId, Variant,
};

use super::model::{DataType, DeclaredArgument, INPUT_ARGUMENTS, Method, Part};

/// Encodes the value of a method's InputArguments or OutputArguments.
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

/// Returns the NodeId of a data type; `types` is the index of the type namespace.
pub(super) fn data_type_id(data_type: DataType, types: u16) -> NodeId {
    match data_type {
        DataType::Standard(id) => NodeId::new(0, id),
        DataType::Enumeration(model) => NodeId::new(types, model.id),
    }
}

/// Returns the NodeId of a built-in type as a DataType (OPC 10000-6 §5.1.2: the same numbers; Variant is
/// BaseDataType).
pub(super) fn built_in_type_id(built_in: asi_model::BuiltInType) -> NodeId {
    match built_in {
        asi_model::BuiltInType::Variant => DataTypeId::BaseDataType.into(),
        // The built-in type ExtensionObject has the DataType Structure.
        other => NodeId::new(0, u32::from(other.id())),
    }
}
