//! The tables as nodes.

use std::sync::Arc;

use super::{
    ASI_MODEL_VERSION, ASI_NAMESPACE_URI, ASI_PUBLICATION_DATE, ENUMERATIONS, Enumeration, Method,
    OBJECT_TYPES, ObjectType, Part, PartKind, REFERENCE_TYPES, ReferenceSupertype, ValueType, asi,
    browse_name,
};
use crate::{
    node_set::{Model, Node, NodeClass, NodeSet, ns0},
    values::{
        Array, BuiltInType, ExtensionBody, ExtensionObject, LocalizedText, NodeId, Scalar,
        StructureValue, Variant,
    },
};

// Node ids follow from the id of the type, so that they stay when types are added: clients store
// them. The offsets lie beyond every id of a type and of its declarations.
const DECLARATIONS_PER_TYPE: u32 = 100;
const INPUT_ARGUMENTS_OFFSET: u32 = 1_000_000;
const OUTPUT_ARGUMENTS_OFFSET: u32 = 2_000_000;

/// The types as a node set, to be published as NodeSet2 or loaded by a server.
#[must_use]
pub fn node_set() -> NodeSet {
    let mut nodes = Vec::new();
    for known in REFERENCE_TYPES.iter() {
        let supertype = match known.supertype {
            ReferenceSupertype::Standard(id) => NodeId::ua(id),
            ReferenceSupertype::Asi(id) => asi(id),
        };
        let class = NodeClass::ReferenceType {
            is_abstract: known.is_abstract,
            is_symmetric: false,
            inverse_name: known.inverse_name.map(ToOwned::to_owned),
        };
        nodes.push(
            Node::new(asi(known.id), browse_name(known.name, false), class)
                .with_inverse(ns0::HAS_SUBTYPE, supertype),
        );
    }
    for known in ENUMERATIONS {
        add_enumeration(&mut nodes, known);
    }
    for known in &OBJECT_TYPES {
        add_object_type(&mut nodes, known);
    }
    NodeSet {
        models: vec![Model {
            uri: ASI_NAMESPACE_URI.to_owned(),
            version: Some(ASI_MODEL_VERSION.to_owned()),
            publication_date: ASI_PUBLICATION_DATE.parse().ok(),
            required: vec![Model::ua()],
        }],
        nodes,
    }
}

fn add_enumeration(nodes: &mut Vec<Node>, known: &Enumeration) {
    let fields = (0..).zip(known.values).map(|(value, name)| (value, (*name).to_owned())).collect();
    let class = NodeClass::DataType { is_abstract: false, enumeration: fields };
    let node = Node::new(asi(known.id), browse_name(known.name, false), class);
    nodes.push(node.with_inverse(ns0::HAS_SUBTYPE, ns0::ENUMERATION));
    let names = known.values.iter().map(|name| {
        Scalar::LocalizedText(Box::new(LocalizedText {
            locale: None,
            text: Some(Arc::from(*name)),
        }))
    });
    let value = array(BuiltInType::LocalizedText, names.collect());
    let class =
        NodeClass::Variable { data_type: NodeId::ua(21), value_rank: 1, value, is_writable: false };
    let property = Node::new(
        asi(known.id * DECLARATIONS_PER_TYPE + 1),
        browse_name("EnumStrings", true),
        class,
    );
    nodes.push(
        property
            .with(ns0::HAS_TYPE_DEFINITION, ns0::PROPERTY_TYPE)
            .with_inverse(ns0::HAS_PROPERTY, asi(known.id)),
    );
}

fn array(element_type: BuiltInType, elements: Vec<Scalar>) -> Variant {
    Variant::Array(Arc::new(Array { element_type, elements, dimensions: None }))
}

fn add_object_type(nodes: &mut Vec<Node>, known: &ObjectType) {
    let mut node = Node::new(
        asi(known.id),
        browse_name(known.name, false),
        NodeClass::ObjectType { is_abstract: known.is_abstract },
    );
    node.description = Some(known.description.to_owned());
    nodes.push(
        node.with_inverse(ns0::HAS_SUBTYPE, known.supertype.map_or(ns0::BASE_OBJECT_TYPE, asi)),
    );
    for (number, part) in (1..).zip(known.parts) {
        add_declaration(nodes, known, part, known.id * DECLARATIONS_PER_TYPE + number);
    }
}

fn add_declaration(nodes: &mut Vec<Node>, owner: &ObjectType, part: &Part, id: u32) {
    let variable = |value: ValueType| NodeClass::Variable {
        data_type: value.data_type.node_id(),
        value_rank: value.value_rank,
        value: Variant::Null,
        is_writable: false,
    };
    let (class, definition, reference) = match part.kind {
        PartKind::Property(value) => (variable(value), Some(ns0::PROPERTY_TYPE), ns0::HAS_PROPERTY),
        PartKind::Component(value) => {
            (variable(value), Some(ns0::BASE_DATA_VARIABLE_TYPE), ns0::HAS_COMPONENT)
        }
        PartKind::Object(id) => (NodeClass::Object, Some(asi(id)), ns0::HAS_COMPONENT),
        PartKind::Method(_) => (NodeClass::Method, None, ns0::HAS_COMPONENT),
    };
    let mut node = Node::new(asi(id), part.browse_name(), class);
    if let Some(definition) = definition {
        node = node.with(ns0::HAS_TYPE_DEFINITION, definition);
    }
    let rule = if part.is_mandatory {
        ns0::MODELLING_RULE_MANDATORY
    } else {
        ns0::MODELLING_RULE_OPTIONAL
    };
    nodes.push(node.with(ns0::HAS_MODELLING_RULE, rule).with_inverse(reference, asi(owner.id)));
    if let PartKind::Method(method) = part.kind {
        add_arguments(nodes, method, id);
    }
}

fn add_arguments(nodes: &mut Vec<Node>, method: &Method, method_id: u32) {
    for (name, offset, arguments) in [
        ("InputArguments", INPUT_ARGUMENTS_OFFSET, method.inputs),
        ("OutputArguments", OUTPUT_ARGUMENTS_OFFSET, method.outputs),
    ] {
        if arguments.is_empty() {
            continue;
        }
        let elements = arguments.iter().map(|argument| {
            let mut structure = StructureValue::default();
            structure.fields.insert("Name".into(), argument.name.into());
            let data_type = Scalar::NodeId(Box::new(argument.data_type.node_id()));
            structure.fields.insert("DataType".into(), data_type.into());
            structure.fields.insert("ValueRank".into(), (-1_i32).into());
            structure.fields.insert("ArrayDimensions".into(), Variant::Null);
            let text = LocalizedText { locale: None, text: Some(argument.description.into()) };
            structure
                .fields
                .insert("Description".into(), Scalar::LocalizedText(Box::new(text)).into());
            Scalar::ExtensionObject(Box::new(ExtensionObject {
                type_id: NodeId::ua(296).into(),
                body: ExtensionBody::Structure(structure),
            }))
        });
        let value = array(BuiltInType::ExtensionObject, elements.collect());
        let class = NodeClass::Variable {
            data_type: NodeId::ua(296),
            value_rank: 1,
            value,
            is_writable: false,
        };
        nodes.push(
            Node::new(asi(method_id + offset), browse_name(name, true), class)
                .with(ns0::HAS_TYPE_DEFINITION, ns0::PROPERTY_TYPE)
                .with(ns0::HAS_MODELLING_RULE, ns0::MODELLING_RULE_MANDATORY)
                .with_inverse(ns0::HAS_PROPERTY, asi(method_id)),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::node_set;

    /// `asi nodeset types > asi-model/node-set/Verbund.ASI.NodeSet2.xml` writes it again.
    #[test]
    fn the_published_node_set_is_fresh() {
        let published = include_str!("../../node-set/Verbund.ASI.NodeSet2.xml");
        assert!(
            node_set::write(&node_set()) == published,
            "run `asi nodeset types > asi-model/node-set/Verbund.ASI.NodeSet2.xml`"
        );
    }

    #[test]
    fn the_node_set_reads_back() {
        let types = node_set();
        assert_eq!(node_set::read(node_set::write(&types).as_bytes()), Ok(types));
    }

    #[test]
    fn ids_are_unique_and_references_lead_somewhere() {
        let types = node_set();
        let mut ids: Vec<&NodeId> = types.nodes.iter().map(|node| &node.node_id).collect();
        ids.sort_unstable();
        assert!(ids.windows(2).all(|pair| pair[0] != pair[1]));
        for node in &types.nodes {
            for reference in &node.references {
                let is_own = reference.target.namespace != crate::values::Namespace::Ua;
                assert!(
                    !is_own || ids.binary_search(&&reference.target).is_ok(),
                    "{}",
                    reference.target
                );
            }
        }
    }
}
