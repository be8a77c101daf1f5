//! Log of what committed transactions did.

use connector_state::LogRecord;

/// Writes a record of a committed transaction to the log, and counts it where it is counted.
pub(super) fn write(record: &LogRecord) {
    match record {
        LogRecord::NetworkReceived { network, revision } => {
            tracing::info!(operation.network = %network, revision, "An operation network is in effect.");
        }
        LogRecord::NetworkWithdrawn { network, revision } => {
            tracing::info!(operation.network = %network, revision, "An operation network was withdrawn.");
        }
        LogRecord::MessageRejected { message_id, fault_count } => {
            metrics::counter!("verbund_messages_rejected_total").increment(1);
            tracing::warn!(message.id = %message_id, faults = fault_count, "A message was rejected and answered.");
        }
        LogRecord::RulesDecided { network, field_count } => {
            tracing::info!(operation.network = %network, fields = field_count, "Standing rules decided about new fields.");
        }
        LogRecord::RuleNotApplied { field, reason } => {
            tracing::warn!(%field, reason, "A standing rule could not be applied; the field waits for an engineer.");
        }
        LogRecord::FieldsHeldBack { cap, field_count } => {
            metrics::counter!("verbund_fields_held_back_total").increment(*field_count as u64);
            tracing::warn!(%cap, fields = field_count, "A cap holds fields back: their consents ended.");
        }
        LogRecord::RequestEnded { field } => {
            tracing::info!(%field, "The request's validity has ended; nothing of the field is disclosed any more.");
        }
        LogRecord::WriterMissing { request } => {
            tracing::error!(%request, "A request has no data set writer: all 65 535 are taken.");
        }
        LogRecord::EpochsBegun => {
            tracing::warn!(
                "The store was restored, moved, copied or migrated; every data set writer began a new epoch."
            );
        }
        LogRecord::PastReleased { request, recipient, report_count } => {
            tracing::info!(%request, %recipient, reports = report_count, "A recipient that was added later sees reports of the past.");
        }
        LogRecord::ReportsCoalesced { report_count } => {
            metrics::counter!("verbund_reports_coalesced_total").increment(*report_count as u64);
            tracing::warn!(
                reports = report_count,
                "The spool is full; older reports were dropped for newer ones."
            );
        }
        LogRecord::LogWitnessed { .. }
        | LogRecord::WitnessChanged { .. }
        | LogRecord::WitnessForgot { .. }
        | LogRecord::WitnessNotUnderstood { .. }
        | LogRecord::LedgerConflict { .. }
        | LogRecord::LogReplaced { .. } => write_witness(record),
    }
}

/// Writes and counts what the platform said as the witness of the ledger.
fn write_witness(record: &LogRecord) {
    let count = |result: &'static str| {
        metrics::counter!("verbund_ledger_witness_answers_total", "result" => result).increment(1);
    };
    match record {
        LogRecord::LogWitnessed { origin } => {
            count("cosigned");
            tracing::debug!(log = origin, "The platform countersigned a checkpoint of the ledger.");
        }
        LogRecord::WitnessChanged { origin } => {
            tracing::warn!(
                log = origin,
                "The platform countersigns the ledger with another key than before."
            );
        }
        LogRecord::WitnessForgot { origin, former_size } => {
            count("forgotten");
            tracing::warn!(
                log = origin,
                size = former_size,
                "The platform has lost what it had countersigned of the ledger; it begins again \
                 with the next checkpoint."
            );
        }
        LogRecord::WitnessNotUnderstood { origin, reason } => {
            count("invalid");
            tracing::warn!(
                log = origin,
                reason,
                "An answer of the platform to a checkpoint of the ledger proves nothing."
            );
        }
        LogRecord::LedgerConflict { origin, kind } => {
            count("conflict");
            tracing::error!(
                log = origin,
                ?kind,
                "The platform holds another history of the ledger: the store was set back, cut or \
                 replaced. Nothing is disclosed until an engineer restores the newest store, or \
                 begins a new log on the page of the ledger."
            );
        }
        LogRecord::LogReplaced { origin } => {
            tracing::warn!(log = origin, "An engineer began a new log of the ledger.");
        }
        _ => {}
    }
}
