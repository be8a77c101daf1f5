//! Structures with and without a known definition.

use std::sync::Arc;

use asi_model::values::{
    Array, BuiltInType, ExpandedNodeId, ExtensionBody, ExtensionObject, NodeId, Scalar, Server,
    StructureValue, Variant,
};
use opcua_stack::{
    NamespaceTable,
    opcua::types::{
        self as stack, BinaryDecodable, BinaryEncodable, ContextOwned, DataTypeDefinition,
        DataTypeId, DecodingOptions, NamespaceMap, StructureDefinition, StructureField,
        StructureType,
        custom::{DataTypeTree, DynamicTypeLoader, EncodingIds, ParentIds, TypeInfo},
    },
    values::{ConversionError, variant_from_stack, variant_to_stack},
};

const POWER: u32 = 3001;

fn table() -> NamespaceTable {
    NamespaceTable::new(["http://opcfoundation.org/UA/", "urn:press"])
}

fn field(name: &str, data_type: DataTypeId, value_rank: i32, is_optional: bool) -> StructureField {
    StructureField {
        name: name.into(),
        data_type: data_type.into(),
        value_rank,
        is_optional,
        ..StructureField::default()
    }
}

fn types(structure_type: StructureType, fields: Vec<StructureField>) -> Arc<DataTypeTree> {
    let mut parents = ParentIds::new();
    let id = stack::NodeId::new(1, POWER);
    parents.add_type(id.clone(), DataTypeId::Structure.into());
    let definition = StructureDefinition {
        structure_type,
        fields: Some(fields),
        base_data_type: DataTypeId::Structure.into(),
        ..StructureDefinition::default()
    };
    let encodings =
        EncodingIds { binary_id: stack::NodeId::new(1, POWER + 1), ..EncodingIds::default() };
    let mut tree = DataTypeTree::new(parents);
    let info = TypeInfo::from_type_definition(
        DataTypeDefinition::Structure(definition),
        "Power".into(),
        Some(encodings),
        false,
        &id,
        tree.parent_ids(),
    );
    tree.add_type(id, info.expect("a complete definition"));
    Arc::new(tree)
}

fn power_types() -> Arc<DataTypeTree> {
    types(
        StructureType::StructureWithOptionalFields,
        vec![
            field("SecondsAggregated", DataTypeId::UInt32, -1, false),
            field("WattsMax", DataTypeId::Double, -1, true),
            field("WattsAvg", DataTypeId::Double, -1, true),
            field("Phases", DataTypeId::Float, 1, false),
        ],
    )
}

fn power() -> Variant {
    let phases = Array {
        element_type: BuiltInType::Float,
        elements: vec![Scalar::Float(1.5), Scalar::Float(2.5)],
        dimensions: None,
    };
    object(StructureValue {
        fields: [
            (Arc::from("SecondsAggregated"), Variant::from(60_u32)),
            (Arc::from("WattsAvg"), Variant::from(812.5)),
            (Arc::from("Phases"), Variant::Array(Arc::new(phases))),
        ]
        .into_iter()
        .collect(),
        switch_field: None,
        encoding_mask: Some(0b10),
    })
}

fn object(value: StructureValue) -> Variant {
    Variant::Scalar(Scalar::ExtensionObject(Box::new(ExtensionObject {
        type_id: ExpandedNodeId {
            node_id: NodeId::numeric("urn:press", POWER),
            server: Server::Local,
        },
        body: ExtensionBody::Structure(value),
    })))
}

/// Through OPC UA Binary, read by a peer that knows these types, or none.
fn over_the_wire(value: &stack::Variant, types: Option<Arc<DataTypeTree>>) -> stack::Variant {
    let mut namespaces = NamespaceMap::new();
    namespaces.add_namespace("urn:press");
    let mut context = ContextOwned::new_default(namespaces, DecodingOptions::default());
    if let Some(types) = types {
        context.loaders_mut().add_type_loader(DynamicTypeLoader::new(types));
    }
    let mut bytes = Vec::new();
    value.encode(&mut bytes, &context.context()).expect("encodes");
    stack::Variant::decode(&mut bytes.as_slice(), &context.context()).expect("decodes")
}

#[test]
fn a_known_structure_travels_by_field_names() {
    let table = table().with_data_types(power_types());
    let sent = variant_to_stack(&power(), &table).expect("the type is known");
    let received = over_the_wire(&sent, Some(power_types()));
    assert_eq!(variant_from_stack(received, &table), Ok(power()));
}

#[test]
fn a_union_keeps_its_selector() {
    let types = types(
        StructureType::Union,
        vec![
            field("Count", DataTypeId::UInt64, -1, false),
            field("Text", DataTypeId::String, -1, false),
        ],
    );
    let table = table().with_data_types(Arc::clone(&types));
    let check = |value: StructureValue| {
        let sent = variant_to_stack(&object(value.clone()), &table).expect("the type is known");
        assert_eq!(
            variant_from_stack(over_the_wire(&sent, Some(Arc::clone(&types))), &table),
            Ok(object(value))
        );
    };
    check(StructureValue {
        fields: [(Arc::from("Text"), Variant::from("jam"))].into_iter().collect(),
        switch_field: Some(2),
        encoding_mask: None,
    });
    check(StructureValue { switch_field: Some(0), ..StructureValue::default() });
}

#[test]
fn an_unknown_structure_keeps_its_bytes_and_can_be_sent_again() {
    let known = table().with_data_types(power_types());
    let sent = variant_to_stack(&power(), &known).expect("the type is known");
    let kept = variant_from_stack(over_the_wire(&sent, None), &table()).expect("bytes are kept");
    let Variant::Scalar(Scalar::ExtensionObject(object)) = &kept else { panic!("{kept:?}") };
    assert_eq!(
        object.type_id.node_id,
        NodeId::numeric("urn:press", POWER + 1),
        "the encoding is all there is to see"
    );
    assert!(matches!(object.body, ExtensionBody::Binary(_)));

    let again = variant_to_stack(&kept, &table()).expect("bytes can be sent");
    assert_eq!(variant_from_stack(over_the_wire(&again, Some(power_types())), &known), Ok(power()));
}

#[test]
fn ranges_and_units_need_no_definition() {
    let range =
        stack::Variant::from(stack::ExtensionObject::new(stack::Range { low: -10.0, high: 90.0 }));
    let unit = stack::Variant::from(stack::ExtensionObject::new(stack::EUInformation {
        namespace_uri: "http://www.opcfoundation.org/UA/units/un/cefact".into(),
        unit_id: 4_408_652,
        display_name: "°C".into(),
        description: "degree Celsius".into(),
    }));
    for value in [range, unit] {
        let ours = variant_from_stack(over_the_wire(&value, None), &table()).expect("known types");
        let Variant::Scalar(Scalar::ExtensionObject(object)) = &ours else { panic!("{ours:?}") };
        assert!(matches!(object.body, ExtensionBody::Structure(_)), "{object:?}");
        assert_eq!(variant_to_stack(&ours, &table()), Ok(value));
    }
}

#[test]
fn a_standard_structure_travels_as_bytes_under_its_data_type() {
    let argument = stack::Argument {
        name: "Amount".into(),
        data_type: DataTypeId::Int32.into(),
        array_dimensions: Some(Vec::new()),
        ..Default::default()
    };
    let value = stack::Variant::from(stack::ExtensionObject::new(argument));
    let ours = variant_from_stack(value.clone(), &table()).expect("bytes are kept");
    let Variant::Scalar(Scalar::ExtensionObject(object)) = &ours else { panic!("{ours:?}") };
    assert_eq!(object.type_id.node_id, NodeId::ua(296));
    assert_eq!(variant_to_stack(&ours, &table()), Ok(value));
}

#[test]
fn what_does_not_fit_a_definition_is_refused_with_the_reason() {
    let known = table().with_data_types(power_types());
    let value = |name: &str, value: Variant| {
        object(StructureValue {
            fields: [(Arc::from(name), value)].into_iter().collect(),
            ..StructureValue::default()
        })
    };
    let check = |value: Variant, expected: &str| {
        let error = variant_to_stack(&value, &known).expect_err("must be refused").to_string();
        assert!(error.contains(expected), "{error}");
    };
    check(value("Horsepower", 1.0.into()), "there is no field \"Horsepower\"");
    check(value("SecondsAggregated", 1.0.into()), "Invalid type for field SecondsAggregated");
    check(value("SecondsAggregated", 1_u32.into()), "non-nullable field Phases");
    assert_eq!(
        variant_to_stack(&power(), &table()),
        Err(ConversionError::UnknownStructure { type_id: "nsu=urn:press;i=3001".into() })
    );
}
