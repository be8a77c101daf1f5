//! Refresh of conditions (OPC 10000-9 §5.5.7): the methods by which clients learn what is active.
//!
//! They belong to the type of all conditions, so a node manager of its own has them, which comes before that of the
//! standard's nodes.

use async_trait::async_trait;
use opcua_stack::opcua::{
    nodes::{DefaultTypeTree, Event},
    server::{
        diagnostics::NamespaceMetadata,
        node_manager::{
            BrowseNode, MethodCall, NodeManager, NodeManagersRef, ReadNode, RequestContext,
            ServerContext,
            memory::{CoreNodeManager, InMemoryNodeManager},
        },
    },
    types::{
        AttributeId, MethodId, NodeId, ObjectId, ObjectTypeId, StatusCode, TimestampsToReturn,
        Variant,
    },
};

use super::{events::ShownEvent, nodes::MachineNodes};
use crate::{MachineEvent, clock};

pub(super) struct ConditionMethods {
    managers: NodeManagersRef,
    /// ConditionRefresh and ConditionRefresh2.
    of_subscription: NodeId,
    of_item: NodeId,
}

impl ConditionMethods {
    pub(super) fn new(context: &ServerContext) -> Self {
        Self {
            managers: context.node_managers.clone(),
            of_subscription: MethodId::ConditionType_ConditionRefresh.into(),
            of_item: MethodId::ConditionType_ConditionRefresh2.into(),
        }
    }

    /// Names all conditions to the event items of a subscription, or to one of them.
    fn refresh(
        &self,
        context: &RequestContext,
        subscription: u32,
        only: Option<u32>,
    ) -> Result<(), StatusCode> {
        let machine = self.managers.get_of_type::<InMemoryNodeManager<MachineNodes>>();
        let machine = machine.ok_or(StatusCode::BadShutdown)?;
        let (root, server) = (machine.inner().root(), NodeId::from(ObjectId::Server));
        let mark = |event_type: ObjectTypeId| {
            let event = MachineEvent { message: String::new(), severity: 100 };
            ShownEvent::new(event_type, &event, (&server, "Server"), clock::now())
        };
        let mut events = vec![mark(ObjectTypeId::RefreshStartEventType)];
        events.extend(machine.inner().retained());
        events.push(mark(ObjectTypeId::RefreshEndEventType));

        let subscriptions = context.subscriptions.get_session_subscriptions(context.session_id);
        let subscriptions = subscriptions.ok_or(StatusCode::BadSubscriptionIdInvalid)?;
        let mut subscriptions = subscriptions.lock();
        let subscription =
            subscriptions.get_mut(subscription).ok_or(StatusCode::BadSubscriptionIdInvalid)?;
        let items = subscription.items().filter(|item| {
            let target = item.item_to_monitor();
            target.attribute_id == AttributeId::EventNotifier
                && (target.node_id == *root || target.node_id == server)
                && only.is_none_or(|only| only == item.id())
        });
        let items: Vec<u32> = items.map(|item| item.id()).collect();
        if items.is_empty() && only.is_some() {
            return Err(StatusCode::BadMonitoredItemIdInvalid);
        }
        let types = context.type_tree.read();
        for item in items {
            for event in &events {
                subscription.notify_event(&item, event as &dyn Event, &*types);
            }
        }
        Ok(())
    }
}

#[async_trait]
impl NodeManager for ConditionMethods {
    fn owns_node(&self, id: &NodeId) -> bool {
        *id == self.of_subscription || *id == self.of_item
    }

    fn name(&self) -> &str {
        "conditions"
    }

    fn namespaces_for_user(&self, _context: &RequestContext) -> Vec<NamespaceMetadata> {
        Vec::new()
    }

    async fn init(&self, _types: &mut DefaultTypeTree, _context: ServerContext) {}

    /// Leaves the attributes of the methods to the manager of the standard's nodes.
    async fn read(
        &self,
        context: &RequestContext,
        max_age: f64,
        timestamps_to_return: TimestampsToReturn,
        nodes_to_read: &mut [&mut ReadNode],
    ) -> Result<(), StatusCode> {
        let standard = self.managers.get_of_type::<CoreNodeManager>();
        let standard = standard.ok_or(StatusCode::BadShutdown)?;
        standard.read(context, max_age, timestamps_to_return, nodes_to_read).await
    }

    /// Leaves the references of the methods to the managers that come later.
    async fn browse(
        &self,
        _context: &RequestContext,
        _nodes_to_browse: &mut [BrowseNode],
    ) -> Result<(), StatusCode> {
        Ok(())
    }

    async fn call(
        &self,
        context: &RequestContext,
        methods_to_call: &mut [&mut MethodCall],
    ) -> Result<(), StatusCode> {
        for call in methods_to_call {
            let result = match call.arguments() {
                [Variant::UInt32(subscription)] if *call.method_id() == self.of_subscription => {
                    self.refresh(context, *subscription, None)
                }
                [Variant::UInt32(subscription), Variant::UInt32(item)]
                    if *call.method_id() == self.of_item =>
                {
                    self.refresh(context, *subscription, Some(*item))
                }
                _ => Err(StatusCode::BadInvalidArgument),
            };
            call.set_status(result.err().unwrap_or(StatusCode::Good));
        }
        Ok(())
    }
}
