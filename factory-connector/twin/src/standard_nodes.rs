//! Nodes of the standard, cut to what the twin has: a client may rely on every object, method and value that it finds.

use opcua_stack::{
    opcua::{
        nodes::TypeTree,
        server::{
            ServerHandle, address_space::AddressSpace, node_manager::memory::CoreNodeManager,
        },
        types::{
            BrowseDirection, DataValue, DateTime as StackTime, MethodId, NodeId, ObjectId,
            ReferenceTypeId, VariableId,
        },
    },
    values::time_to_stack,
};

/// Profiles that the twin fulfils; `docs/conformance.md` says what is missing to the Standard server.
pub(crate) const PROFILES: [&str; 3] = [
    "http://opcfoundation.org/UA-Profile/Server/EmbeddedUA2017",
    "http://opcfoundation.org/UA-Profile/Server/Methods",
    "http://opcfoundation.org/UA-Profile/Server/StandardEventSubscription",
];

/// Objects of the standard for which the twin has nothing, each optional where it stands.
const OBJECTS: [ObjectId; 10] = [
    ObjectId::Aliases,
    ObjectId::DefaultHAConfiguration,
    ObjectId::DefaultHEConfiguration,
    ObjectId::Dictionaries,
    ObjectId::Locations,
    ObjectId::PublishSubscribe,
    ObjectId::Quantities,
    ObjectId::Resources,
    ObjectId::ServerConfiguration,
    ObjectId::Server_ServerCapabilities_RoleSet,
];
const METHODS: [MethodId; 2] =
    [MethodId::Server_RequestServerStateChange, MethodId::Server_SetSubscriptionDurable];
const VARIABLES: [VariableId; 10] = [
    VariableId::OPCUANamespaceMetadata_DefaultAccessRestrictions,
    VariableId::OPCUANamespaceMetadata_DefaultRolePermissions,
    VariableId::OPCUANamespaceMetadata_DefaultUserRolePermissions,
    VariableId::Server_EstimatedReturnTime,
    VariableId::Server_ServerCapabilities_ConformanceUnits,
    VariableId::Server_ServerCapabilities_MaxSelectClauseParameters,
    VariableId::Server_ServerCapabilities_MaxWhereClauseParameters,
    VariableId::Server_ServerDiagnostics_SamplingIntervalDiagnosticsArray,
    VariableId::Server_ServerRedundancy_RedundantServerArray,
    VariableId::Server_UrisVersion,
];

/// Removes what the twin does not have, and sets Server.Auditing: clients may rely on audit events.
pub(crate) fn tailor(handle: &ServerHandle) {
    let core = handle.node_managers().get_of_type::<CoreNodeManager>();
    let is_done = core.is_some_and(|core| {
        {
            let types = handle.type_tree().read();
            let mut space = core.address_space().write();
            let absent = OBJECTS.into_iter().map(NodeId::from);
            let absent = absent.chain(METHODS.into_iter().map(NodeId::from));
            for node in absent.chain(VARIABLES.into_iter().map(NodeId::from)) {
                remove(&mut space, &*types, node);
            }
        }
        let auditing = VariableId::Server_Auditing.into();
        core.set_value(handle.subscriptions(), &auditing, None, DataValue::new_now(true)).is_ok()
    });
    if !is_done {
        tracing::warn!("The nodes of the standard could not be fitted to the twin.");
    }
}

/// Removes a node with its components, its properties and what it organizes.
fn remove(space: &mut AddressSpace, types: &dyn TypeTree, node: NodeId) {
    let mut found = vec![node];
    while let Some(node) = found.pop() {
        // The types are not loaded before the server runs, so that subtypes would not be found.
        for kind in [
            ReferenceTypeId::HasComponent,
            ReferenceTypeId::HasProperty,
            ReferenceTypeId::Organizes,
        ] {
            let filter = Some((kind, false));
            let below = space.find_references(&node, filter, types, BrowseDirection::Forward);
            found.extend(below.map(|reference| reference.target_node.clone()));
        }
        space.delete(&node, true);
    }
}

/// Returns the time at which the running program was built: that of its file.
pub(crate) fn build_date() -> StackTime {
    let file = std::env::current_exe().and_then(|file| file.metadata()?.modified());
    file.map_or_else(|_| StackTime::null(), |modified| time_to_stack(modified.into()))
}
