//! The node manager of a machine: everything in memory, changes pushed, jobs taken, past values read.

mod build;
mod history;

use std::{
    collections::HashMap,
    sync::{
        Arc,
        atomic::{AtomicU32, Ordering},
    },
};

use asi_model::values::{BuiltInType, Identifier, NodeId as ModelId};
use async_trait::async_trait;
use opcua_stack::{
    NamespaceTable,
    opcua::{
        nodes::{DefaultTypeTree, HasNodeId as _, NodeType},
        server::{
            CreateMonitoredItem,
            address_space::{AddressSpace, write_node_value},
            diagnostics::NamespaceMetadata,
            node_manager::{
                HistoryNode, MethodCall, RequestContext, ServerContext, WriteNode,
                memory::InMemoryNodeManagerImpl,
            },
        },
        sync::RwLock,
        types::{
            AttributeId, DataEncoding, DataValue, NodeId, NumericRange, ReadRawModifiedDetails,
            StatusCode, TimestampsToReturn, Variant,
        },
    },
};

use super::{events::ShownEvent, layout};
use crate::{
    Layout,
    blueprint::{Blueprint, Class},
    records::MachineRecords,
};

use build::{Builder, add_power_aggregate};

/// Variable on a server.
#[derive(Clone)]
pub(super) struct Variable {
    pub(super) id: NodeId,
    pub(super) built_in: BuiltInType,
    pub(super) has_history: bool,
}

pub(crate) struct MachineNodes {
    name: String,
    namespaces: Vec<NamespaceMetadata>,
    table: NamespaceTable,
    variables: HashMap<String, Variable>,
    /// Each method that takes a job, with its variables for order and quantity.
    jobs: HashMap<NodeId, (NodeId, NodeId)>,
    /// The object that events come from.
    root: NodeId,
    records: Arc<MachineRecords>,
    newest_item: AtomicU32,
    muted: AtomicU32,
}

impl MachineNodes {
    /// Fills the address space of a new server.
    pub(super) fn build(
        blueprint: &Arc<Blueprint>,
        layout: Layout,
        name: &str,
        records: Arc<MachineRecords>,
        context: &ServerContext,
        space: &mut AddressSpace,
    ) -> Self {
        let (namespaces, table) =
            register_namespaces(blueprint, layout, &mut context.type_tree.write(), space);
        let table = add_power_aggregate(blueprint, table, space);
        let mut builder = Builder { blueprint, layout, table: &table, space, ids: Vec::new() };
        builder.add_types();
        let ids: Vec<NodeId> = (0..blueprint.nodes.len())
            .map(|index| builder.id(&layout::node_id(blueprint, layout, index)))
            .collect();
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
            root: ids.into_iter().next().expect("a machine has a root"),
            records,
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

    pub(super) fn root(&self) -> &NodeId {
        &self.root
    }

    /// The conditions that people should know of, as events.
    pub(super) fn retained(&self) -> Vec<ShownEvent> {
        let source = (&self.root, self.name.as_str());
        let retained = self.records.retained().into_iter();
        retained
            .map(|(name, condition, at)| ShownEvent::alarm(&name, &condition, source, at))
            .collect()
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
            // The stack takes a monitored item's part of an array out of what it is given, so it
            // must be the whole.
            let node = match space.validate_node_read(context, item.item_to_monitor()) {
                Ok(node) => node,
                Err(status) => {
                    item.set_status(status);
                    continue;
                }
            };
            let (range, encoding) = (NumericRange::None, DataEncoding::Binary);
            let value = node.as_node().get_attribute(
                TimestampsToReturn::Both,
                AttributeId::Value,
                &range,
                &encoding,
            );
            if let Some(value) = value {
                item.set_initial_value(value);
            }
            item.set_status(StatusCode::Good);
            self.newest_item.fetch_max(item.handle().monitored_item_id, Ordering::Relaxed);
        }
    }

    async fn history_read_raw_modified(
        &self,
        _context: &RequestContext,
        details: &ReadRawModifiedDetails,
        nodes: &mut [&mut &mut HistoryNode],
        _timestamps_to_return: TimestampsToReturn,
    ) -> Result<(), StatusCode> {
        if details.is_read_modified || details.start_time.is_null() {
            return Err(StatusCode::BadHistoryOperationUnsupported);
        }
        for node in nodes {
            let variable = self.variables.iter().find(|(_, known)| known.id == *node.node_id());
            match variable {
                Some((key, _)) => history::read(&self.records, &self.table, key, details, node),
                None => node.set_status(StatusCode::BadHistoryOperationUnsupported),
            }
        }
        Ok(())
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
                    notify(context, &space, &[id]);
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
            let values =
                [(order, Variant::from(order_id.clone())), (quantity, Variant::from(*pieces))];
            for (id, value) in values {
                if let Some(NodeType::Variable(node)) = space.find_mut(id) {
                    node.set_data_value(DataValue::new_now(value));
                }
            }
            let is_accepted = *pieces > 0;
            notify(context, &space, &[order.clone(), quantity.clone()]);
            call.set_outputs(vec![is_accepted.into()]);
            call.set_status(StatusCode::Good);
        }
        Ok(())
    }
}

/// Notifies subscriptions of the present values of variables.
fn notify(context: &RequestContext, space: &AddressSpace, ids: &[NodeId]) {
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
        metadata.push(NamespaceMetadata {
            namespace_uri: uri,
            namespace_index,
            ..NamespaceMetadata::default()
        });
    }
    let mut uris: Vec<_> = types.namespaces().known_namespaces().iter().collect();
    uris.sort_by_key(|(_, index)| **index);
    let table = NamespaceTable::new(uris.into_iter().map(|(uri, _)| uri));
    (metadata, table)
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
                ModelId { identifier: Identifier::Numeric(id), .. } => {
                    BuiltInType::from_id(u64::from(id)).unwrap_or(BuiltInType::ExtensionObject)
                }
                _ => BuiltInType::ExtensionObject,
            };
            let has_history = plan.has_history;
            (node.key.clone(), Variable { id: id.clone(), built_in, has_history })
        })
        .collect()
}

fn jobs(
    blueprint: &Blueprint,
    ids: &[NodeId],
    variables: &HashMap<String, Variable>,
) -> HashMap<NodeId, (NodeId, NodeId)> {
    let methods =
        blueprint.nodes.iter().zip(ids).filter(|(node, _)| matches!(node.class, Class::StartJob));
    methods
        .filter_map(|(node, id)| {
            let group = node.key.rsplit_once('.')?.0;
            let variable = |name: &str| Some(variables.get(&format!("{group}.{name}"))?.id.clone());
            Some((id.clone(), (variable("OrderId")?, variable("OrderedQuantity")?)))
        })
        .collect()
}
