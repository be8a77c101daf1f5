//! Reports that the platform showed, compared with those that left: a report that is shown and has no entry in the
//! recipient's log never left for it.

mod comparison;
mod export;

use std::{
    collections::{BTreeSet, HashMap, HashSet},
    io::BufRead,
};

use ::ledger::{SequenceRange, audit::Auditor};
use asi_model::DateTime;
use comparison::differences;
pub use export::Export;
use serde::Serialize;

use crate::{
    audit_lines::take_all,
    left::{LeftEntry, ReportId},
};

/// Most faults, and most reports that are missing or older, that are listed; further ones are only
/// counted.
const LISTED_MAX: usize = 100;

const NEVER_LEFT: &str = "shown, but never left for you";
const DIFFERING_TWICE: &str = "shown twice with different contents";

/// Result of the comparison.
#[derive(Debug, Default, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct ShownAudit {
    /// Number of reports that were compared value by value.
    pub reports_compared: u64,
    /// Number of reports whose values retention had emptied: compared by their numbers and the names of
    /// their fields.
    pub reports_compared_by_identity: u64,
    /// Number of reports that left for others and were shown to the recipient afterwards, as entries
    /// of its log say: compared by their numbers.
    pub reports_of_the_past: u64,
    /// Number of reports of other factories, about which this log says nothing.
    pub reports_of_other_factories: u64,
    /// Reports that are older than the entries of the file, which retention removed: not compared.
    pub older_count: u64,
    pub older_list: Vec<ReportId>,
    /// Reports that left, between the first and the last of their writer that were shown, and were
    /// not shown. Nothing was widened by that.
    pub missing_count: u64,
    pub missing_list: Vec<ReportId>,
    /// Number of all faults.
    pub fault_count: u64,
    /// The first hundred faults.
    pub fault_list: Vec<ShownFault>,
}

/// Fault of a shown report.
#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct ShownFault {
    #[serde(flatten)]
    report: ReportId,
    /// Sentence without a full stop.
    message: String,
}

/// Comparison of what was shown with the entries of a log, one after another.
struct Comparison<'e> {
    export: &'e Export,
    found: HashSet<ReportId>,
    log: LogSoFar,
    audit: ShownAudit,
}

/// The entries so far, as much of them as concerns reports that are not found or not shown.
#[derive(Default)]
struct LogSoFar {
    /// Retention removed entries before those of the file.
    is_pruned: bool,
    /// Time of the first entry about a report.
    begins_at: Option<DateTime>,
    /// First sequence number that was queued, of each writer and epoch.
    first: HashMap<(u16, u32), u32>,
    past: Vec<SequenceRange>,
    missing: BTreeSet<ReportId>,
}

/// Statement of a line, compared with what was shown.
enum ComparedLine {
    /// A report that left, with what differs where it was shown.
    Queued {
        id: ReportId,
        recorded_at: DateTime,
        is_emptied: bool,
        shown: Option<Vec<String>>,
    },
    Ended(SequenceRange),
    Past(SequenceRange),
    Other,
}

/// Takes all lines of an audit file after the first, and compares with them what was shown. `is_pruned`
/// says that the file does not have the first entries of its log.
///
/// # Errors
/// When the file cannot be read.
pub fn compare(
    export: &Export,
    auditor: &mut Auditor,
    lines: &mut (impl BufRead + Send),
    is_pruned: bool,
) -> anyhow::Result<ShownAudit> {
    let audit =
        ShownAudit { reports_of_other_factories: export.of_others, ..ShownAudit::default() };
    let log = LogSoFar { is_pruned, ..LogSoFar::default() };
    let mut comparison = Comparison { export, found: HashSet::new(), log, audit };
    for id in &export.contradictions {
        comparison.audit.fault(*id, DIFFERING_TWICE.to_owned());
    }
    take_all(auditor, lines, &|line| read(export, line), |line| comparison.take(line))?;
    Ok(comparison.finish())
}

/// Compares a line for itself.
fn read(export: &Export, line: &str) -> ComparedLine {
    match LeftEntry::read(line) {
        LeftEntry::Queued(left) => ComparedLine::Queued {
            id: left.id,
            recorded_at: left.recorded_at,
            is_emptied: left.content.is_none(),
            shown: export.report(left.id).map(|shown| differences(&shown, &left)),
        },
        LeftEntry::Ended(range) => ComparedLine::Ended(range),
        LeftEntry::PastReleased(range) => ComparedLine::Past(range),
        LeftEntry::Consent(..) | LeftEntry::Other => ComparedLine::Other,
    }
}

impl Comparison<'_> {
    fn take(&mut self, line: ComparedLine) {
        match line {
            ComparedLine::Queued { id, recorded_at, is_emptied, shown } => {
                self.log.begins_at.get_or_insert(recorded_at);
                self.log.first.entry(id.writer()).or_insert(id.sequence);
                match shown {
                    Some(differences) => self.found(id, is_emptied, differences),
                    None if self.export.spans(id) => drop(self.log.missing.insert(id)),
                    None => {}
                }
            }
            ComparedLine::Ended(range) => {
                let ids: Vec<_> = self.log.missing.range(ids(&range)).copied().collect();
                for id in ids {
                    self.log.missing.remove(&id);
                }
            }
            ComparedLine::Past(range) => self.log.past.push(range),
            ComparedLine::Other => {}
        }
    }

    fn found(&mut self, id: ReportId, is_emptied: bool, differences: Vec<String>) {
        self.found.insert(id);
        if is_emptied {
            self.audit.reports_compared_by_identity += 1;
        } else {
            self.audit.reports_compared += 1;
        }
        for difference in differences {
            self.audit.fault(id, difference);
        }
    }

    fn finish(mut self) -> ShownAudit {
        let unfound: BTreeSet<_> =
            self.export.ids().filter(|id| !self.found.contains(id)).collect();
        for id in unfound {
            if self.log.past.iter().any(|range| ids(range).contains(&id)) {
                self.audit.reports_of_the_past += 1;
            } else if self.log.may_be_removed(self.export, id) {
                self.audit.older_count += 1;
                push(&mut self.audit.older_list, id);
            } else {
                self.audit.fault(id, NEVER_LEFT.to_owned());
            }
        }
        self.audit.missing_count = self.log.missing.len() as u64;
        self.audit.missing_list = self.log.missing.into_iter().take(LISTED_MAX).collect();
        self.audit
    }
}

impl LogSoFar {
    /// Returns whether the entry of a shown report may be one of those that retention removed: its
    /// number is smaller than all of its writer in the file, and its time older than the file's.
    fn may_be_removed(&self, export: &Export, id: ReportId) -> bool {
        let is_before = self.first.get(&id.writer()).is_none_or(|first| id.sequence < *first);
        let time = export.report(id).map(|shown| shown.time());
        let is_old = self.begins_at.is_none_or(|begin| time.is_some_and(|time| time < begin));
        self.is_pruned && is_before && is_old
    }
}

impl ShownAudit {
    /// Returns whether nothing was shown that did not leave, or not so.
    pub const fn is_intact(&self) -> bool {
        self.fault_count == 0
    }

    fn fault(&mut self, report: ReportId, message: String) {
        self.fault_count += 1;
        push(&mut self.fault_list, ShownFault { report, message });
    }
}

fn push<T>(list: &mut Vec<T>, item: T) {
    if list.len() < LISTED_MAX {
        list.push(item);
    }
}

fn ids(range: &SequenceRange) -> std::ops::RangeInclusive<ReportId> {
    let SequenceRange { data_set_writer_id, epoch, first_sequence, last_sequence } = *range;
    let id = |sequence| ReportId { data_set_writer_id, epoch, sequence };
    id(first_sequence)..=id(last_sequence)
}
