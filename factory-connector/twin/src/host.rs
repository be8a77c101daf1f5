//! Host of any number of [providers](crate::provider): a node manager in the OPC UA stack.
//!
//! The stack's in-memory manager fixes its namespaces when the server is built, calls methods
//! without the user, and does not notify subscribers of deleted nodes. This one has none of these
//! limits.

mod attributes;
mod browse;
mod manager;
mod paths;

pub(crate) use manager::HostManager;

use std::{collections::HashMap, sync::Arc};

use arc_swap::ArcSwap;
use opcua_stack::opcua::{
    core::sync::RwLock,
    nodes::DefaultTypeTree,
    server::{SubscriptionCache, node_manager::ServerContext},
    types::{AttributeId, DataValue, NodeId, StatusCode, VariableId, Variant},
};

use crate::{
    clock,
    provider::{NodeProvider, ProvidedNode},
};

/// Hosts providers. Shared by the server and the parts of the twin that add and remove providers.
pub(crate) struct NodeHost {
    table: ArcSwap<ProviderTable>,
    type_tree: Arc<RwLock<DefaultTypeTree>>,
    subscriptions: Arc<SubscriptionCache>,
}

/// The providers at one moment.
#[derive(Default, Clone)]
struct ProviderTable {
    providers: Vec<Arc<dyn NodeProvider>>,
    /// Namespace index -> position in `providers`.
    owners: HashMap<u16, usize>,
}

impl ProviderTable {
    fn of(providers: Vec<Arc<dyn NodeProvider>>) -> Self {
        let owners = providers
            .iter()
            .enumerate()
            .flat_map(|(position, provider)| {
                provider.namespaces().into_iter().map(move |n| (n.index, position))
            })
            .collect();
        Self { providers, owners }
    }

    fn owner(&self, node_id: &NodeId) -> Option<&Arc<dyn NodeProvider>> {
        self.owners.get(&node_id.namespace).map(|position| &self.providers[*position])
    }

    fn node(&self, node_id: &NodeId) -> Option<ProvidedNode> {
        self.owner(node_id)?.node(node_id)
    }
}

impl NodeHost {
    /// Creates a host without providers in a server that is being built.
    pub(crate) fn new(context: &ServerContext) -> Self {
        Self {
            table: ArcSwap::default(),
            type_tree: Arc::clone(&context.type_tree),
            subscriptions: Arc::clone(&context.subscriptions),
        }
    }

    /// Returns the index of a namespace, which is added to the server's table if it is new. Indexes
    /// are never reused while the server runs (OPC 10000-3 §8.2.2).
    pub(crate) fn namespace_index(&self, uri: &str) -> u16 {
        self.type_tree.write().namespaces_mut().add_namespace(uri)
    }

    /// Adds a provider; its nodes exist from now on.
    pub(crate) fn add_provider(&self, provider: Arc<dyn NodeProvider>) {
        {
            // Types before nodes: a client that finds a node looks for its type.
            let mut tree = self.type_tree.write();
            for (id, supertype, class) in provider.types() {
                tree.add_type_node(&id, &supertype, class);
            }
        }
        self.table.rcu(|table| {
            let mut providers = table.providers.clone();
            providers.push(Arc::clone(&provider));
            ProviderTable::of(providers)
        });
        tracing::debug!(provider = provider.name(), "The twin hosts a further provider of nodes.");
        self.notify_namespace_array();
    }

    /// Removes a provider with its namespaces.
    pub(crate) fn remove_provider(&self, provider: &Arc<dyn NodeProvider>) {
        // Nodes before types, so that no node is there without its type.
        self.table.rcu(|table| {
            let others =
                table.providers.iter().filter(|other| !Arc::ptr_eq(other, provider)).cloned();
            ProviderTable::of(others.collect())
        });
        {
            let mut tree = self.type_tree.write();
            for (id, _, _) in provider.types() {
                tree.remove(&id);
            }
        }
        let removed =
            DataValue { status: Some(StatusCode::BadNodeIdUnknown), ..DataValue::default() };
        let removed: Vec<_> =
            provider.variables().into_iter().map(|id| (id, removed.clone())).collect();
        self.notify(&removed);
        tracing::debug!(
            provider = provider.name(),
            "The twin no longer hosts a provider of nodes."
        );
        self.notify_namespace_array();
    }

    /// Pushes values into the monitored items of variables.
    pub(crate) fn notify(&self, values: &[(NodeId, DataValue)]) {
        let now = clock::stack_now();
        let changes = values.iter().map(|(id, value)| {
            (DataValue { server_timestamp: Some(now), ..value.clone() }, id, AttributeId::Value)
        });
        self.subscriptions.notify_data_change(changes);
    }

    fn notify_namespace_array(&self) {
        let known: HashMap<u16, String> = {
            let tree = self.type_tree.read();
            tree.namespaces()
                .known_namespaces()
                .iter()
                .map(|(uri, index)| (*index, uri.clone()))
                .collect()
        };
        let owned = &self.table.load().owners;
        let last = known.keys().copied().max().unwrap_or(0);
        // Index 0 is the standard's, 1 the server's own; the others count while a provider has them.
        let uris: Vec<String> = (0..=last)
            .map(|index| match known.get(&index) {
                Some(uri) if index < 2 || owned.contains_key(&index) => uri.clone(),
                _ => String::new(),
            })
            .collect();
        let array = VariableId::Server_NamespaceArray.into();
        self.subscriptions.notify_data_change(
            [(DataValue::new_now(Variant::from(uris)), &array, AttributeId::Value)].into_iter(),
        );
    }
}
