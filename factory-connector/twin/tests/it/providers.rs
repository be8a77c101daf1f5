//! Providers that are added and removed while clients are connected.

use std::{ops::ControlFlow, sync::Arc};

use async_trait::async_trait;
use opcua_stack::opcua::{
    server::node_manager::MonitoredItemRef,
    types::{
        AttributeId, BrowseDirection, DataTypeId, DataValue, LocalizedText, NodeId, ObjectId,
        QualifiedName, ReferenceTypeId, StatusCode, VariableTypeId, Variant,
    },
};
use parking_lot::Mutex;
use twin::{
    TwinUser,
    provider::{
        MethodOutcome, NodeKind, NodeProvider, ProvidedNamespace, ProvidedNode, ProvidedReference,
        ReferenceVisitor, WriteRequest,
    },
};

use crate::harness::{TestTwin, next};

const URI: &str = "urn:example:skills";

/// Provider of one variable below the Objects folder.
struct Skills {
    index: u16,
    /// Numbers of the items whose present values it was asked to publish.
    published: Mutex<Vec<usize>>,
}

impl Skills {
    fn new(index: u16) -> Self {
        Self { index, published: Mutex::default() }
    }

    fn id(&self) -> NodeId {
        NodeId::new(self.index, "Gripper")
    }
}

#[async_trait]
impl NodeProvider for Skills {
    fn name(&self) -> &'static str {
        "skills"
    }

    fn namespaces(&self) -> Vec<ProvidedNamespace> {
        vec![ProvidedNamespace { index: self.index, uri: URI.to_owned(), version: None }]
    }

    fn node(&self, node_id: &NodeId) -> Option<ProvidedNode> {
        (*node_id == self.id()).then(|| ProvidedNode {
            browse_name: QualifiedName::new(self.index, "Gripper"),
            display_name: LocalizedText::from("Gripper"),
            description: LocalizedText::null(),
            type_definition: Some(VariableTypeId::BaseDataVariableType.into()),
            class: NodeKind::Variable {
                data_type: DataTypeId::Int32.into(),
                value_rank: -1,
                is_writable: false,
            },
        })
    }

    fn value(&self, node_id: &NodeId) -> Option<DataValue> {
        (*node_id == self.id()).then(|| DataValue::new_now(1_i32))
    }

    fn references(&self, node_id: &NodeId, after: u64, visit: &mut ReferenceVisitor<'_>) {
        if *node_id == ObjectId::ObjectsFolder && after == 0 {
            let reference_type = ReferenceTypeId::Organizes.into();
            let _: ControlFlow<()> =
                visit(1, ProvidedReference { reference_type, is_forward: true, target: self.id() });
        }
    }

    fn variables(&self) -> Vec<NodeId> {
        vec![self.id()]
    }

    fn publish_present(&self, items: &[&MonitoredItemRef]) {
        self.published.lock().push(items.len());
    }

    async fn write(&self, _user: &TwinUser, _request: WriteRequest<'_>) -> StatusCode {
        StatusCode::BadNotWritable
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

#[tokio::test]
async fn a_provider_is_added_and_removed_while_clients_are_connected() {
    let twin = TestTwin::start().await;
    let client = twin.client("vera").await;
    let mut namespaces = client
        .subscribe(&[opcua_stack::opcua::types::VariableId::Server_NamespaceArray.into()])
        .await;
    let before = next(&mut namespaces).await.1;

    let index = twin.handle.namespace_index(URI);
    let provider = Arc::new(Skills::new(index));
    let skills: Arc<dyn NodeProvider> = Arc::clone(&provider) as _;
    twin.handle.add_provider(Arc::clone(&skills));
    assert_ne!(next(&mut namespaces).await.1.value, before.value, "the new namespace is announced");
    let known = client.session.read_namespace_array().await.unwrap();
    assert_eq!(known.get_index(URI), Some(index));
    let id = NodeId::new(index, "Gripper");
    let found = client.browse(ObjectId::ObjectsFolder, BrowseDirection::Forward).await;
    assert!(found.iter().any(|r| r.node_id.node_id == id));

    let mut changes = client.subscribe(std::slice::from_ref(&id)).await;
    assert_eq!(next(&mut changes).await.1.value, Some(1_i32.into()));
    // What changed between the first read and the registration of the item would be lost otherwise.
    assert_eq!(*provider.published.lock(), [1]);
    twin.handle.notify_values(&[(id.clone(), DataValue::new_now(2_i32))]);
    assert_eq!(next(&mut changes).await.1.value, Some(2_i32.into()));

    twin.handle.remove_provider(&skills);
    assert_eq!(next(&mut changes).await.1.status(), StatusCode::BadNodeIdUnknown);
    assert_eq!(
        client.attribute(&id, AttributeId::DisplayName).await.status(),
        StatusCode::BadNodeIdUnknown
    );
    let known = client.session.read_namespace_array().await.unwrap();
    assert_eq!(known.get_index(URI), None);
    assert_eq!(twin.handle.namespace_index(URI), index, "an index stays with its namespace");
    client.close().await;
    twin.stop().await;
}
