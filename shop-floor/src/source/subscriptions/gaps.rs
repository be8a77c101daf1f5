//! Gaps that a lost connection left, filled from the server's history where it has one.

use std::{sync::Arc, time::Duration};

use asi_model::values::{DateTime, NodeId as ModelId, Scalar, Variant};
use opcua_stack::{
    opcua::types::{AttributeId, NodeId, ReadValueId},
    values::node_id_to_stack,
};

use crate::{
    MonitorRequest, ShopFloorError, clock,
    source::{
        connection::Connection,
        memory::SourceMemory,
        notification_sink::NotificationSink,
        services::{PastValues, is_undecoded, read_attributes, read_history},
    },
};

/// Longest gap that is filled; of a longer one the end is.
const GAP_MAX: Duration = Duration::from_secs(3600);
/// Most values that are read for one gap, and for all of a connection.
const VALUES_PER_GAP_MAX: usize = 1000;
const VALUES_MAX: usize = 100_000;
/// Longest time that reading takes: values of now wait for it.
const FILL_MAX: Duration = Duration::from_secs(5);
/// Most nodes that are asked per tick whether they have a history.
const NODES_PER_TICK: usize = 200;
/// Bit of the attribute UserAccessLevel for past values (OPC 10000-3 §8.57, HistoryRead).
const HISTORY_READ: i128 = 1 << 2;

/// Gap in the values of an item that was created.
pub(super) struct ItemGap {
    pub(super) handle: u32,
    pub(super) node_id: NodeId,
    /// Time of the last value before it.
    pub(super) since: DateTime,
}

/// Nodes that are still to be asked whether they have a history; `None` until they are collected.
#[derive(Debug, Default)]
pub(super) struct HistoryLookup {
    missing: Option<Vec<ModelId>>,
}

impl HistoryLookup {
    /// Collects the nodes again: there are other items.
    pub(super) fn reset(&mut self) {
        self.missing = None;
    }

    /// Asks some of the nodes whether they have a history, so that this is known when the connection is lost.
    pub(super) async fn round<'r>(
        &mut self,
        connection: &Connection,
        monitored: impl Iterator<Item = &'r Arc<MonitorRequest>>,
        memory: &mut SourceMemory,
    ) -> Result<(), ShopFloorError> {
        let missing =
            self.missing.get_or_insert_with(|| memory.nodes_of_unknown_history(monitored));
        let batch = missing.split_off(missing.len().saturating_sub(NODES_PER_TICK));
        let namespaces = connection.namespaces();
        let known = batch.into_iter().filter_map(|node| {
            let relocated = memory.relocated(&node).cloned();
            let id = relocated.or_else(|| node_id_to_stack(&node, &namespaces).ok())?;
            Some((ReadValueId::new(id, AttributeId::UserAccessLevel), node))
        });
        let (ids, nodes): (Vec<_>, Vec<_>) = known.unzip();
        if ids.is_empty() {
            return Ok(());
        }
        let levels = match read_attributes(connection, &ids, &namespaces).await {
            Ok(levels) => levels,
            Err(ShopFloorError::Refused { .. }) => return Ok(()),
            Err(error) => return Err(error),
        };
        let has_history = |level: &Variant| {
            let level = level.as_scalar().and_then(Scalar::as_i128);
            level.is_some_and(|level| level & HISTORY_READ != 0)
        };
        memory.learn_history(nodes.into_iter().zip(levels.iter().map(|l| has_history(&l.value))));
        Ok(())
    }
}

/// Fills gaps, or lets the values of now pass without those that were missed.
pub(super) async fn fill(connection: &Connection, sink: &NotificationSink, gaps: Vec<ItemGap>) {
    if gaps.is_empty() {
        return;
    }
    let handles: Vec<u32> = gaps.iter().map(|gap| gap.handle).collect();
    if tokio::time::timeout(FILL_MAX, fill_all(connection, sink, gaps)).await.is_err() {
        tracing::info!("Gaps could not be filled from the history of a server in time.");
    }
    // Those that were not filled.
    for handle in handles {
        sink.fill(handle, Vec::new(), false);
    }
}

async fn fill_all(connection: &Connection, sink: &NotificationSink, gaps: Vec<ItemGap>) {
    let earliest = DateTime::from_ticks(
        clock::now().ticks().saturating_sub(i64::try_from(GAP_MAX.as_nanos() / 100).unwrap_or(0)),
    );
    let mut room = VALUES_MAX;
    for ItemGap { handle, node_id, since } in gaps {
        let start = since.max(earliest);
        let read = read_history(connection, &node_id, start, VALUES_PER_GAP_MAX.min(room)).await;
        let PastValues { mut values, has_more } = match read {
            Ok(past) => past,
            Err(ShopFloorError::Refused { status }) => {
                tracing::info!(node.id = %node_id, %status, "A server refuses the history of a node.");
                PastValues::default()
            }
            // The session ends, or the server has much to do.
            Err(_) => return,
        };
        values.retain(|value| !is_undecoded(value));
        // Some servers return the newest first.
        values.sort_by_key(|value| value.source_timestamp);
        room = room.saturating_sub(values.len());
        sink.fill(handle, values, !has_more && start == since);
        if room == 0 {
            return;
        }
    }
}
