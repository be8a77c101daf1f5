//! Properties of the Server object: namespaces, limits, start time, clock, product and state.

use asi_model::values::{DateTime, Variant};
use opcua_stack::{
    NamespaceTable,
    opcua::{
        client::Session,
        types::{
            DataValue, Error, NodeId, ReadValueId, StatusCode, TimestampsToReturn, VariableId,
        },
    },
    values::from_stack,
};

use super::connection::RESPONSE_TIMEOUT;
use crate::{ServerLimits, ServerProduct, SourceProblem, SourceProblemKind, clock};

/// Longest text of a server about itself, in characters.
const TEXT_CHARS_MAX: usize = 200;

/// Properties read at the start of a session.
pub(super) struct ServerProperties {
    pub(super) namespaces: NamespaceTable,
    pub(super) limits: ServerLimits,
    /// Milliseconds; negative when the server's clock is behind.
    pub(super) clock_ahead_ms: Option<i64>,
    /// Start of the server. After another start node ids may name other nodes.
    pub(super) started_at: Option<DateTime>,
    pub(super) product: ServerProduct,
}

/// Variables in the order in which [`read`] interprets them.
const PROPERTIES: [VariableId; 17] = [
    VariableId::Server_NamespaceArray,
    VariableId::Server_ServerStatus_StartTime,
    VariableId::Server_ServerStatus_CurrentTime,
    VariableId::Server_ServerCapabilities_OperationLimits_MaxNodesPerRead,
    VariableId::Server_ServerCapabilities_OperationLimits_MaxNodesPerWrite,
    VariableId::Server_ServerCapabilities_OperationLimits_MaxNodesPerBrowse,
    VariableId::Server_ServerCapabilities_OperationLimits_MaxNodesPerTranslateBrowsePathsToNodeIds,
    VariableId::Server_ServerCapabilities_OperationLimits_MaxMonitoredItemsPerCall,
    VariableId::Server_ServerCapabilities_MaxMonitoredItemsPerSubscription,
    VariableId::Server_ServerCapabilities_MaxSubscriptionsPerSession,
    VariableId::Server_ServerCapabilities_MaxBrowseContinuationPoints,
    VariableId::Server_ServerStatus_BuildInfo_ProductUri,
    VariableId::Server_ServerStatus_BuildInfo_ProductName,
    VariableId::Server_ServerStatus_BuildInfo_ManufacturerName,
    VariableId::Server_ServerStatus_BuildInfo_SoftwareVersion,
    VariableId::Server_ServerCapabilities_MaxSessions,
    VariableId::Server_ServerCapabilities_MaxMonitoredItemsQueueSize,
];

/// Reads the properties of the server behind a new session.
pub(super) async fn read(session: &Session) -> Result<ServerProperties, SourceProblem> {
    let refused = |reason: String| {
        SourceProblem::new(
            SourceProblemKind::Refused,
            format!("The server's namespaces cannot be read: {reason}."),
        )
    };
    let ids: Vec<_> = PROPERTIES.iter().map(|id| ReadValueId::from(NodeId::from(*id))).collect();
    let requested_at = clock::now();
    let answers = tokio::time::timeout(RESPONSE_TIMEOUT, read_values(session, &ids))
        .await
        .map_err(|_| refused("no response in time".into()))?
        .map_err(|error| refused(error.to_string()))?;
    let answered_at = clock::now();
    let namespaces = answers.first().and_then(|value| value.value.as_ref());
    let namespaces = namespaces.and_then(NamespaceTable::from_namespace_array);
    let namespaces = namespaces.ok_or_else(|| refused("the value is no list of texts".into()))?;
    session.set_namespaces(namespaces.to_namespace_map());

    let values: Vec<_> =
        answers.into_iter().map(|value| from_stack(value, &namespaces).value).collect();
    let time = |index: usize| match values.get(index).and_then(Variant::as_scalar) {
        Some(asi_model::Scalar::DateTime(time)) if *time != DateTime::MIN => Some(*time),
        _ => None,
    };
    // Zero means: no limit.
    let limit = |index: usize| {
        let number =
            values.get(index).and_then(Variant::as_scalar).and_then(asi_model::Scalar::as_i128)?;
        u32::try_from(number).ok().filter(|limit| *limit > 0)
    };
    let limits = ServerLimits {
        nodes_per_read_max: limit(3),
        nodes_per_write_max: limit(4),
        nodes_per_browse_max: limit(5),
        paths_per_translate_max: limit(6),
        items_per_call_max: limit(7),
        items_per_subscription_max: limit(8),
        subscriptions_per_session_max: limit(9),
        browse_continuation_points_max: limit(10),
        sessions_max: limit(15),
        queue_size_max: limit(16),
    };
    let text = |index: usize| {
        let text = values.get(index).and_then(Variant::as_str).unwrap_or_default();
        text.chars().filter(|letter| !letter.is_control()).take(TEXT_CHARS_MAX).collect::<String>()
    };
    let product = ServerProduct {
        product_uri: text(11),
        product_name: text(12),
        manufacturer_name: text(13),
        software_version: text(14),
    };
    // The server read its clock about in the middle between request and answer.
    let middle = requested_at.ticks() + (answered_at.ticks() - requested_at.ticks()) / 2;
    let clock_ahead_ms = time(2).map(|server| (server.ticks() - middle) / 10_000);
    let started_at = time(1);
    Ok(ServerProperties { started_at, namespaces, limits, clock_ahead_ms, product })
}

/// Reads all values in one request, or in halves and parts of them from a server with a lower limit: limits are
/// not known yet.
async fn read_values(session: &Session, ids: &[ReadValueId]) -> Result<Vec<DataValue>, Error> {
    let mut answers = Vec::with_capacity(ids.len());
    let (mut at, mut per_request) = (0, ids.len());
    while at < ids.len() {
        let end = ids.len().min(at + per_request);
        match session.read(&ids[at..end], TimestampsToReturn::Both, 0.0).await {
            Err(error) if error.status() == StatusCode::BadTooManyOperations && per_request > 1 => {
                per_request = per_request.div_ceil(2);
            }
            answered => {
                answers.extend(answered?);
                answers.resize_with(end, DataValue::default);
                at = end;
            }
        }
    }
    Ok(answers)
}

/// Returns true when the server responds and is in a state in which it delivers values.
pub(super) async fn is_running(session: &Session) -> bool {
    let id = ReadValueId::from(NodeId::from(VariableId::Server_ServerStatus_State));
    let answer = tokio::time::timeout(
        RESPONSE_TIMEOUT,
        session.read(&[id], TimestampsToReturn::Server, 0.0),
    )
    .await;
    let Ok(Ok(values)) = answer else { return false };
    let state = values
        .into_iter()
        .next()
        .and_then(|value| value.value)
        .and_then(|value| value.try_cast_to::<i32>().ok());
    // Running (0), CommunicationFault (5) and Test (6). Some servers do not have the variable.
    matches!(state, None | Some(0 | 5 | 6))
}
