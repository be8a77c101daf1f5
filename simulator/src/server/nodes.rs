//! The node manager of a machine: everything in memory, changes pushed, jobs taken.

use std::{
    collections::HashMap,
    sync::{
        Arc,
        atomic::{AtomicU32, Ordering},
    },
};

use asi_model::values::{BuiltInType, NodeId as ModelId, QualifiedName, Variant as ModelVariant};
use async_trait::async_trait;
use opcua_stack::{
    NamespaceTable,
    opcua::{
        nodes::{
            DataTypeBuilder, DefaultTypeTree, HasNodeId as _, MethodBuilder, NodeType, ObjectBuilder,
            ObjectTypeBuilder, ReferenceDirection, VariableBuilder,
        },
        server::{
            CreateMonitoredItem,
            address_space::{AddressSpace, write_node_value},
            diagnostics::NamespaceMetadata,
            node_manager::{MethodCall, RequestContext, ServerContext, WriteNode, memory::InMemoryNodeManagerImpl},
        },
        sync::RwLock,
        types::{
            Argument, AttributeId, DataEncoding, DataTypeDefinition, DataTypeId, DataValue, NodeId, NumericRange,
            ObjectId, ObjectTypeId, ReferenceTypeId, StatusCode, StructureDefinition, StructureField, StructureType,
            TimestampsToReturn, Variant,
            custom::{DataTypeTree, EncodingIds, ParentIds, TypeInfo},
        },
    },
    values::{node_id_to_stack, qualified_name_to_stack, variant_to_stack},
};

use super::{Variable, layout};
use crate::{
    Layout,
    blueprint::{Blueprint, Class, NodePlan, POWER_AGGREGATE, POWER_AGGREGATE_BINARY, POWER_AGGREGATE_FIELDS, Source},
};

pub(crate) struct MachineNodes {
    name: String,
    namespaces: Vec<NamespaceMetadata>,
    table: NamespaceTable,
    variables: HashMap<String, Variable>,
    /// Each method that takes a job, with its variables for order and quantity.
    jobs: HashMap<NodeId, (NodeId, NodeId)>,
    newest_item: AtomicU32,
    muted: AtomicU32,
}

impl MachineNodes {
    /// Fills the address space of a new server.
    pub(super) fn build(
        blueprint: &Arc<Blueprint>,
        layout: Layout,
        name: &str,
        context: &ServerContext,
        space: &mut AddressSpace,
    ) -> Self {
        let (namespaces, table) = register_namespaces(blueprint, layout, &mut context.type_tree.write(), space);
        let table = add_power_aggregate(blueprint, table, space);
        let mut builder = Builder { blueprint, layout, table: &table, space, ids: Vec::new() };
        builder.add_types();
        let ids: Vec<NodeId> =
            (0..blueprint.nodes.len()).map(|index| builder.id(&layout::node_id(blueprint, layout, index))).collect();
        builder.ids.clone_from(&ids);
        for (index, node) in blueprint.nodes.iter().enumerate() {
            builder.add(index, node);
        }
        let variables = variables(blueprint, &ids);
        let jobs = jobs(blueprint, &ids, &variables);
        Self {
            name: name.to_owned(),
            namespaces,
            table,
            variables,
            jobs,
            newest_item: AtomicU32::new(0),
            muted: AtomicU32::new(0),
        }
    }

    pub(super) fn table(&self) -> &NamespaceTable {
        &self.table
    }

    pub(super) fn variables(&self) -> &HashMap<String, Variable> {
        &self.variables
    }

    /// Monitored items up to this id are told nothing.
    pub(super) fn muted(&self) -> u32 {
        self.muted.load(Ordering::Relaxed)
    }

    pub(super) fn mute(&self, is_muted: bool) {
        let newest = if is_muted { self.newest_item.load(Ordering::Relaxed) } else { 0 };
        self.muted.store(newest, Ordering::Relaxed);
    }
}

#[async_trait]
impl InMemoryNodeManagerImpl for MachineNodes {
    async fn init(&self, _space: &mut AddressSpace, _context: ServerContext) {}

    fn name(&self) -> &str {
        &self.name
    }

    fn namespaces(&self) -> Vec<NamespaceMetadata> {
        self.namespaces.clone()
    }

    async fn create_value_monitored_items(
        &self,
        context: &RequestContext,
        space: &RwLock<AddressSpace>,
        items: &mut [&mut &mut CreateMonitoredItem],
    ) {
        let space = space.read();
        for item in items {
            // The stack takes a monitored item's part of an array out of what it is given, so it must be the whole.
            let node = match space.validate_node_read(context, item.item_to_monitor()) {
                Ok(node) => node,
                Err(status) => {
                    item.set_status(status);
                    continue;
                }
            };
            let (range, encoding) = (NumericRange::None, DataEncoding::Binary);
            let value = node.as_node().get_attribute(TimestampsToReturn::Both, AttributeId::Value, &range, &encoding);
            if let Some(value) = value {
                item.set_initial_value(value);
            }
            item.set_status(StatusCode::Good);
            self.newest_item.fetch_max(item.handle().monitored_item_id, Ordering::Relaxed);
        }
    }

    async fn write(
        &self,
        context: &RequestContext,
        space: &RwLock<AddressSpace>,
        nodes_to_write: &mut [&mut WriteNode],
    ) -> Result<(), StatusCode> {
        let mut space = space.write();
        let types = context.type_tree.read();
        for write in nodes_to_write {
            let node = match space.validate_node_write(context, write.value(), &*types) {
                Ok(node) => node,
                Err(status) => {
                    write.set_status(status);
                    continue;
                }
            };
            match write_node_value(node, write.value()) {
                Ok(()) => {
                    write.set_status(StatusCode::Good);
                    let id = node.node_id().clone();
                    tell(context, &space, &[id]);
                }
                Err(status) => write.set_status(status),
            }
        }
        Ok(())
    }

    async fn call(
        &self,
        context: &RequestContext,
        space: &RwLock<AddressSpace>,
        methods_to_call: &mut [&mut &mut MethodCall],
    ) -> Result<(), StatusCode> {
        let mut space = space.write();
        for call in methods_to_call {
            let Some((order, quantity)) = self.jobs.get(call.method_id()) else {
                call.set_status(StatusCode::BadMethodInvalid);
                continue;
            };
            let [Variant::String(order_id), Variant::UInt32(pieces)] = call.arguments() else {
                call.set_status(StatusCode::BadInvalidArgument);
                continue;
            };
            let values = [(order, Variant::from(order_id.clone())), (quantity, Variant::from(*pieces))];
            for (id, value) in values {
                if let Some(NodeType::Variable(node)) = space.find_mut(id) {
                    node.set_data_value(DataValue::new_now(value));
                }
            }
            let is_accepted = *pieces > 0;
            tell(context, &space, &[order.clone(), quantity.clone()]);
            call.set_outputs(vec![is_accepted.into()]);
            call.set_status(StatusCode::Good);
        }
        Ok(())
    }
}

/// Tells subscriptions what variables have now.
fn tell(context: &RequestContext, space: &AddressSpace, ids: &[NodeId]) {
    context.subscriptions.maybe_notify(
        ids.iter().map(|id| (id, AttributeId::Value)),
        |id, attribute, _range, encoding| {
            let node = space.find(id)?.as_node();
            node.get_attribute(TimestampsToReturn::Both, attribute, &NumericRange::None, encoding)
        },
    );
}

fn register_namespaces(
    blueprint: &Blueprint,
    layout: Layout,
    types: &mut DefaultTypeTree,
    space: &mut AddressSpace,
) -> (Vec<NamespaceMetadata>, NamespaceTable) {
    let mut metadata = Vec::new();
    for uri in layout::namespaces(blueprint, layout) {
        let namespace_index = types.namespaces_mut().add_namespace(&uri);
        space.add_namespace(&uri, namespace_index);
        metadata.push(NamespaceMetadata { namespace_uri: uri, namespace_index, ..NamespaceMetadata::default() });
    }
    let mut uris: Vec<_> = types.namespaces().known_namespaces().iter().collect();
    uris.sort_by_key(|(_, index)| **index);
    let table = NamespaceTable::new(uris.into_iter().map(|(uri, _)| uri));
    (metadata, table)
}

/// The custom structure: its nodes, and the table that can encode it.
fn add_power_aggregate(blueprint: &Blueprint, table: NamespaceTable, space: &mut AddressSpace) -> NamespaceTable {
    let namespace = table.index(&blueprint.namespace_uri).expect("it was just registered");
    let (id, binary) = (NodeId::new(namespace, POWER_AGGREGATE), NodeId::new(namespace, POWER_AGGREGATE_BINARY));
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
    let name = opcua_stack::opcua::types::QualifiedName::new(namespace, "PowerAggregateType");
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

struct Builder<'a> {
    blueprint: &'a Blueprint,
    layout: Layout,
    table: &'a NamespaceTable,
    space: &'a mut AddressSpace,
    /// By index of the blueprint.
    ids: Vec<NodeId>,
}

impl Builder<'_> {
    fn id(&self, id: &ModelId) -> NodeId {
        node_id_to_stack(id, self.table).expect("a blueprint names its namespaces")
    }

    fn name(&self, name: &QualifiedName) -> opcua_stack::opcua::types::QualifiedName {
        qualified_name_to_stack(name, self.table).expect("a blueprint names its namespaces")
    }

    fn value(&self, value: &ModelVariant) -> Variant {
        variant_to_stack(value, self.table).expect("a blueprint's values are of its types")
    }

    fn add_types(&mut self) {
        for plan in &self.blueprint.types {
            let id = self.id(&plan.node_id);
            let name = opcua_stack::opcua::types::QualifiedName::new(id.namespace, plan.name);
            ObjectTypeBuilder::new(&id, name, plan.name).subtype_of(self.id(&plan.supertype)).insert(self.space);
        }
    }

    fn add(&mut self, index: usize, node: &NodePlan) {
        debug_assert_eq!(self.ids[index], self.id(&layout::node_id(self.blueprint, self.layout, index)));
        let id = self.ids[index].clone();
        let parent = node.parent.map_or_else(|| ObjectId::ObjectsFolder.into(), |parent| self.ids[parent].clone());
        let name = self.name(&node.name);
        let display = node.name.name.as_deref().unwrap_or_default();
        let description = node.description.unwrap_or_default();
        match &node.class {
            Class::Object(type_definition) => {
                let object = ObjectBuilder::new(&id, name, display)
                    .description(description)
                    .has_type_definition(self.id(type_definition));
                let object =
                    if node.parent.is_some() { object.component_of(parent) } else { object.organized_by(parent) };
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
                variable.insert(self.space);
            }
            Class::Property(value, data_type) => {
                VariableBuilder::new(&id, name, display)
                    .data_type(self.id(data_type))
                    .value_rank(-1)
                    .value(self.value(value))
                    .has_type_definition(opcua_stack::opcua::types::VariableTypeId::PropertyType)
                    .property_of(parent)
                    .insert(self.space);
            }
            Class::StartJob => self.add_job(&id, name, display, description, parent),
        }
    }

    fn add_job(
        &mut self,
        id: &NodeId,
        name: opcua_stack::opcua::types::QualifiedName,
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
        let inputs = [argument("OrderId", DataTypeId::String), argument("Quantity", DataTypeId::UInt32)];
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

/// The variables with a value of their own, by key.
fn variables(blueprint: &Blueprint, ids: &[NodeId]) -> HashMap<String, Variable> {
    let plans = blueprint.nodes.iter().zip(ids).filter_map(|(node, id)| match &node.class {
        Class::Variable(plan) => Some((node, id, plan)),
        _ => None,
    });
    plans
        .map(|(node, id, plan)| {
            let built_in = match plan.data_type {
                ModelId { identifier: asi_model::values::Identifier::Numeric(id), .. } => {
                    BuiltInType::from_id(u64::from(id)).unwrap_or(BuiltInType::ExtensionObject)
                }
                _ => BuiltInType::ExtensionObject,
            };
            (node.key.clone(), Variable { id: id.clone(), built_in })
        })
        .collect()
}

fn jobs(
    blueprint: &Blueprint,
    ids: &[NodeId],
    variables: &HashMap<String, Variable>,
) -> HashMap<NodeId, (NodeId, NodeId)> {
    let methods = blueprint.nodes.iter().zip(ids).filter(|(node, _)| matches!(node.class, Class::StartJob));
    methods
        .filter_map(|(node, id)| {
            let group = node.key.rsplit_once('.')?.0;
            let variable = |name: &str| Some(variables.get(&format!("{group}.{name}"))?.id.clone());
            Some((id.clone(), (variable("OrderId")?, variable("OrderedQuantity")?)))
        })
        .collect()
}
