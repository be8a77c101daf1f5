//! Values: through the gate, into reports. This is the only way a value leaves.

use std::{
    collections::{BTreeMap, BTreeSet},
    sync::Arc,
};

use asi_model::{
    DataValue, DateTime, FieldKey, FieldName,
    messages::ValueSource,
    pubsub::{
        DataSetMessage, PayloadField, ReportHeader, json::encode_data_set_message, unit_member,
    },
};
use mapping_engine::TransformState;

use super::{Books, Marks, field::Field, range_of};
use crate::store::{CarriedFieldRow, NewReport};
use disclosure::{Gate, GateOutcome};
use ledger::{Event, SALT_BYTES, values_root};

/// Largest NetworkMessage that several reports share, in bytes.
const SHARED_BYTES_MAX: usize = 64 * 1024;

/// Where it is noted what follows from a field's value.
struct Follows<'b> {
    dirty_fields: &'b mut Vec<i64>,
    dirty_writers: &'b mut BTreeSet<u16>,
    due: &'b mut BTreeSet<(DateTime, i64)>,
}

impl Follows<'_> {
    /// Whatever a field's gate is told, and what follows from it.
    fn through_gate<T>(
        &mut self,
        field: &mut Field,
        now: DateTime,
        tell: impl FnOnce(&mut Gate) -> T,
    ) -> T {
        let told = tell(&mut field.gate);
        field.mark_dirty(self.dirty_fields);
        field.note_due(self.due);
        if field.gate.take_released() {
            field.traffic.left(now);
            if !std::mem::replace(&mut field.marks.has_left, true) {
                self.dirty_writers.insert(field.writer);
            }
        }
        told
    }
}

impl Books {
    /// A candidate for a field, whoever brought it. `None` where the field takes none from this
    /// source.
    pub fn candidate(
        &mut self,
        key: &FieldKey,
        source: ValueSource,
        value: DataValue,
        transform: Option<TransformState>,
        now: DateTime,
    ) -> Option<GateOutcome> {
        let number = self.fields.get(key)?.id;
        self.candidate_for(number, source, value, transform, now)
    }

    /// As [`Self::candidate`], for the field of this number.
    pub fn candidate_for(
        &mut self,
        number: i64,
        source: ValueSource,
        value: DataValue,
        transform: Option<TransformState>,
        now: DateTime,
    ) -> Option<GateOutcome> {
        let Self { fields, watchers, dirty_fields, dirty_writers, due, .. } = self;
        let mut follows = Follows { dirty_fields, dirty_writers, due };
        let field =
            fields.get_numbered_mut(number).filter(|field| field.decision.is_open_for(source))?;
        if !field.validity.contains(now) {
            if let Some(from) = field.validity.from.filter(|from| *from > now) {
                field.newest = Some(value);
                self.beginnings.insert((from, field.key.clone()));
            }
            return None;
        }
        if transform.is_some() {
            field.transform = transform;
        }
        field.newest = Some(value.clone());
        field.traffic.came(now);
        if !watchers.contains_key(&field.key) {
            return Some(follows.through_gate(field, now, |gate| gate.on(now, value)));
        }
        // Others hear of a new state before anything of theirs leaves.
        let key = field.key.clone();
        self.tell_watchers(&key, now);
        self.through_gate(number, now, |gate| gate.on(now, value))
    }

    /// Asks every gate that wanted to be asked by now.
    pub fn release_due(&mut self, now: DateTime) {
        while let Some((at, number)) = self.due.first().copied() {
            if at > now {
                break;
            }
            self.due.pop_first();
            if let Some(field) = self.fields.get_numbered_mut(number) {
                field.noted_due = None;
                self.through_gate(number, now, |gate| gate.on_time(now));
            }
        }
    }

    /// When the next gate wants to be asked.
    #[must_use]
    pub fn next_due(&self) -> Option<DateTime> {
        self.due.first().map(|(at, _)| *at)
    }

    /// The machine's clock was set back: nothing waits for a time that was meant by the old clock.
    pub fn set_clock_back(&mut self, now: DateTime) {
        for writer in self.writers.values_mut() {
            writer.last_sign_at = writer.last_sign_at.min(now);
        }
        for field in self.fields.iter_mut() {
            field.gate.set_clock_back(now);
            field.note_due(&mut self.due);
        }
    }

    /// There are values to report.
    #[must_use]
    pub fn has_news(&self) -> bool {
        !self.dirty_writers.is_empty()
    }

    pub(super) fn after_gate(&mut self, key: &FieldKey, now: DateTime) {
        if let Some(number) = self.fields.get(key).map(|field| field.id) {
            self.through_gate(number, now, |_| ());
        }
    }

    fn through_gate<T>(
        &mut self,
        number: i64,
        now: DateTime,
        tell: impl FnOnce(&mut Gate) -> T,
    ) -> Option<T> {
        let Self { fields, dirty_fields, dirty_writers, due, .. } = self;
        let mut follows = Follows { dirty_fields, dirty_writers, due };
        Some(follows.through_gate(fields.get_numbered_mut(number)?, now, tell))
    }

    /// Makes one key frame per data set with news, and notes everything that has to be stored with
    /// it.
    ///
    /// `salt` yields fresh random bytes for each report.
    pub fn report(&mut self, now: DateTime, mut salt: impl FnMut() -> [u8; SALT_BYTES]) {
        self.refresh_writers();
        let writers = std::mem::take(&mut self.dirty_writers);
        let mut shared: Vec<NewReport> = Vec::new();
        let mut shared_bytes = 0;
        for id in writers {
            let Some((frame, consents)) = self.key_frame(id, now) else { continue };
            let body = encode_data_set_message(&frame, self.config.encoding);
            let Some(writer) = self.writers.get_mut(&id) else { continue };
            let (epoch, sequence, request) =
                (writer.epoch, writer.next_sequence, writer.request.clone());
            writer.next_sequence = writer.next_sequence.wrapping_add(1);
            writer.last_sign_at = now;
            for name in consents.keys().filter(|name| writer.carried.insert((*name).clone())) {
                let field = request.field(name.clone());
                let row = CarriedFieldRow {
                    field,
                    data_set_writer_id: id,
                    epoch,
                    first_sequence: sequence,
                };
                self.changes.carried_fields.push(row);
            }
            self.store_writer(id);
            let report = NewReport {
                id: self.next_row(),
                message: 0,
                data_set_writer_id: id,
                epoch,
                sequence,
                created_at: now,
                recipients: self.recipients(&request),
                body,
                salt: salt(),
                is_purged: false,
            };
            let root = values_root(&report.body, &report.salt)
                .expect("our own encoder writes a JSON object");
            let event = Event::Queued {
                range: range_of(id, epoch, sequence),
                values: hex::encode(root),
                consents,
            };
            self.record(&report.recipients.clone(), now, Some(report.id), &event);
            if !shared.is_empty() && shared_bytes + report.body.len() > SHARED_BYTES_MAX {
                self.close_message(&mut shared);
                shared_bytes = 0;
            }
            shared_bytes += report.body.len();
            shared.push(report);
        }
        self.close_message(&mut shared);
        for number in std::mem::take(&mut self.dirty_fields) {
            let Some(field) = self.fields.get_numbered_mut(number) else { continue };
            let Marks { is_dirty, has_left, .. } = &mut field.marks;
            *is_dirty = false;
            // What partners do not get, nodes and pages do not show: the newest that left, not
            // each.
            if std::mem::take(has_left)
                && let Some(value) = field.gate.disclosed()
            {
                self.aftermath.values.push((field.key.clone(), value.clone()));
                field.tell_pages(&mut self.aftermath);
            }
            self.changes.field_values.insert(field.id, field.value_row());
        }
    }

    /// Reports that travel together get the number of the last one of them.
    fn close_message(&mut self, shared: &mut Vec<NewReport>) {
        let Some(message) = shared.last().map(|report| report.id) else { return };
        self.aftermath.is_spool_filled = true;
        self.changes.reports.extend(shared.drain(..).map(|report| NewReport { message, ..report }));
    }

    /// The newest disclosed values of a writer's data set, in payload order.
    pub(crate) fn key_frame(
        &self,
        id: u16,
        now: DateTime,
    ) -> Option<(DataSetMessage, BTreeMap<FieldName, u32>)> {
        let writer = self.writers.get(&id).filter(|writer| !writer.fields.is_empty())?;
        let (_, request) = self.request(&writer.request)?;
        let mut values = Vec::with_capacity(writer.fields.len() * 2);
        let mut consents = BTreeMap::new();
        let mut newest: Option<DateTime> = None;
        for name in &writer.fields {
            let Some(field) = self.fields.get(&writer.request.field(name.clone())) else {
                continue;
            };
            let Some(value) = field.gate.disclosed() else { continue };
            newest = newest.max(value.source_timestamp);
            consents.insert(name.clone(), field.decision.version);
            let shown =
                DataValue { source_timestamp: None, server_timestamp: None, ..value.clone() };
            values.push(PayloadField::with(Arc::from(name.as_str()), shown));
            if let Some(unit) = &field.definition.unit {
                values.push(PayloadField::new(unit_member(name.as_str()), unit.as_str()));
            }
        }
        if consents.is_empty() {
            return None;
        }
        let step = writer
            .fields
            .iter()
            .filter_map(|name| self.fields.get(&writer.request.field(name.clone())))
            .map(|field| field.gate.policy().time_step())
            .max()
            .unwrap_or_default();
        let header = ReportHeader {
            report_name: &request.report_data_format.report_name,
            request: &writer.request,
            shopfloor_timestamp: newest.unwrap_or(now).floor_to(step),
        };
        let mut fields = Vec::from(header.payload_fields());
        fields.append(&mut values);
        let frame = DataSetMessage {
            data_set_writer_id: Some(id),
            sequence_number: Some(writer.next_sequence),
            meta_data_version: Some(writer.version()),
            timestamp: Some(now.floor_to(step)),
            fields,
            ..DataSetMessage::default()
        };
        Some((frame, consents))
    }

    /// A writer's report before any of its fields has a value.
    pub(crate) fn empty_frame(
        &self,
        id: u16,
        now: DateTime,
    ) -> (DataSetMessage, BTreeMap<FieldName, u32>) {
        let mut fields = Vec::new();
        if let Some(writer) = self.writers.get(&id)
            && let Some((_, request)) = self.request(&writer.request)
        {
            let header = ReportHeader {
                report_name: &request.report_data_format.report_name,
                request: &writer.request,
                shopfloor_timestamp: now,
            };
            fields = Vec::from(header.payload_fields());
        }
        let writer = self.writers.get(&id);
        let frame = DataSetMessage {
            data_set_writer_id: Some(id),
            sequence_number: writer.map(|writer| writer.next_sequence),
            meta_data_version: writer.map(|writer| writer.version()),
            timestamp: Some(now),
            fields,
            ..DataSetMessage::default()
        };
        (frame, BTreeMap::new())
    }
}
