//! DataSetWriters: one per dynamic data request.

use std::{
    collections::{BTreeMap, BTreeSet, HashMap},
    time::Duration,
};

use asi_model::{DateTime, FieldName, RequestKey, pubsub::MetaDataVersion};

use crate::writes::WriterRow;

/// Time for which the id of a retired writer is not given to another request.
const QUARANTINE: Duration = Duration::from_secs(30 * 86_400);
/// The shortest keep-alive period.
const KEEP_ALIVE_PERIOD_MIN: Duration = Duration::from_secs(1);

/// A DataSetWriter (OPC UA Part 14).
#[derive(Debug, Clone)]
pub struct Writer {
    request: RequestKey,
    epoch: u32,
    minor_version: u32,
    next_sequence: u32,
    fields: Vec<FieldName>,
    /// Fields that reports of this epoch carried since the start.
    carried: BTreeSet<FieldName>,
    retired_at: Option<DateTime>,
    /// Time of the last report or keep-alive since the start.
    last_sent_at: DateTime,
    /// Period of its keep-alives; none without mapped fields.
    keep_alive_period: Option<Duration>,
    /// Its entry among the keep-alives; it may be earlier than the keep-alive is due.
    keep_alive_at: Option<DateTime>,
}

impl Writer {
    /// Returns the request that it reports about.
    #[must_use]
    pub const fn request(&self) -> &RequestKey {
        &self.request
    }

    /// Returns the MajorVersion of the metadata.
    #[must_use]
    pub const fn epoch(&self) -> u32 {
        self.epoch
    }

    /// Returns the sequence number of the next report.
    #[must_use]
    pub const fn next_sequence(&self) -> u32 {
        self.next_sequence
    }

    /// Returns the mapped fields in payload order, as the metadata in force describes them.
    #[must_use]
    pub fn fields(&self) -> &[FieldName] {
        &self.fields
    }

    /// Returns true once no request has it any more.
    #[must_use]
    pub const fn is_retired(&self) -> bool {
        self.retired_at.is_some()
    }

    /// Returns the writer as stored.
    #[must_use]
    pub fn row(&self) -> WriterRow {
        WriterRow {
            request: self.request.clone(),
            epoch: self.epoch,
            minor_version: self.minor_version,
            next_sequence: self.next_sequence,
            fields: self.fields.clone(),
            retired_at: self.retired_at,
        }
    }

    /// Returns the version that reports carry.
    #[must_use]
    pub const fn version(&self) -> MetaDataVersion {
        MetaDataVersion { major: self.epoch, minor: self.minor_version }
    }

    /// Begins a new epoch: its sequence numbers start at 0.
    fn begin_epoch(&mut self, now: DateTime) {
        self.epoch = now.version_time().max(self.epoch.saturating_add(1));
        self.minor_version = self.epoch;
        self.next_sequence = 0;
        self.carried.clear();
    }
}

impl From<WriterRow> for Writer {
    fn from(row: WriterRow) -> Self {
        Self {
            request: row.request,
            epoch: row.epoch,
            minor_version: row.minor_version,
            next_sequence: row.next_sequence,
            fields: row.fields,
            carried: BTreeSet::new(),
            retired_at: row.retired_at,
            last_sent_at: DateTime::MIN,
            keep_alive_period: None,
            keep_alive_at: None,
        }
    }
}

/// Owner of all data set writers, retired ones included.
#[derive(Debug, Default)]
pub struct WriterRegistry {
    writers: BTreeMap<u16, Writer>,
    /// Ids of the writers that are not retired.
    by_request: HashMap<RequestKey, u16>,
    /// Writers with released values that no report carries yet.
    unreported: BTreeSet<u16>,
    /// Retired writers by the time of their retirement.
    retired: BTreeSet<(DateTime, u16)>,
    /// Writers by the earliest time of their next keep-alive. An entry may be too early, as it is
    /// not moved with every report; never too late.
    keep_alives: BTreeSet<(DateTime, u16)>,
}

impl WriterRegistry {
    /// Returns a writer, retired or not.
    #[must_use]
    pub fn get(&self, id: u16) -> Option<&Writer> {
        self.writers.get(&id)
    }

    /// Returns the id of a request's writer.
    #[must_use]
    pub fn id_of(&self, request: &RequestKey) -> Option<u16> {
        self.by_request.get(request).copied()
    }

    /// Returns the ids of all writers that are not retired, in no order.
    pub fn active(&self) -> impl Iterator<Item = u16> {
        self.by_request.values().copied()
    }

    /// Returns true where released values wait for a report.
    #[must_use]
    pub fn has_unreported(&self) -> bool {
        !self.unreported.is_empty()
    }

    /// Returns a request's key as its writer holds it, with the writer's id: the fields of a
    /// request share its texts.
    pub(crate) fn key_of(&self, request: &RequestKey) -> Option<(&RequestKey, u16)> {
        self.by_request.get_key_value(request).map(|(key, id)| (key, *id))
    }

    pub(crate) fn load(&mut self, id: u16, row: WriterRow) {
        match row.retired_at {
            None => drop(self.by_request.insert(row.request.clone(), id)),
            Some(retired_at) => drop(self.retired.insert((retired_at, id))),
        }
        self.writers.insert(id, row.into());
    }

    /// Gives a request a writer; `None` where it has one. All 65 535 ids may be taken.
    ///
    /// # Errors
    /// [`NoFreeId`].
    pub(crate) fn assign(
        &mut self,
        request: &RequestKey,
        now: DateTime,
    ) -> Result<Option<u16>, NoFreeId> {
        if self.by_request.contains_key(request) {
            return Ok(None);
        }
        let id = self.take_free_id(now).ok_or(NoFreeId)?;
        let last_epoch = self.writers.get(&id).map_or(0, |writer| writer.epoch);
        let mut writer = Writer::from(WriterRow {
            request: request.clone(),
            epoch: last_epoch,
            minor_version: last_epoch,
            next_sequence: 0,
            fields: Vec::new(),
            retired_at: None,
        });
        writer.begin_epoch(now);
        writer.last_sent_at = now;
        self.writers.insert(id, writer);
        self.by_request.insert(request.clone(), id);
        Ok(Some(id))
    }

    /// Takes an id that is out of quarantine, or one that was never given.
    fn take_free_id(&mut self, now: DateTime) -> Option<u16> {
        let oldest = self.retired.first().copied();
        if let Some((retired_at, id)) = oldest.filter(|(at, _)| now.since(*at) >= QUARANTINE) {
            self.retired.remove(&(retired_at, id));
            return Some(id);
        }
        self.writers.last_key_value().map_or(0, |(id, _)| *id).checked_add(1)
    }

    /// Retires a request's writer, and returns its id.
    pub(crate) fn retire(&mut self, request: &RequestKey, now: DateTime) -> Option<u16> {
        let id = self.by_request.remove(request)?;
        self.unreported.remove(&id);
        self.set_keep_alive(id, None);
        if let Some(writer) = self.writers.get_mut(&id) {
            writer.retired_at = Some(now);
            writer.fields.clear();
            self.retired.insert((now, id));
        }
        Some(id)
    }

    /// Sets the fields that a writer's metadata describes. Fields that only follow those of before
    /// make a new minor version, in which its sequence numbers go on; returns whether that is so.
    pub(crate) fn append_fields(&mut self, id: u16, fields: Vec<FieldName>, now: DateTime) -> bool {
        let Some(writer) = self.writers.get_mut(&id) else { return false };
        if !fields.starts_with(&writer.fields) {
            return false;
        }
        writer.fields = fields;
        writer.minor_version = now.version_time().max(writer.minor_version.saturating_add(1));
        true
    }

    /// Begins a new epoch of a writer, with other fields where they are given.
    pub(crate) fn begin_epoch(&mut self, id: u16, fields: Option<Vec<FieldName>>, now: DateTime) {
        let Some(writer) = self.writers.get_mut(&id) else { return };
        if let Some(fields) = fields {
            writer.fields = fields;
        }
        writer.begin_epoch(now);
    }

    /// Takes the sequence number of a writer's next report, which carries these fields. Returns the
    /// epoch, the number, and the fields that no report of the epoch carried before.
    pub(crate) fn take_sequence<'n>(
        &mut self,
        id: u16,
        carried: impl Iterator<Item = &'n FieldName>,
        now: DateTime,
    ) -> Option<(u32, u32, Vec<FieldName>)> {
        let writer = self.writers.get_mut(&id)?;
        let sequence = writer.next_sequence;
        writer.next_sequence = sequence.wrapping_add(1);
        writer.last_sent_at = now;
        let new: Vec<FieldName> =
            carried.filter(|name| !writer.carried.contains(*name)).cloned().collect();
        writer.carried.extend(new.iter().cloned());
        Some((writer.epoch, sequence, new))
    }

    /// Notes that a writer has a released value to report.
    pub(crate) fn mark_unreported(&mut self, id: u16) {
        self.unreported.insert(id);
    }

    /// Takes the ids of the writers that have values to report.
    pub(crate) fn take_unreported(&mut self) -> BTreeSet<u16> {
        std::mem::take(&mut self.unreported)
    }

    /// Sets the period of a writer's keep-alives: the update interval that the partner asked for.
    /// A writer without mapped fields sends none.
    pub(crate) fn set_keep_alive(&mut self, id: u16, period: Option<Duration>) {
        let Some(writer) = self.writers.get_mut(&id) else { return };
        let period = period.filter(|_| !writer.fields.is_empty() && writer.retired_at.is_none());
        writer.keep_alive_period = period.map(|period| period.max(KEEP_ALIVE_PERIOD_MIN));
        self.schedule_keep_alive(id);
    }

    /// Takes the ids of the writers that were silent for the whole of their period, and counts
    /// their keep-alives as sent.
    pub(crate) fn take_silent(&mut self, now: DateTime) -> Vec<u16> {
        let mut silent = Vec::new();
        while let Some((_, id)) = self.keep_alives.first().copied().filter(|(at, _)| *at <= now) {
            self.keep_alives.pop_first();
            let Some(writer) = self.writers.get_mut(&id) else { continue };
            writer.keep_alive_at = None;
            let Some(period) = writer.keep_alive_period else { continue };
            // The same sum as in the schedule: a period may be finer than the clock's ticks.
            if writer.last_sent_at.after(period) <= now {
                writer.last_sent_at = now;
                silent.push(id);
            }
            self.schedule_keep_alive(id);
        }
        silent
    }

    /// Follows the machine's clock where it was set back to `now`. Visits all writers that are not
    /// retired: each knows when it sent last, with or without keep-alives.
    pub(crate) fn set_clock_back(&mut self, now: DateTime) {
        let ids: Vec<u16> = self.active().collect();
        for id in ids {
            if let Some(writer) = self.writers.get_mut(&id) {
                writer.last_sent_at = writer.last_sent_at.min(now);
            }
            self.schedule_keep_alive(id);
        }
    }

    fn schedule_keep_alive(&mut self, id: u16) {
        let Some(writer) = self.writers.get_mut(&id) else { return };
        let at = writer.keep_alive_period.map(|period| writer.last_sent_at.after(period));
        if let Some(former) = std::mem::replace(&mut writer.keep_alive_at, at) {
            self.keep_alives.remove(&(former, id));
        }
        if let Some(at) = at {
            self.keep_alives.insert((at, id));
        }
    }
}

/// All 65 535 DataSetWriterIds are taken or in quarantine.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct NoFreeId;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{at, field};

    fn registry() -> (WriterRegistry, u16) {
        let mut writers = WriterRegistry::default();
        let id = writers.assign(&field("made").request, at(0)).expect("free").expect("new");
        (writers, id)
    }

    fn map_made(writers: &mut WriterRegistry, id: u16) {
        assert!(writers.append_fields(id, vec![field("made").field_name], at(0)));
    }

    #[test]
    fn ids_stay_in_quarantine_after_their_request_is_gone() {
        let (mut writers, first) = registry();
        let request = field("made").request;
        assert_eq!(writers.assign(&request, at(1)), Ok(None), "a request has one writer");
        let former = writers.get(first).expect("a writer").epoch;
        assert_eq!(writers.retire(&request, at(2)), Some(first));
        let next = writers.assign(&request, at(3)).expect("free").expect("new");
        assert_ne!(next, first);
        writers.retire(&request, at(4));
        let filler = writers.get(next).expect("a writer").row();
        for id in next..=u16::MAX {
            writers.load(id, WriterRow { retired_at: Some(at(1000)), ..filler.clone() });
        }
        assert_eq!(writers.assign(&request, at(5)), Err(NoFreeId));
        let later = at(2).after(QUARANTINE);
        assert_eq!(writers.assign(&request, later), Ok(Some(first)), "the id is free again");
        assert!(writers.get(first).expect("a writer").epoch > former, "in a later epoch");
    }

    #[test]
    fn a_writer_sends_keep_alives_while_it_is_silent_and_has_fields() {
        let (mut writers, id) = registry();
        let second = Duration::from_secs(1);
        writers.set_keep_alive(id, Some(second));
        assert!(writers.take_silent(at(10_000)).is_empty(), "nothing is mapped");
        map_made(&mut writers, id);
        writers.set_keep_alive(id, Some(second / 10));
        assert!(writers.take_silent(at(999)).is_empty(), "a second is the shortest period");
        assert_eq!(writers.take_silent(at(1000)), [id]);
        assert!(writers.take_silent(at(1999)).is_empty());
        writers.take_sequence(id, std::iter::empty(), at(1999)).expect("a writer");
        assert!(writers.take_silent(at(2500)).is_empty(), "a report is a sign of life, too");
        assert_eq!(writers.take_silent(at(2999)), [id]);
        writers.set_clock_back(at(0));
        assert_eq!(writers.take_silent(at(1000)), [id], "the clock was set back");
        writers.set_keep_alive(id, None);
        assert!(writers.take_silent(at(1_000_000)).is_empty());
    }

    /// Seven times a minute is no whole number of the clock's ticks of 100 ns.
    #[test]
    fn a_period_finer_than_the_clocks_ticks_comes_to_an_end() {
        let (mut writers, id) = registry();
        map_made(&mut writers, id);
        let period = Duration::from_secs(60) / 7;
        writers.set_keep_alive(id, Some(period));
        for _ in 0..3 {
            let due = writers.get(id).expect("a writer").last_sent_at.after(period);
            assert_eq!(writers.take_silent(due), [id]);
        }
    }
}
