//! Node manager: the services that the stack requests from the host.

use std::sync::Arc;

use async_trait::async_trait;
use futures::future::join_all;
use opcua_stack::opcua::{
    nodes::DefaultTypeTree,
    server::{
        CreateMonitoredItem,
        diagnostics::NamespaceMetadata,
        node_manager::{
            BrowseNode, BrowsePathItem, ExternalReferenceRequest, MethodCall, MonitoredItemRef,
            NodeManager, ReadNode, RequestContext, ServerContext, WriteNode,
        },
    },
    types::{AttributeId, IdType, NodeClass, NodeId, StatusCode, TimestampsToReturn},
};

use super::{NodeHost, attributes, browse, browse::metadata, paths};
use crate::{
    provider::{MethodOutcome, NodeKind, WriteRequest},
    session_token::user_of,
};

/// The host behind the interface of the stack.
pub(crate) struct HostManager(pub(crate) Arc<NodeHost>);

// The trait leaves this lifetime out, and an implementation has to do the same.
#[allow(elided_lifetimes_in_paths)]
#[async_trait]
impl NodeManager for HostManager {
    fn owns_node(&self, id: &NodeId) -> bool {
        self.0.table.load().owners.contains_key(&id.namespace)
    }

    fn name(&self) -> &str {
        "twin"
    }

    fn namespaces_for_user(&self, _context: &RequestContext) -> Vec<NamespaceMetadata> {
        let table = self.0.table.load();
        table
            .providers
            .iter()
            .flat_map(|provider| provider.namespaces())
            .map(|namespace| NamespaceMetadata {
                is_namespace_subset: Some(false),
                namespace_uri: namespace.uri,
                namespace_version: namespace.version,
                static_node_id_types: Some(vec![IdType::Numeric, IdType::String]),
                namespace_index: namespace.index,
                ..NamespaceMetadata::default()
            })
            .collect()
    }

    async fn init(&self, _type_tree: &mut DefaultTypeTree, _context: ServerContext) {
        // Providers bring their types when they are added, before the server runs or while it does.
    }

    async fn resolve_external_references(
        &self,
        _context: &RequestContext,
        items: &mut [&mut ExternalReferenceRequest],
    ) {
        let table = self.0.table.load();
        for item in items {
            if let Some(node) = table.node(item.node_id()) {
                item.set(metadata(item.node_id().clone(), node));
            }
        }
    }

    async fn read(
        &self,
        context: &RequestContext,
        _max_age: f64,
        timestamps_to_return: TimestampsToReturn,
        nodes_to_read: &mut [&mut ReadNode],
    ) -> Result<(), StatusCode> {
        let (table, role) = (self.0.table.load(), user_of(&context.token).role);
        for node in nodes_to_read {
            let value = attributes::read(&table, node.node(), role, timestamps_to_return);
            node.set_result(value);
        }
        Ok(())
    }

    async fn write(
        &self,
        context: &RequestContext,
        nodes_to_write: &mut [&mut WriteNode],
    ) -> Result<(), StatusCode> {
        let user = user_of(&context.token);
        let table = self.0.table.load_full();
        // All at once, so that they share a commit; started in order, so that writes to one node
        // stay in order.
        let writes = nodes_to_write.iter_mut().map(|node| {
            let (table, user) = (&table, &user);
            async move {
                let value = node.value();
                let status = match table.owner(&value.node_id) {
                    Some(_) if attributes::is_absent(table, &value.node_id, value.attribute_id) => {
                        StatusCode::BadAttributeIdInvalid
                    }
                    Some(provider) => {
                        let request = WriteRequest {
                            node_id: &value.node_id,
                            attribute: value.attribute_id,
                            has_index_range: value.index_range.has_range(),
                            value: &value.value,
                        };
                        provider.write(user, request).await
                    }
                    None => StatusCode::BadNodeIdUnknown,
                };
                node.set_status(status);
            }
        });
        join_all(writes).await;
        Ok(())
    }

    async fn browse(
        &self,
        context: &RequestContext,
        nodes_to_browse: &mut [BrowseNode],
    ) -> Result<(), StatusCode> {
        let table = self.0.table.load();
        let types = context.type_tree.read();
        for node in nodes_to_browse {
            browse::browse(&table, node, &*types);
        }
        Ok(())
    }

    async fn translate_browse_paths_to_node_ids(
        &self,
        context: &RequestContext,
        nodes: &mut [&mut BrowsePathItem],
    ) -> Result<(), StatusCode> {
        let table = self.0.table.load();
        let types = context.type_tree.read();
        for item in nodes {
            paths::translate(&table, item, context, &*types);
        }
        Ok(())
    }

    async fn create_monitored_items(
        &self,
        context: &RequestContext,
        items: &mut [&mut CreateMonitoredItem],
    ) -> Result<(), StatusCode> {
        let (table, role) = (self.0.table.load(), user_of(&context.token).role);
        for item in items {
            let target = item.item_to_monitor();
            if target.attribute_id == AttributeId::EventNotifier {
                let status = match table.node(&target.node_id).map(|node| node.class.node_class()) {
                    None => StatusCode::BadNodeIdUnknown,
                    // The objects are no notifiers; the Server object reports events.
                    Some(NodeClass::Object) => StatusCode::BadNotSupported,
                    Some(_) => StatusCode::BadAttributeIdInvalid,
                };
                item.set_status(status);
                continue;
            }
            // Of a value there may be a part later, of another attribute never.
            if target.attribute_id != AttributeId::Value && target.index_range.has_range() {
                item.set_status(StatusCode::BadIndexRangeNoData);
                continue;
            }
            // The stack takes the item's part out of it, and the timestamps that the client wants.
            let whole = item.whole_item();
            let value = attributes::read(&table, &whole, role, TimestampsToReturn::Both);
            // A value whose status is bad can be monitored; a node or attribute that does not exist
            // cannot.
            match value.status() {
                status @ (StatusCode::BadNodeIdUnknown
                | StatusCode::BadAttributeIdInvalid
                | StatusCode::BadDataEncodingInvalid) => item.set_status(status),
                _ => {
                    item.set_initial_value(value);
                    item.set_status(StatusCode::Good);
                }
            }
        }
        Ok(())
    }

    async fn monitored_items_created(
        &self,
        _context: &RequestContext,
        items: &[&MonitoredItemRef],
    ) {
        let table = self.0.table.load_full();
        for provider in &table.providers {
            let owned: Vec<&MonitoredItemRef> = items
                .iter()
                .copied()
                .filter(|item| {
                    table.owner(item.node_id()).is_some_and(|owner| Arc::ptr_eq(owner, provider))
                })
                .collect();
            if !owned.is_empty() {
                provider.publish_present(&owned);
            }
        }
    }

    async fn call(
        &self,
        context: &RequestContext,
        methods_to_call: &mut [&mut MethodCall],
    ) -> Result<(), StatusCode> {
        let user = user_of(&context.token);
        let table = self.0.table.load_full();
        for call in methods_to_call {
            // A method of a type may be called on an object, so the object selects the provider.
            let outcome = match table.owner(call.object_id()) {
                // The stack has checked that there is such an object.
                None => MethodOutcome::failed(StatusCode::BadMethodInvalid),
                Some(provider) if provider.node(call.object_id()).is_none() => {
                    MethodOutcome::failed(StatusCode::BadNodeIdUnknown)
                }
                Some(provider) => match table.node(call.method_id()).map(|node| node.class) {
                    Some(NodeKind::Method { callable_by }) if user.role.includes(callable_by) => {
                        provider
                            .call(&user, call.object_id(), call.method_id(), call.arguments())
                            .await
                    }
                    Some(NodeKind::Method { .. }) => {
                        MethodOutcome::failed(StatusCode::BadUserAccessDenied)
                    }
                    _ => MethodOutcome::failed(StatusCode::BadMethodInvalid),
                },
            };
            if !outcome.argument_statuses.is_empty() {
                call.set_argument_error(outcome.argument_statuses);
            }
            call.set_status(outcome.status);
            call.set_outputs(outcome.outputs);
        }
        Ok(())
    }
}
