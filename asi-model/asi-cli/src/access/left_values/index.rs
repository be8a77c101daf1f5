//! Index of the values that left, by viewer, request and field.

use std::{collections::HashMap, time::Duration};

use access_log::Access;
use asi_model::{DateTime, FieldName, OrganisationId, RequestKey};

use super::{FileStart, LeftValue, LeftValues, Numbers};
use crate::left::ReportId;

/// Longest time by which a value of an emptied report may be newer than its entry says: a report says
/// its time on the longest time step of its fields.
const EMPTIED_REACH: Duration = Duration::from_hours(24);

/// The values that left, sorted.
pub struct LeftIndex {
    viewers: Numbers<OrganisationId>,
    requests: Numbers<RequestKey>,
    fields: Numbers<FieldName>,
    files: HashMap<u32, FileStart>,
    left: HashMap<(u32, u32), HashMap<u32, Times>>,
    /// Ranges of released reports of which no file has any.
    pub unknown_past: u64,
    /// Emptied reports of which no entry says what they answered.
    pub unassigned: u64,
}

/// Times of the values of one field of one request that left for one viewer.
#[derive(Default)]
struct Times {
    /// Sorted, each once.
    exact: Vec<DateTime>,
    /// True if values without a time left.
    has_timeless: bool,
    /// Latest time that a value of an emptied report may have.
    emptied_until: Option<DateTime>,
}

/// Result of the comparison of an access with what left.
#[derive(Debug, PartialEq, Eq)]
pub enum Coverage {
    Covered,
    /// Covered by reports of which retention emptied the values: their times are not known exactly.
    ByEmptied,
    /// The values are older than the entries of the file.
    Older,
    NoFile,
    /// A sentence without a full stop.
    NotCovered(String),
}

impl Times {
    fn has(&self, at: DateTime) -> bool {
        self.exact.binary_search(&at).is_ok()
    }

    /// Returns true if a value left whose time is within the span, or that has none.
    fn has_any(&self, from: DateTime, to: DateTime) -> bool {
        let next = self.exact.partition_point(|at| *at < from);
        self.has_timeless || self.exact.get(next).is_some_and(|at| *at <= to)
    }

    fn may_have(&self, at: DateTime) -> bool {
        self.emptied_until.is_some_and(|until| at <= until)
    }
}

impl LeftIndex {
    /// Sorts what was collected.
    pub fn new(mut collected: LeftValues) -> Self {
        collected.values.sort_unstable();
        let mut index = Self {
            left: HashMap::new(),
            unknown_past: 0,
            unassigned: 0,
            viewers: std::mem::take(&mut collected.viewers),
            requests: std::mem::take(&mut collected.requests),
            fields: std::mem::take(&mut collected.fields),
            files: std::mem::take(&mut collected.files),
        };
        for value in &collected.values {
            index.add(value.viewer, value);
        }
        index.add_emptied(&collected);
        index.add_past(&collected);
        for times in index.left.values_mut().flat_map(HashMap::values_mut) {
            times.exact.sort_unstable();
            times.exact.dedup();
            times.exact.shrink_to_fit();
        }
        index
    }

    /// Compares an access with what left for its organisation: of each of its fields a value within its
    /// time span, and a value at both ends of it.
    pub fn check(&self, access: &Access) -> Coverage {
        let viewer = self.viewers.0.get(&access.viewer);
        let Some((viewer, file)) = viewer.and_then(|id| Some((id, self.files.get(id)?))) else {
            return Coverage::NoFile;
        };
        let request = self.requests.0.get(&access.request);
        let left = request.and_then(|request| self.left.get(&(*viewer, *request)));
        let is_older = |at: Option<DateTime>| {
            let begin = file.begins_at;
            file.is_pruned && at.is_some_and(|at| begin.is_none_or(|begin| at < begin))
        };
        let Some(left) = left else {
            let message = "read, but nothing of this request left for it".to_owned();
            return if is_older(access.values_to) {
                Coverage::Older
            } else {
                Coverage::NotCovered(message)
            };
        };
        let mut read = Vec::with_capacity(access.fields.len());
        for name in &access.fields {
            match name.parse().ok().and_then(|name: FieldName| left.get(self.fields.0.get(&name)?))
            {
                Some(times) => read.push(times),
                None if is_older(access.values_to) => return Coverage::Older,
                None => {
                    let message = format!("read, but the field {name} never left for it");
                    return Coverage::NotCovered(message);
                }
            }
        }
        let mut coverage = Coverage::Covered;
        if let (Some(from), Some(to)) = (access.values_from, access.values_to) {
            for (name, times) in access.fields.iter().zip(&read) {
                if times.has_any(from, to) {
                    continue;
                }
                coverage = if times.may_have(from) {
                    Coverage::ByEmptied
                } else if is_older(Some(from)) {
                    Coverage::Older
                } else {
                    let message = format!(
                        "read, but no value of the field {name} from {from} to {to} left for it"
                    );
                    return Coverage::NotCovered(message);
                };
            }
        }
        for at in [access.values_from, access.values_to].into_iter().flatten() {
            if read.iter().any(|times| times.has(at)) {
                continue;
            }
            coverage = if read.iter().any(|times| times.may_have(at)) {
                Coverage::ByEmptied
            } else if is_older(Some(at)) {
                Coverage::Older
            } else {
                let message = format!("read, but no value of {at} of these fields left for it");
                return Coverage::NotCovered(message);
            };
        }
        coverage
    }

    fn add(&mut self, viewer: u32, value: &LeftValue) {
        let fields = self.left.entry((viewer, value.request)).or_default();
        let times = fields.entry(value.field).or_default();
        times.exact.extend(value.at);
        times.has_timeless |= value.at.is_none();
    }

    fn add_emptied(&mut self, collected: &LeftValues) {
        for report in &collected.emptied {
            let requests = report.requests(&collected.writers, &collected.consents);
            self.unassigned += u64::from(requests.is_empty());
            let past = collected.past.iter().filter(|(_, range)| has(range, report.id));
            let viewers: Vec<u32> =
                past.map(|(viewer, _)| *viewer).chain([report.viewer]).collect();
            let until = report.recorded_at.after(EMPTIED_REACH);
            for key in viewers.iter().flat_map(|viewer| requests.iter().map(|to| (*viewer, *to))) {
                let fields = self.left.entry(key).or_default();
                for (field, _) in &report.consents {
                    let times = fields.entry(*field).or_default();
                    times.emptied_until = times.emptied_until.max(Some(until));
                }
            }
        }
    }

    /// Adds reports that were released afterwards: they are in the files of those for whom they left.
    fn add_past(&mut self, collected: &LeftValues) {
        for (viewer, range) in &collected.past {
            let begin = collected.values.partition_point(|value| value.report < first(range));
            let values = collected.values[begin..].iter();
            let mut is_known = collected.emptied.iter().any(|report| has(range, report.id));
            for value in values.take_while(|value| has(range, value.report)) {
                is_known = true;
                self.add(*viewer, value);
            }
            self.unknown_past += u64::from(!is_known);
        }
    }
}

const fn first(range: &::ledger::SequenceRange) -> ReportId {
    ReportId {
        data_set_writer_id: range.data_set_writer_id,
        epoch: range.epoch,
        sequence: range.first_sequence,
    }
}

fn has(range: &::ledger::SequenceRange, id: ReportId) -> bool {
    (range.data_set_writer_id, range.epoch) == (id.data_set_writer_id, id.epoch)
        && (range.first_sequence..=range.last_sequence).contains(&id.sequence)
}
