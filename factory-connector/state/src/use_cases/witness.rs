//! Witness of the ledger: the platform countersigns the logs' checkpoints, and shows by those that it
//! holds where a store was set back, cut or replaced.

use asi_model::{
    DateTime, OrganisationId,
    messages::{FactoryMessage, LedgerCheckpoint, LedgerCosignature},
};
use ledger::{Answered, HeldCheckpoint, LedgerKey, Log, LogStart, Predecessor};
use transparency_log::LeafRange;

use crate::{ChangeSet, ConnectorEvent, ConnectorState, LogRecord};

/// Decision of an engineer to replace a log by a new one.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NewLogDecision {
    /// Organisation of the chain.
    pub recipient: OrganisationId,
    /// Name of the user.
    pub decided_by: String,
    /// Reason in words; the recipient reads it in an audit file.
    pub reason: String,
}

/// Submits the checkpoints of the logs that grew.
pub fn submit_due(state: &mut ConnectorState, key: &LedgerKey, now: DateTime) -> ChangeSet {
    let logs = state.ledger.logs_mut().filter(|log| log.witnessing().is_due(now));
    let recipients = logs.map(|log| log.start().recipient.clone()).collect();
    submit(state, recipients, key, now)
}

/// Submits the checkpoints of all logs, as at a start: the platform may know more than the store.
pub fn submit_all(state: &mut ConnectorState, key: &LedgerKey, now: DateTime) -> ChangeSet {
    let recipients = state.ledger.logs_mut().map(|log| log.start().recipient.clone()).collect();
    submit(state, recipients, key, now)
}

/// Takes an answer of the platform, as far as the state can judge it. Returns the checkpoint with
/// which the stored entries have to be [compared](compare) before the answer has an effect.
pub fn receive_answer(
    state: &mut ConnectorState,
    answer: &LedgerCosignature,
    key: &LedgerKey,
    now: DateTime,
) -> (Option<HeldCheckpoint>, ChangeSet) {
    let mut changes = ChangeSet::default();
    let held = state.ledger.change_log(&answer.recipient_id, |log| {
        match log.receive(answer, key, now) {
            Ok(Answered::OtherSize(held)) => return Some(held),
            Ok(answered) => note(log, answered, &mut changes),
            Err(error) => changes.effects.log.push(LogRecord::WitnessNotUnderstood {
                origin: log.start().origin(),
                reason: error.to_string(),
            }),
        }
        None
    });
    (held.flatten(), changes)
}

/// Compares a checkpoint that the platform holds with the leaves before it and those since; `None`
/// where their entries are removed.
pub fn compare(
    state: &mut ConnectorState,
    recipient: &OrganisationId,
    held: HeldCheckpoint,
    leaves: Option<(LeafRange, LeafRange)>,
    now: DateTime,
) -> ChangeSet {
    let mut changes = ChangeSet::default();
    // Without the log there is nothing to compare.
    let _: Option<()> = state.ledger.change_log(recipient, |log| {
        let answered = log.compare(held, leaves, now);
        note(log, answered, &mut changes);
    });
    changes
}

/// Returns the first leaf of the log that would replace the recipient's; `None` unless there is a
/// conflict about it. `previous` is the entry before the first one that the store still has.
#[must_use]
pub fn successor(
    state: &ConnectorState,
    decision: &NewLogDecision,
    previous: &ledger::Head,
    now: DateTime,
) -> Option<LogStart> {
    let log = state.ledger.log(&decision.recipient)?;
    let conflict = log.witnessing().conflict()?;
    Some(LogStart {
        factory_id: state.config.factory_id.clone(),
        recipient: decision.recipient.clone(),
        number: previous.number,
        hash: hex::encode(previous.hash),
        epoch: log.start().epoch.max(conflict.epoch) + 1,
        predecessor: Some(Predecessor {
            checkpoint: conflict.checkpoint.clone(),
            decided_by: decision.decided_by.clone(),
            decided_at: now,
            reason: decision.reason.clone(),
        }),
    })
}

/// Replaces a log by a new one with all its entries, which ends its conflict, and submits it.
pub fn replace_log(
    state: &mut ConnectorState,
    log: Log,
    key: &LedgerKey,
    now: DateTime,
) -> ChangeSet {
    let recipient = log.start().recipient.clone();
    let mut changes = ChangeSet::default();
    changes.effects.log.push(LogRecord::LogReplaced { origin: log.start().origin() });
    changes.effects.events.push(ConnectorEvent::Status);
    // What was held back may leave: the link has read past it.
    changes.effects.link.is_spool_rewound = true;
    state.ledger.put_log(log);
    changes.merge(submit(state, vec![recipient], key, now));
    changes
}

fn submit(
    state: &mut ConnectorState,
    recipients: Vec<OrganisationId>,
    key: &LedgerKey,
    now: DateTime,
) -> ChangeSet {
    let mut changes = ChangeSet::default();
    for recipient_id in recipients {
        let submitted = state.ledger.change_log(&recipient_id, |log| {
            let verifier = log.start().verifier(&key.public()).ok()?;
            let request = log.submit(key, now);
            Some((verifier, request, log.clone()))
        });
        let Some((verifier, request, log)) = submitted.flatten() else { continue };
        let epoch = log.start().epoch;
        changes.writes.ledger.logs.push(log.clone());
        changes.writes.ledger.witnessed.push(log);
        let message = FactoryMessage::LedgerCheckpoint(LedgerCheckpoint {
            message_id: state.ids.next_message_id(),
            factory_id: state.config.factory_id.clone(),
            recipient_id,
            epoch,
            verifier_key: verifier.to_string(),
            add_checkpoint: request.to_string(),
        });
        state.send(&mut changes, &message, None, now);
    }
    changes
}

/// Puts an effect on a log among the changes.
fn note(log: &Log, answered: Answered, changes: &mut ChangeSet) {
    let origin = log.start().origin();
    let records = &mut changes.effects.log;
    match answered {
        Answered::Outdated | Answered::OtherSize(_) => return,
        Answered::Cosigned { is_other_witness } => {
            if is_other_witness {
                records.push(LogRecord::WitnessChanged { origin: origin.clone() });
            }
            records.push(LogRecord::LogWitnessed { origin });
        }
        Answered::Forgotten { former_size } => {
            records.push(LogRecord::WitnessForgot { origin, former_size });
        }
        Answered::Conflict => {
            if let Some(conflict) = log.witnessing().conflict() {
                records.push(LogRecord::LedgerConflict { origin, kind: conflict.kind });
            }
            changes.effects.events.push(ConnectorEvent::Status);
        }
    }
    changes.writes.ledger.witnessed.push(log.clone());
}
