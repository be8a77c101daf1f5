//! HistoryRead service: raw values of a variable (OPC 10000-11 §6.5.3).

use std::time::Duration;

use asi_model::values::{DataValue, DateTime};
use opcua_stack::{
    opcua::{
        client::HistoryReadAction,
        types::{
            ByteString, HistoryData, HistoryReadValueId, NodeId, NumericRange, QualifiedName,
            ReadRawModifiedDetails, TimestampsToReturn,
        },
    },
    values::{from_stack, status_from_stack, time_to_stack},
};

use crate::{ShopFloorError, clock, source::connection::Connection};

/// Most values of one answer.
const VALUES_PER_ANSWER: usize = 1000;
/// Most answers that are read for one node. A faulty server may return continuation points forever.
const ANSWERS_MAX: usize = 1000;
/// Time by which a server's clock may be ahead.
const CLOCK_AHEAD_MAX: Duration = Duration::from_secs(3600);

/// Past values of a node, oldest first.
#[derive(Debug, Default)]
pub(in crate::source) struct PastValues {
    pub(in crate::source) values: Vec<DataValue>,
    /// True where the server has more.
    pub(in crate::source) has_more: bool,
}

/// Reads the values of a node since a time, that of this time included: the oldest `max`.
pub(in crate::source) async fn read_history(
    connection: &Connection,
    node: &NodeId,
    since: DateTime,
    max: usize,
) -> Result<PastValues, ShopFloorError> {
    let mut past = PastValues::default();
    let mut point = ByteString::null();
    for _ in 0..ANSWERS_MAX {
        let details = ReadRawModifiedDetails {
            is_read_modified: false,
            start_time: time_to_stack(since),
            end_time: time_to_stack(clock::now().after(CLOCK_AHEAD_MAX)),
            num_values_per_node: u32::try_from(VALUES_PER_ANSWER).unwrap_or(u32::MAX),
            return_bounds: false,
        };
        // With enough values the point is released, so that the server can reuse it.
        let is_enough = past.values.len() >= max;
        let nodes = [HistoryReadValueId {
            node_id: node.clone(),
            index_range: NumericRange::None,
            data_encoding: QualifiedName::null(),
            continuation_point: point,
        }];
        let read = connection.session().history_read(
            HistoryReadAction::ReadRawModifiedDetails(details),
            TimestampsToReturn::Both,
            is_enough,
            &nodes,
        );
        let answers = connection.request(read).await;
        if is_enough {
            break;
        }
        let Some(answer) = answers?.into_iter().next() else { break };
        if answer.status_code.is_bad() {
            return Err(ShopFloorError::Refused { status: status_from_stack(answer.status_code) });
        }
        let namespaces = connection.namespaces();
        let data = answer.history_data.into_inner_as::<HistoryData>();
        let values = data.and_then(|data| data.data_values).unwrap_or_default();
        let is_empty = values.is_empty();
        past.values.extend(values.into_iter().map(|value| from_stack(value, &namespaces)));
        point = answer.continuation_point;
        past.has_more = !point.is_null_or_empty();
        if !past.has_more || is_empty {
            break;
        }
    }
    past.has_more |= past.values.len() > max;
    past.values.truncate(max);
    Ok(past)
}
