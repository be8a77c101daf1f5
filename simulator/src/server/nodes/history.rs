//! Past values of a variable (OPC 10000-11 §6.4.3), in pages.

use asi_model::DateTime;
use opcua_stack::{
    NamespaceTable,
    opcua::{
        server::{ContinuationPoint, node_manager::HistoryNode},
        types::{HistoryData, ReadRawModifiedDetails, StatusCode},
    },
    values::{time_from_stack, to_stack},
};

use crate::records::MachineRecords;

/// Most values of one answer, as small devices have it.
const PAGE: usize = 50;

/// Answers with the next values of a variable.
pub(super) fn read(
    records: &MachineRecords,
    table: &NamespaceTable,
    key: &str,
    details: &ReadRawModifiedDetails,
    node: &mut HistoryNode,
) {
    let next = node.continuation_point().and_then(|point| point.get::<DateTime>()).copied();
    let start = next.unwrap_or_else(|| time_from_stack(details.start_time));
    let end = (!details.end_time.is_null()).then(|| time_from_stack(details.end_time));
    let wanted = match details.num_values_per_node {
        0 => PAGE,
        wanted => usize::try_from(wanted).map_or(PAGE, |wanted| wanted.min(PAGE)),
    };
    let (values, next) = records.values(key, start, end, wanted);
    let values = values.iter().filter_map(|value| to_stack(value, table).ok()).collect();
    node.set_result(HistoryData { data_values: Some(values) });
    node.set_next_continuation_point(next.map(|next| ContinuationPoint::new(Box::new(next))));
    node.set_status(StatusCode::Good);
}
