//! Effects of a committed transaction, published to log, twin, mapping engine, link and open pages,
//! in this order.

use std::{
    sync::Arc,
    time::{Duration, Instant},
};

use asi_model::OperationNetworkId;
use connector_state::{ConnectorState, Effects, Field, TwinUpdate};
use twin::{AsiDocument, FieldRecord};

use super::{log, outputs::Outputs};
use crate::clock::now;

/// Time for which the twin is brought up to date before other tasks get a turn.
const TURN_MAX: Duration = Duration::from_millis(2);

/// Publishes the effects of a committed transaction.
pub(super) async fn publish_effects(
    outputs: &Outputs,
    state: &ConnectorState,
    mut effects: Effects,
) {
    count(&effects);
    effects.log.iter().for_each(log::write);
    let mut turn = Instant::now();
    for update in effects.twin.drain(..) {
        update_twin(outputs, state, update);
        // After a restart there are thousands of updates.
        if turn.elapsed() >= TURN_MAX {
            tokio::task::yield_now().await;
            turn = Instant::now();
        }
    }
    if !effects.values.is_empty() {
        outputs.twin.publish_values(std::mem::take(&mut effects.values));
    }
    if !effects.engine.is_empty()
        && outputs.mappings.send(std::mem::take(&mut effects.engine)).await.is_err()
    {
        tracing::warn!("The mapping engine has ended; a mapping was not published.");
    }
    if let Some(link) = &outputs.link {
        if effects.link.is_receipted {
            link.receipted(now().into());
        }
        if effects.link.is_spool_rewound {
            link.rewind();
        }
        if effects.link.is_spool_filled {
            link.wake();
        }
    }
    // Pages last: what they read again on an event is up to date by then.
    let events = effects.take_events();
    if !events.is_empty() {
        outputs.events.publish(events);
    }
}

fn count(effects: &Effects) {
    if effects.resent_report_count > 0 {
        metrics::counter!("verbund_reports_resent_total").increment(effects.resent_report_count);
    }
    if effects.decisions.rule_count > 0 {
        metrics::counter!("verbund_rule_decisions_total")
            .increment(effects.decisions.rule_count as u64);
    }
}

fn update_twin(outputs: &Outputs, state: &ConnectorState, update: TwinUpdate) {
    match update {
        TwinUpdate::Apply(id) => {
            if let Some(document) = document(state, &id) {
                outputs.twin.apply(document);
            }
        }
        TwinUpdate::Remove(id) => {
            outputs.twin.remove(&id);
        }
        TwinUpdate::Decision(key) => {
            if let Some(field) = state.field(&key) {
                outputs.twin.publish_decision(&key, field_record(field));
            }
        }
    }
}

fn document(state: &ConnectorState, id: &OperationNetworkId) -> Option<AsiDocument> {
    let network = state.networks().get(id)?;
    let message = network.message.clone()?;
    let requests = message.operation_network.requests();
    let writers = requests
        .filter_map(|(key, ..)| state.writers().id_of(&key).map(|writer| (key, writer)))
        .collect();
    let keys = message.operation_network.fields();
    let fields = keys
        .filter_map(|(key, ..)| state.field(&key).map(|field| (key, field_record(field))))
        .collect();
    Some(AsiDocument { message, received_at: network.received_at, writers, fields })
}

/// Returns a field as the twin shows it.
pub(super) fn field_record(field: &Field) -> FieldRecord {
    let decision = field.decision();
    FieldRecord {
        mapping_state: decision.mapping_state,
        value_source: decision.value_source,
        value: field.gate().disclosed().cloned(),
        disclosure: field.statement().map(|statement| Arc::from(statement.description)),
        reason: decision.reason.as_deref().map(Arc::from),
        decided_by: decision.decided_by.as_deref().map(Arc::from),
        decision_time: decision.decided_at,
    }
}
