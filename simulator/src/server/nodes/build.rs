//! Conversion of a blueprint's nodes to those of an address space.

use std::sync::Arc;

use asi_model::values::{NodeId as ModelId, QualifiedName, Variant as ModelVariant};
use opcua_stack::{
    NamespaceTable,
    opcua::{
        nodes::{
            DataTypeBuilder, EventNotifier, MethodBuilder, ObjectBuilder, ObjectTypeBuilder,
            ReferenceDirection, VariableBuilder,
        },
        server::address_space::AddressSpace,
        types::{
            Argument, DataTypeDefinition, DataTypeId, NodeId, ObjectId, ObjectTypeId,
            QualifiedName as StackName, ReferenceTypeId, StructureDefinition, StructureField,
            StructureType, VariableTypeId, Variant,
            custom::{DataTypeTree, EncodingIds, ParentIds, TypeInfo},
        },
    },
    values::{node_id_to_stack, qualified_name_to_stack, variant_to_stack},
};

use super::layout;
use crate::{
    Layout,
    blueprint::{
        Blueprint, Class, NodePlan, POWER_AGGREGATE, POWER_AGGREGATE_BINARY,
        POWER_AGGREGATE_FIELDS, Source,
    },
};

/// The custom structure: its nodes, and the table that can encode it.
pub(super) fn add_power_aggregate(
    blueprint: &Blueprint,
    table: NamespaceTable,
    space: &mut AddressSpace,
) -> NamespaceTable {
    let namespace = table.index(&blueprint.namespace_uri).expect("it was just registered");
    let (id, binary) =
        (NodeId::new(namespace, POWER_AGGREGATE), NodeId::new(namespace, POWER_AGGREGATE_BINARY));
    let types = [DataTypeId::UInt32, DataTypeId::Double, DataTypeId::Double, DataTypeId::Double];
    let fields = POWER_AGGREGATE_FIELDS.iter().zip(types).map(|(name, data_type)| StructureField {
        name: (*name).into(),
        data_type: data_type.into(),
        value_rank: -1,
        ..StructureField::default()
    });
    let definition = StructureDefinition {
        default_encoding_id: binary.clone(),
        base_data_type: DataTypeId::Structure.into(),
        structure_type: StructureType::Structure,
        fields: Some(fields.collect()),
    };
    let name = StackName::new(namespace, "PowerAggregateType");
    DataTypeBuilder::new(&id, name, "PowerAggregateType")
        .data_type_definition(DataTypeDefinition::Structure(definition.clone()))
        .subtype_of(DataTypeId::Structure)
        .reference(binary.clone(), ReferenceTypeId::HasEncoding, ReferenceDirection::Forward)
        .insert(space);
    ObjectBuilder::new(&binary, "Default Binary", "Default Binary")
        .has_type_definition(ObjectTypeId::DataTypeEncodingType)
        .insert(space);

    let mut parents = ParentIds::new();
    parents.add_type(id.clone(), DataTypeId::Structure.into());
    let mut tree = DataTypeTree::new(parents);
    let encodings = EncodingIds { binary_id: binary, ..EncodingIds::default() };
    let info = TypeInfo::from_type_definition(
        DataTypeDefinition::Structure(definition),
        "PowerAggregateType".into(),
        Some(encodings),
        false,
        &id,
        tree.parent_ids(),
    );
    tree.add_type(id, info.expect("the definition is complete"));
    table.with_data_types(Arc::new(tree))
}

/// Puts nodes into an address space.
pub(super) struct Builder<'a> {
    pub(super) blueprint: &'a Blueprint,
    pub(super) layout: Layout,
    pub(super) table: &'a NamespaceTable,
    pub(super) space: &'a mut AddressSpace,
    /// By index of the blueprint.
    pub(super) ids: Vec<NodeId>,
}

impl Builder<'_> {
    pub(super) fn id(&self, id: &ModelId) -> NodeId {
        node_id_to_stack(id, self.table).expect("a blueprint names its namespaces")
    }

    fn name(&self, name: &QualifiedName) -> StackName {
        qualified_name_to_stack(name, self.table).expect("a blueprint names its namespaces")
    }

    fn value(&self, value: &ModelVariant) -> Variant {
        variant_to_stack(value, self.table).expect("a blueprint's values are of its types")
    }

    pub(super) fn add_types(&mut self) {
        for plan in &self.blueprint.types {
            let id = self.id(&plan.node_id);
            let name = StackName::new(id.namespace, plan.name);
            ObjectTypeBuilder::new(&id, name, plan.name)
                .subtype_of(self.id(&plan.supertype))
                .insert(self.space);
        }
    }

    pub(super) fn add(&mut self, index: usize, node: &NodePlan) {
        debug_assert_eq!(
            self.ids[index],
            self.id(&layout::node_id(self.blueprint, self.layout, index))
        );
        let id = self.ids[index].clone();
        let parent = node
            .parent
            .map_or_else(|| ObjectId::ObjectsFolder.into(), |parent| self.ids[parent].clone());
        let name = self.name(&node.name);
        let display = node.name.name.as_deref().unwrap_or_default();
        let description = node.description.unwrap_or_default();
        match &node.class {
            Class::Object(type_definition) => {
                let object = ObjectBuilder::new(&id, name, display)
                    .description(description)
                    .has_type_definition(self.id(type_definition));
                let object = if node.parent.is_some() {
                    object.component_of(parent)
                } else {
                    // Events of a machine come from its root.
                    object.organized_by(parent).event_notifier(EventNotifier::SUBSCRIBE_TO_EVENTS)
                };
                object.insert(self.space);
            }
            Class::Variable(plan) => {
                let mut variable = VariableBuilder::new(&id, name, display)
                    .description(description)
                    .data_type(self.id(&plan.data_type))
                    .value_rank(plan.value_rank)
                    .has_type_definition(self.id(&plan.type_definition))
                    .component_of(parent);
                if let Source::Written(initial) = &plan.source {
                    variable = variable.value(self.value(initial)).writable();
                }
                if plan.has_history {
                    variable = variable.history_readable();
                }
                variable.insert(self.space);
            }
            Class::Property(value, data_type) => {
                VariableBuilder::new(&id, name, display)
                    .data_type(self.id(data_type))
                    .value_rank(-1)
                    .value(self.value(value))
                    .has_type_definition(VariableTypeId::PropertyType)
                    .property_of(parent)
                    .insert(self.space);
            }
            Class::StartJob => self.add_job(&id, name, display, description, parent),
        }
    }

    fn add_job(
        &mut self,
        id: &NodeId,
        name: StackName,
        display: &str,
        description: &str,
        parent: NodeId,
    ) {
        let argument = |name: &str, data_type: DataTypeId| Argument {
            name: name.into(),
            data_type: data_type.into(),
            value_rank: -1,
            ..Argument::default()
        };
        let below = |name: &str| NodeId::new(id.namespace, format!("{}.{name}", id.identifier));
        let inputs =
            [argument("OrderId", DataTypeId::String), argument("Quantity", DataTypeId::UInt32)];
        let outputs = [argument("Accepted", DataTypeId::Boolean)];
        MethodBuilder::new(id, name, display)
            .description(description)
            .executable(true)
            .user_executable(true)
            .component_of(parent)
            .input_args(self.space, &below("InputArguments"), &inputs)
            .output_args(self.space, &below("OutputArguments"), &outputs)
            .insert(self.space);
    }
}
