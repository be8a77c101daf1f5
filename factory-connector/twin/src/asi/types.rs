//! The type namespace: the tables of [`super::model`] as nodes.

use std::{collections::HashMap, ops::ControlFlow};

use async_trait::async_trait;
use opcua_stack::opcua::types::{
    DataTypeId, DataValue, EnumDefinition, EnumField, ExtensionObject, Identifier, LocalizedText,
    NodeClass, NodeId, ObjectId, ObjectTypeId, QualifiedName, ReferenceTypeId, StatusCode,
    VariableTypeId, Variant,
};

use super::{
    data_types::{argument_values, data_type_id},
    model::{
        self, ENUMERATIONS, Enumeration, INPUT_ARGUMENTS, OBJECT_TYPES, OUTPUT_ARGUMENTS,
        ObjectType, Part, PartKind, REFERENCE_TYPES, ReferenceSupertype,
    },
};
use crate::{
    access::TwinUser,
    provider::{
        MethodOutcome, NodeKind, NodeProvider, ProvidedNamespace, ProvidedNode, ProvidedReference,
        ReferenceVisitor, WriteRequest,
    },
};

/// A declaration's id is its type's id times this plus its number.
const DECLARATIONS_PER_TYPE: u32 = 100;
/// Added to a method declaration's id for its arguments.
const INPUT_ARGUMENTS_OFFSET: u32 = 1_000_000;
/// Added to a method declaration's id for its arguments.
const OUTPUT_ARGUMENTS_OFFSET: u32 = 2_000_000;
/// The number of an enumeration's EnumStrings.
const ENUM_STRINGS: u32 = 1;

/// Provides the types. All nodes are computed once: the types do not change while the server runs.
pub(crate) struct TypeProvider {
    index: u16,
    nodes: HashMap<u32, (ProvidedNode, Option<Variant>)>,
    /// All references in both directions, by the node that they start from.
    references: HashMap<NodeId, Vec<ProvidedReference>>,
    types: Vec<(NodeId, NodeId, NodeClass)>,
}

impl TypeProvider {
    /// Creates the types in the namespace with this index.
    pub fn new(index: u16) -> Self {
        let mut this =
            Self { index, nodes: HashMap::new(), references: HashMap::new(), types: Vec::new() };
        for model in &OBJECT_TYPES {
            this.add_object_type(model);
        }
        for model in &REFERENCE_TYPES {
            let supertype = match model.supertype {
                ReferenceSupertype::Standard(id) => NodeId::new(0, id),
                ReferenceSupertype::Asi(id) => NodeId::new(index, id),
            };
            let class = NodeKind::ReferenceType {
                is_abstract: model.is_abstract,
                is_symmetric: false,
                inverse_name: model
                    .inverse_name
                    .map_or_else(LocalizedText::null, LocalizedText::from),
            };
            this.add_type(model.id, model.name, "", class, supertype);
        }
        for model in ENUMERATIONS {
            this.add_enumeration(model);
        }
        this
    }

    fn id(&self, id: u32) -> NodeId {
        NodeId::new(self.index, id)
    }

    fn refer(&mut self, from: &NodeId, reference_type: ReferenceTypeId, to: &NodeId) {
        for (at, target, is_forward) in [(from, to, true), (to, from, false)] {
            self.references.entry(at.clone()).or_default().push(ProvidedReference {
                reference_type: reference_type.into(),
                is_forward,
                target: target.clone(),
            });
        }
    }

    fn add_type(
        &mut self,
        id: u32,
        name: &str,
        description: &str,
        class: NodeKind,
        supertype: NodeId,
    ) {
        let node_id = self.id(id);
        self.types.push((node_id.clone(), supertype.clone(), class.node_class()));
        let node = ProvidedNode {
            browse_name: QualifiedName::new(self.index, name),
            display_name: LocalizedText::from(name),
            description: described(description),
            type_definition: None,
            class,
        };
        self.nodes.insert(id, (node, None));
        self.refer(&supertype, ReferenceTypeId::HasSubtype, &node_id);
    }

    fn add_object_type(&mut self, model: &'static ObjectType) {
        let supertype = match model.supertype {
            None => ObjectTypeId::BaseObjectType.into(),
            Some(id) => self.id(id),
        };
        let class = NodeKind::ObjectType { is_abstract: model.is_abstract };
        self.add_type(model.id, model.name, model.description, class, supertype);
        for (number, part) in (1..).zip(model.parts) {
            self.add_declaration(model.id, model.id * DECLARATIONS_PER_TYPE + number, part);
        }
    }

    /// Adds the instance declaration of a part (OPC 10000-3 §6.2).
    fn add_declaration(&mut self, type_id: u32, id: u32, part: &'static Part) {
        let (class, type_definition, reference_type): (_, Option<NodeId>, _) = match part.kind {
            PartKind::Property(value) => (
                self.variable(value),
                Some(model::PROPERTY_TYPE.into()),
                ReferenceTypeId::HasProperty,
            ),
            PartKind::Component(value) => (
                self.variable(value),
                Some(VariableTypeId::BaseDataVariableType.into()),
                ReferenceTypeId::HasComponent,
            ),
            PartKind::Object(id) => {
                (NodeKind::Object, Some(self.id(id)), ReferenceTypeId::HasComponent)
            }
            PartKind::Method(_) => (
                NodeKind::Method { callable_by: model::callable_by(part.name) },
                None,
                ReferenceTypeId::HasComponent,
            ),
        };
        let namespace = if part.is_standard { 0 } else { self.index };
        let node = ProvidedNode {
            browse_name: QualifiedName::new(namespace, part.name),
            display_name: LocalizedText::from(part.name),
            description: LocalizedText::null(),
            type_definition: type_definition.clone(),
            class,
        };
        // A declaration has no value of its own, so it is null.
        let value = matches!(part.kind, PartKind::Property(_) | PartKind::Component(_))
            .then_some(Variant::Empty);
        self.nodes.insert(id, (node, value));
        let node_id = self.id(id);
        self.refer(&self.id(type_id), reference_type, &node_id);
        if let Some(definition) = type_definition {
            self.refer_forward(&node_id, ReferenceTypeId::HasTypeDefinition, definition);
        }
        let rule = if part.is_mandatory {
            ObjectId::ModellingRule_Mandatory
        } else {
            ObjectId::ModellingRule_Optional
        };
        self.refer_forward(&node_id, ReferenceTypeId::HasModellingRule, rule.into());
        if let PartKind::Method(method) = part.kind {
            for (offset, arguments, below) in [
                (INPUT_ARGUMENTS_OFFSET, method.inputs, &INPUT_ARGUMENTS),
                (OUTPUT_ARGUMENTS_OFFSET, method.outputs, &OUTPUT_ARGUMENTS),
            ] {
                if !arguments.is_empty() {
                    let value = argument_values(method, below, self.index);
                    self.add_property(id, id + offset, below.name, DataTypeId::Argument, value);
                }
            }
        }
    }

    fn add_enumeration(&mut self, model: &'static Enumeration) {
        let fields = (0_i64..).zip(model.values).map(|(value, name)| EnumField {
            value,
            display_name: LocalizedText::from(*name),
            description: LocalizedText::null(),
            name: (*name).into(),
        });
        let definition =
            ExtensionObject::from_message(EnumDefinition { fields: Some(fields.collect()) });
        let class = NodeKind::DataType { definition: Some(Box::new(definition)) };
        self.add_type(model.id, model.name, "", class, DataTypeId::Enumeration.into());
        let names: Vec<LocalizedText> =
            model.values.iter().map(|name| LocalizedText::from(*name)).collect();
        let id = model.id * DECLARATIONS_PER_TYPE + ENUM_STRINGS;
        self.add_property(
            model.id,
            id,
            "EnumStrings",
            DataTypeId::LocalizedText,
            Variant::from(names),
        );
    }

    /// Adds a standard array property with a value.
    fn add_property(
        &mut self,
        owner: u32,
        id: u32,
        name: &str,
        data_type: DataTypeId,
        value: Variant,
    ) {
        let node = ProvidedNode {
            browse_name: QualifiedName::new(0, name),
            display_name: LocalizedText::from(name),
            description: LocalizedText::null(),
            type_definition: Some(model::PROPERTY_TYPE.into()),
            class: NodeKind::Variable {
                data_type: data_type.into(),
                value_rank: 1,
                is_writable: false,
            },
        };
        self.nodes.insert(id, (node, Some(value)));
        let node_id = self.id(id);
        self.refer(&self.id(owner), ReferenceTypeId::HasProperty, &node_id);
        self.refer_forward(
            &node_id,
            ReferenceTypeId::HasTypeDefinition,
            model::PROPERTY_TYPE.into(),
        );
    }

    /// Adds a reference only at its source: type definitions and modelling rules would list very
    /// many.
    fn refer_forward(&mut self, from: &NodeId, reference_type: ReferenceTypeId, to: NodeId) {
        let reference = ProvidedReference {
            reference_type: reference_type.into(),
            is_forward: true,
            target: to,
        };
        self.references.entry(from.clone()).or_default().push(reference);
    }

    fn variable(&self, value: model::ValueType) -> NodeKind {
        NodeKind::Variable {
            data_type: data_type_id(value.data_type, self.index),
            value_rank: value.value_rank,
            is_writable: false,
        }
    }

    fn entry(&self, node_id: &NodeId) -> Option<&(ProvidedNode, Option<Variant>)> {
        match node_id.identifier {
            Identifier::Numeric(id) if node_id.namespace == self.index => self.nodes.get(&id),
            _ => None,
        }
    }

    /// Returns the NodeId of a method's declaration: clients may call the type's method on an
    /// object.
    pub fn method_declaration(index: u16, type_id: u32, name: &str) -> Option<NodeId> {
        let number =
            model::object_type(type_id)?.parts.iter().position(|part| part.name == name)?;
        Some(NodeId::new(index, type_id * DECLARATIONS_PER_TYPE + u32::try_from(number).ok()? + 1))
    }
}

fn described(description: &str) -> LocalizedText {
    if description.is_empty() {
        LocalizedText::null()
    } else {
        LocalizedText::new("en", description)
    }
}

#[async_trait]
impl NodeProvider for TypeProvider {
    fn name(&self) -> &'static str {
        "asi-types"
    }

    fn namespaces(&self) -> Vec<ProvidedNamespace> {
        vec![ProvidedNamespace {
            index: self.index,
            uri: model::ASI_NAMESPACE_URI.to_owned(),
            version: Some(model::ASI_MODEL_VERSION.to_owned()),
        }]
    }

    fn node(&self, node_id: &NodeId) -> Option<ProvidedNode> {
        self.entry(node_id).map(|(node, _)| node.clone())
    }

    fn value(&self, node_id: &NodeId) -> Option<DataValue> {
        let value = self.entry(node_id)?.1.clone()?;
        Some(DataValue {
            value: Some(value),
            status: Some(StatusCode::Good),
            ..DataValue::default()
        })
    }

    fn references(&self, node_id: &NodeId, after: u64, visit: &mut ReferenceVisitor<'_>) {
        let Some(references) = self.references.get(node_id) else { return };
        for (position, reference) in
            (1..).zip(references).skip(usize::try_from(after).unwrap_or(usize::MAX))
        {
            if let ControlFlow::Break(()) = visit(position, reference.clone()) {
                return;
            }
        }
    }

    fn types(&self) -> Vec<(NodeId, NodeId, NodeClass)> {
        self.types.clone()
    }

    async fn write(&self, _user: &TwinUser, request: WriteRequest<'_>) -> StatusCode {
        if self.entry(request.node_id).is_some() {
            StatusCode::BadNotWritable
        } else {
            StatusCode::BadNodeIdUnknown
        }
    }

    async fn call(
        &self,
        _user: &TwinUser,
        _object: &NodeId,
        _method: &NodeId,
        _arguments: &[Variant],
    ) -> MethodOutcome {
        MethodOutcome::failed(StatusCode::BadMethodInvalid)
    }
}

/// Returns the type definition of folders.
pub(super) fn folder_type() -> NodeId {
    ObjectTypeId::FolderType.into()
}
