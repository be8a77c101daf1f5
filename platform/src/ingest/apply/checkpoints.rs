//! Checkpoints of factories' ledgers: judged, stored and answered in one transaction.

use asi_model::messages::{LedgerCheckpoint, LedgerCheckpointResult, LedgerCosignature};
use messaging::LogicalAddress;

use crate::{
    clock::new_message_id,
    ingest::{decode::Incoming, unit::IngestUnit},
    store::StoreError,
    witness::WitnessKey,
};

/// Applies a checkpoint. Comparing with the log that is held and storing the new one is one step:
/// units of ingest follow each other.
pub(super) async fn receive(
    unit: &mut IngestUnit<'_>,
    witness: &WitnessKey,
    address: &LogicalAddress,
    incoming: &Incoming,
    message: &LedgerCheckpoint,
) -> Result<(), StoreError> {
    let (factory, recipient) = (&message.factory_id, &message.recipient_id);
    if !unit.work.organisations().exists(recipient).await? {
        let reason = format!("There is no organisation {recipient}.");
        return unit.reject(address, incoming, "UNKNOWN_ORGANISATION", reason).await;
    }
    let newest = unit.work.ledger_logs().newest(factory, recipient).await?;
    let judgement = match witness.judge(message, newest.as_ref(), unit.now) {
        Ok(judgement) => judgement,
        Err(reason) => {
            return unit.reject(address, incoming, "INVALID_CHECKPOINT", reason).await;
        }
    };
    count(message, judgement.result);
    if let Some(log) = &judgement.log {
        unit.work.ledger_logs().put(factory, recipient, log).await?;
    }
    let held = judgement.log.or(newest);
    let answer = LedgerCosignature {
        message_id: new_message_id(),
        factory_id: factory.clone(),
        correlation_id: message.message_id.clone(),
        recipient_id: recipient.clone(),
        epoch: held.as_ref().map_or(message.epoch, |log| log.epoch),
        result: judgement.result,
        checkpoint: held.map(|log| log.checkpoint.to_string()),
        witness_key: witness.verifier().to_string(),
    };
    unit.cosign(answer).await
}

fn count(message: &LedgerCheckpoint, result: LedgerCheckpointResult) {
    let (name, is_conflict) = match result {
        LedgerCheckpointResult::Cosigned => ("cosigned", false),
        LedgerCheckpointResult::Stale => ("stale", false),
        LedgerCheckpointResult::Inconsistent => ("inconsistent", true),
        LedgerCheckpointResult::OtherKey => ("other_key", true),
    };
    metrics::counter!("verbund_ledger_checkpoints_total", "result" => name).increment(1);
    if is_conflict {
        tracing::warn!(
            factory.id = %message.factory_id,
            recipient = %message.recipient_id,
            result = name,
            "A checkpoint of a factory's ledger contradicts the one that is held; it was refused."
        );
    }
}
