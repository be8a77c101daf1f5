//! Values that left a plant, by the audit files of its ledger: to whom, in answer to which request,
//! which fields, of which times. No values.

mod emptied;
mod index;

use std::collections::{HashMap, HashSet};

use ::ledger::SequenceRange;
use asi_model::{DateTime, FieldKey, FieldName, OrganisationId, RequestKey};
use emptied::EmptiedReport;
pub use index::{Coverage, LeftIndex};

use crate::left::{LeftEntry, QueuedReport, ReportId};

/// Values that left, collected from audit files. Takes memory for each value, and none for what it is.
#[derive(Default)]
pub struct LeftValues {
    viewers: Numbers<OrganisationId>,
    requests: Numbers<RequestKey>,
    fields: Numbers<FieldName>,
    values: Vec<LeftValue>,
    emptied: Vec<EmptiedReport>,
    /// Releases of the past, each to a viewer.
    past: Vec<(u32, SequenceRange)>,
    /// Numbers of consents, by request and field.
    consents: HashMap<u32, HashSet<(u32, u32)>>,
    /// The request that each writer answers, where a report with its values says so.
    writers: HashMap<u16, u32>,
    /// Viewers with a file, and the time of its first entry where retention removed earlier ones.
    files: HashMap<u32, FileStart>,
}

/// Beginning of a viewer's file.
#[derive(Debug, Clone, Copy, Default)]
struct FileStart {
    is_pruned: bool,
    begins_at: Option<DateTime>,
}

/// A value that left, by the numbers of its names.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct LeftValue {
    report: ReportId,
    viewer: u32,
    request: u32,
    field: u32,
    at: Option<DateTime>,
}

/// Names in the order in which they came, so that values need no copies of them.
struct Numbers<T>(HashMap<T, u32>);

impl<T> Default for Numbers<T> {
    fn default() -> Self {
        Self(HashMap::new())
    }
}

impl<T: Clone + Eq + std::hash::Hash> Numbers<T> {
    fn of(&mut self, name: &T) -> u32 {
        if let Some(number) = self.0.get(name) {
            return *number;
        }
        let number = u32::try_from(self.0.len()).unwrap_or(u32::MAX);
        self.0.insert(name.clone(), number);
        number
    }
}

impl LeftValues {
    /// Begins the file of a viewer, and returns the viewer's number. `is_pruned` says that the file
    /// does not have the first entries of its log.
    pub fn begin(&mut self, viewer: &OrganisationId, is_pruned: bool) -> u32 {
        let viewer = self.viewers.of(viewer);
        // A second log of a recipient goes on where the first one ended.
        let start = FileStart { is_pruned, begins_at: None };
        self.files.entry(viewer).and_modify(|known| known.is_pruned |= is_pruned).or_insert(start);
        viewer
    }

    /// Takes the next entry of a viewer's file. One that no signature covers is not for here.
    pub fn take(&mut self, viewer: u32, entry: LeftEntry) {
        match entry {
            LeftEntry::Queued(report) => self.queued(viewer, *report),
            LeftEntry::PastReleased(range) => self.past.push((viewer, range)),
            LeftEntry::Consent(FieldKey { request, field_name }, version) => {
                let (request, field) = (self.requests.of(&request), self.fields.of(&field_name));
                self.consents.entry(request).or_default().insert((field, version));
            }
            LeftEntry::Ended(_) | LeftEntry::Other => {}
        }
    }

    fn queued(&mut self, viewer: u32, report: QueuedReport) {
        if let Some(file) = self.files.get_mut(&viewer) {
            let begin = file.begins_at.get_or_insert(report.recorded_at);
            *begin = (*begin).min(report.recorded_at);
        }
        let Some(content) = report.content else {
            let fields = report.consents.iter();
            let consents = fields.map(|(name, version)| (self.fields.of(name), *version)).collect();
            let recorded_at = report.recorded_at;
            self.emptied.push(EmptiedReport { id: report.id, viewer, recorded_at, consents });
            return;
        };
        let request = self.requests.of(&content.request);
        self.writers.insert(report.id.data_set_writer_id, request);
        for (name, value) in &content.fields {
            let Ok(name) = name.parse() else { continue };
            let (field, at) = (self.fields.of(&name), content.time_of(value));
            self.values.push(LeftValue { report: report.id, viewer, request, field, at });
        }
    }
}
