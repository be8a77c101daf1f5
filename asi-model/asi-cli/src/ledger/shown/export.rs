//! Reports as the platform's API shows them: pages of the history, or single reports.

use std::{
    collections::{BTreeMap, HashMap},
    io::BufRead,
};

use anyhow::Context as _;
use asi_model::{DateTime, FactoryId, RequestKey, plain_value::ReportedValue};
use serde::Deserialize;
use serde_json::value::RawValue;

use crate::left::ReportId;

/// A report as a page of the history has it; further members are not needed.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct ShownReport {
    factory_id: FactoryId,
    data_set_writer_id: u16,
    epoch: u32,
    sequence: u32,
    #[serde(flatten)]
    pub(super) request: RequestKey,
    pub(super) report_name: String,
    pub(super) shopfloor_timestamp: Option<DateTime>,
    pub(super) report_timestamp: Option<DateTime>,
    /// Time of arrival at the platform.
    received_at: DateTime,
    pub(super) fields: BTreeMap<String, ReportedValue>,
}

/// Document of an export.
#[derive(Deserialize)]
struct Document {
    /// The reports of a page; none where the document is a report itself.
    items: Option<Vec<Box<RawValue>>>,
}

impl ShownReport {
    fn read(text: &RawValue) -> serde_json::Result<Self> {
        serde_json::from_str(text.get())
    }

    const fn id(&self) -> ReportId {
        ReportId {
            data_set_writer_id: self.data_set_writer_id,
            epoch: self.epoch,
            sequence: self.sequence,
        }
    }

    /// Returns the time that the report says of itself, else that of its arrival.
    pub(super) fn time(&self) -> DateTime {
        self.report_timestamp.unwrap_or(self.received_at)
    }
}

/// Reports of one factory that the platform showed. Takes as much memory as the export.
#[derive(Default)]
pub struct Export {
    reports: HashMap<ReportId, Box<RawValue>>,
    /// First and last sequence number that was shown, of each writer and epoch.
    spans: HashMap<(u16, u32), (u32, u32)>,
    /// Reports that were shown twice, with different contents.
    pub(super) contradictions: Vec<ReportId>,
    /// Number of reports of other factories.
    pub(super) of_others: u64,
}

impl Export {
    /// Reads an export, one JSON document after another. Of the reports those of this factory are
    /// compared.
    ///
    /// # Errors
    /// When a document is neither a page of the history nor a report.
    pub fn read(export: impl BufRead, factory: &FactoryId) -> anyhow::Result<Self> {
        const OTHER: &str =
            "the export has something that is neither a page of the history nor a report";
        let mut read = Self::default();
        for document in serde_json::Deserializer::from_reader(export).into_iter::<Box<RawValue>>() {
            let document = document.context(OTHER)?;
            let page: Document = serde_json::from_str(document.get()).context(OTHER)?;
            for text in page.items.unwrap_or_else(|| vec![document]) {
                let report = ShownReport::read(&text).context(OTHER)?;
                if report.factory_id == *factory {
                    read.add(&report, text);
                } else {
                    read.of_others += 1;
                }
            }
        }
        Ok(read)
    }

    /// Returns a report that was shown.
    pub(super) fn report(&self, id: ReportId) -> Option<ShownReport> {
        self.reports.get(&id).and_then(|text| ShownReport::read(text).ok())
    }

    /// Lists the numbers of all reports that were shown.
    pub(super) fn ids(&self) -> impl Iterator<Item = ReportId> {
        self.reports.keys().copied()
    }

    /// Returns whether a report lies between the first and the last of its writer that were shown.
    pub(super) fn spans(&self, id: ReportId) -> bool {
        let span = self.spans.get(&id.writer());
        span.is_some_and(|(first, last)| (*first..=*last).contains(&id.sequence))
    }

    fn add(&mut self, report: &ShownReport, text: Box<RawValue>) {
        let id = report.id();
        let (first, last) = self.spans.entry(id.writer()).or_insert((id.sequence, id.sequence));
        (*first, *last) = ((*first).min(id.sequence), (*last).max(id.sequence));
        match self.report(id) {
            // A page that was read twice.
            Some(known) if known == *report => {}
            Some(_) => self.contradictions.push(id),
            None => drop(self.reports.insert(id, text)),
        }
    }
}
