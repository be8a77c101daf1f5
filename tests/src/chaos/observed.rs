//! Reports of one request in the order in which they were made, with times by the clock of its machines.

use std::collections::BTreeMap;

use super::{
    content::{Content, FieldContent},
    disturbances::Span,
    stores::{Left, ReportKey},
};
use crate::scenario::load;

/// Reports after a writer's first one in which its fields get their first values.
const BEGINNING: usize = 10;

/// Reports of one request.
pub(super) struct Observed<'l>(Vec<(i64, &'l Content)>);

impl<'l> Observed<'l> {
    /// Picks them from all that left.
    pub fn of(left: &'l BTreeMap<ReportKey, Left>, request: &str) -> Self {
        let mut reports: Vec<&Left> =
            left.values().filter(|report| report.content.request == request).collect();
        reports.sort_by_key(|report| report.id);
        let times = reports.iter().map(|report| machine_time(&report.content));
        // Before the first one with a value.
        let mut time = times.clone().flatten().next().unwrap_or_default();
        let times: Vec<i64> = times
            .map(|newer| {
                time = newer.map_or(time, |newer| newer.max(time));
                time
            })
            .collect();
        Self(times.into_iter().zip(reports.iter().map(|report| &report.content)).collect())
    }

    /// Time of the first one.
    pub fn begin(&self) -> i64 {
        self.0.first().map_or(0, |(time, _)| *time)
    }

    /// True where the last one has a good value of a field.
    pub fn ends_well(&self, name: &str) -> bool {
        let field = self.0.last().and_then(|(_, content)| content.fields.get(name));
        field.is_some_and(is_good)
    }

    /// Returns the values of a field that counts, with their times, in the order of the reports.
    pub fn steps_of(&self, name: &str) -> Vec<(i64, i64)> {
        let fields = self.0.iter().filter_map(|(_, content)| content.fields.get(name));
        fields
            .filter_map(|field| {
                // A number of 64 bits is a text in JSON.
                let count = field.value.as_str().and_then(|text| text.parse().ok());
                count.zip(field.source_time)
            })
            .collect()
    }

    /// Returns the values of a field that counts, each with its first time.
    pub fn counts(&self, name: &str) -> BTreeMap<i64, i64> {
        let mut counts = BTreeMap::new();
        for (count, time) in self.steps_of(name) {
            // Later reports carry it again.
            counts.entry(count).and_modify(|first| *first = time.min(*first)).or_insert(time);
        }
        counts
    }

    /// Returns the times between good values of a field in which reports lack it, or have it with another status where
    /// it `is_good_always`. Machines that stopped at `end` leave bad values behind.
    pub fn lacking(&self, name: &str, is_good_always: bool, end: i64) -> Vec<Span> {
        let is_well = |content: &Content| {
            let field = content.fields.get(name);
            field.is_some_and(|field| !is_good_always || is_good(field))
        };
        let mut spans = Vec::new();
        let mut last_well = self.begin();
        let mut lacks_since = None;
        for (number, (time, content)) in self.0.iter().enumerate() {
            if is_well(content) {
                let since = lacks_since.take();
                spans.extend(since.map(|from| Span { from, to: *time }));
                last_well = *time;
            } else if number >= BEGINNING {
                lacks_since = lacks_since.or(Some(last_well));
            }
        }
        spans.extend(lacks_since.map(|from| Span { from, to: end }));
        spans
    }
}

fn is_good(field: &FieldContent) -> bool {
    field.status == "Good"
}

/// Returns the newest time that a machine gave one of these values.
fn machine_time(content: &Content) -> Option<i64> {
    let fields =
        [load::COUNTED, load::TOGGLED].into_iter().filter_map(|name| content.fields.get(name));
    fields.filter(|field| is_good(field)).filter_map(|field| field.source_time).max()
}
