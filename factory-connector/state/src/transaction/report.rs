//! Reports: one key frame per data set with released values.

use std::collections::BTreeMap;

use asi_model::{DateTime, FieldName};
use disclosure::ReportFrame;
use ledger::{Event, SALT_BYTES, values_root};

use crate::{
    ChangeSet, ConnectorState,
    ledger_chains::single,
    queries::key_frame,
    writes::{CarriedFieldRow, NewReport},
};

/// Largest NetworkMessage in which several reports are sent together, in bytes.
const SHARED_BYTES_MAX: usize = 64 * 1024;

/// Makes the reports of all data sets with released values, with everything that is stored with
/// them, and collects the fields whose gates or transforms changed.
pub(super) fn report(
    state: &mut ConnectorState,
    changes: &mut ChangeSet,
    now: DateTime,
    mut salt: impl FnMut() -> [u8; SALT_BYTES],
) {
    let mut message = SharedMessage::default();
    for id in state.writers.take_unreported() {
        let Some((frame, consents)) = key_frame(state, id, now) else { continue };
        if let Some(report) = queue(state, changes, (id, &frame, consents), now, salt()) {
            message.push(changes, report);
        }
    }
    message.close(changes);
    collect_fields(state, changes);
}

/// Queues a key frame as the writer's next report, and commits to its values in the ledger.
fn queue(
    state: &mut ConnectorState,
    changes: &mut ChangeSet,
    (id, frame, consents): (u16, &ReportFrame, BTreeMap<FieldName, u32>),
    now: DateTime,
    salt: [u8; SALT_BYTES],
) -> Option<NewReport> {
    let body = frame.encode(state.config.encoding);
    let row = state.next_row();
    let (epoch, sequence, carried) = state.writers.take_sequence(id, consents.keys(), now)?;
    let writer = state.writers.get(id)?;
    let request = writer.request().clone();
    changes.writes.writers.carried_fields.extend(carried.into_iter().map(|name| CarriedFieldRow {
        field: request.field(name),
        data_set_writer_id: id,
        epoch,
        first_sequence: sequence,
    }));
    changes.writes.writers.changed.insert(id, writer.row());
    let root = values_root(&body, &salt).expect("our own encoder writes a JSON object");
    let range = single(id, epoch, sequence);
    let event = Event::Queued { range, values: hex::encode(root), consents };
    let recipients = state.networks.recipients(&request).to_vec();
    // Recipients read the chain: it tells no other time of a release than the report does.
    let reported_at = frame.reported_at();
    state.ledger.append(&mut changes.writes.ledger, &recipients, reported_at, Some(row), &event);
    Some(NewReport {
        id: row,
        message: 0,
        data_set_writer_id: id,
        epoch,
        sequence,
        created_at: reported_at,
        recipients,
        body,
        salt,
    })
}

/// Reports that are sent in one NetworkMessage.
#[derive(Default)]
struct SharedMessage {
    reports: Vec<NewReport>,
    bytes: usize,
}

impl SharedMessage {
    fn push(&mut self, changes: &mut ChangeSet, report: NewReport) {
        if !self.reports.is_empty() && self.bytes + report.body.len() > SHARED_BYTES_MAX {
            self.close(changes);
        }
        self.bytes += report.body.len();
        self.reports.push(report);
    }

    /// Numbers the message after its last report.
    fn close(&mut self, changes: &mut ChangeSet) {
        let Some(message) = self.reports.last().map(|report| report.id) else { return };
        let reports = self.reports.drain(..).map(|report| NewReport { message, ..report });
        changes.writes.reports.queued.extend(reports);
        changes.effects.link.is_spool_filled = true;
        self.bytes = 0;
    }
}

/// Collects the fields whose gate or transform changed. Nodes and pages show the newest value that
/// was released, as partners get it, not each of them.
fn collect_fields(state: &mut ConnectorState, changes: &mut ChangeSet) {
    state.fields.take_dirty(|field, has_released| {
        if let Some(value) = field.gate().disclosed().filter(|_| has_released) {
            changes.effects.values.push((field.key().clone(), value.clone()));
            changes.put_event(field);
        }
        changes.writes.fields.values.insert(field.id(), field.value_row());
    });
}
