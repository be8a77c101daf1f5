//! Seals of the ledger: the daily checkpoint, and signed heads at the start.

use std::time::Duration;

use asi_model::DateTime;
use ledger::{CheckpointSeal, HeadsCheckpoint, LedgerKey, SignedHead};

use crate::{ChangeSet, ConnectorState, writes::CheckpointRow};

/// Time from one checkpoint to the next: a day, by the clock of the caller.
const CHECKPOINT_INTERVAL: Duration = Duration::from_secs(86_400);

/// Signs a checkpoint over the heads of all chains, where the last one is a day old.
pub fn checkpoint(state: &mut ConnectorState, key: &LedgerKey, now: DateTime) -> ChangeSet {
    let mut changes = ChangeSet::default();
    let (number, is_due) = match state.ledger.last_checkpoint() {
        None => (1, state.ledger.heads().iter().next().is_some()),
        Some((number, at)) => (number + 1, now.since(at) >= CHECKPOINT_INTERVAL),
    };
    if !is_due {
        return changes;
    }
    let factory_id = state.config.factory_id.clone();
    changes.writes.ledger.seal = Some(CheckpointSeal::new(&factory_id, number, key));
    let content = HeadsCheckpoint::new(factory_id, number, now, state.ledger.heads()).canonical();
    changes.writes.ledger.checkpoint = Some(CheckpointRow {
        number,
        recorded_at: now,
        signature: key.sign(&content),
        public_key: key.public(),
        content,
    });
    state.ledger.set_checkpoint(number, now);
    changes
}

/// Signs checkpoints of the logs that grew since their last one.
pub fn checkpoint_logs(state: &mut ConnectorState, key: &LedgerKey) -> ChangeSet {
    let mut changes = ChangeSet::default();
    for log in state.ledger.logs_mut().filter(|log| log.has_grown()) {
        log.sign_checkpoint(key);
        changes.writes.ledger.logs.push(log.clone());
    }
    changes
}

/// Signs the heads of all chains, the number of the checkpoints, and checkpoints of all logs, as they
/// were loaded.
#[must_use]
pub fn sign_all_heads(state: &mut ConnectorState, key: &LedgerKey) -> ChangeSet {
    let mut changes = ChangeSet::default();
    let factory_id = &state.config.factory_id;
    let signed = state.ledger.heads().iter().map(|(recipient, head)| {
        SignedHead::new(factory_id, recipient.clone(), head.number, head.hash, key)
    });
    changes.writes.ledger.heads.extend(signed);
    let number = state.ledger.last_checkpoint().map_or(0, |(number, _)| number);
    changes.writes.ledger.seal = Some(CheckpointSeal::new(factory_id, number, key));
    for log in state.ledger.logs_mut() {
        log.sign_checkpoint(key);
        changes.writes.ledger.logs.push(log.clone());
    }
    changes
}
