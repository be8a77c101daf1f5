//! Offer to show a recipient what had left for others before it was added.
//!
//! A report is shown whole or not at all. It can be shown where each of its fields is open to the
//! recipient at present, and had left under a policy that satisfies the present one: then the
//! recipient learns no more of any hour than it would learn of the present from the same mapping. Caps
//! do not count the past: a former version of the mapping may have read another variable. Everything
//! else stays with those for whom it had left.

use std::collections::BTreeMap;

use asi_model::FieldName;
use disclosure::DisclosurePolicy;
use ledger::{SequenceRange, past_root};

use crate::{
    ConnectorState,
    past::{Past, PastOffer, PastPart, PastReport},
};

/// Reports of the past that an offer names one by one, for a preview of their values.
const NEWEST_MAX: usize = 3;

/// Offers a recipient the past of a request; `None` where there is nothing to decide: it is no
/// recipient, nothing is open to it, or everything was decided already.
#[must_use]
pub fn past_offer(state: &ConnectorState, past: &Past) -> Option<PastOffer> {
    if !state.networks.recipients(&past.request).contains(&past.recipient)
        || !state.fields_of(&past.request).any(|(_, field)| field.decision().is_mapped())
    {
        return None;
    }
    let decided = state.past.decided_through(&past.request, &past.recipient);
    let is_open = |report: &&PastReport| decided.is_none_or(|through| report.id > through);
    let reports: Vec<&PastReport> = past.reports.iter().filter(is_open).collect();
    let through_report = reports.iter().map(|report| report.id).max()?;
    let mut parts: Vec<PastPart> = Vec::new();
    let mut offered: Vec<&PastReport> = Vec::new();
    for report in reports {
        // From the end: neighbours have the same consents.
        let known = parts.iter().rposition(|part| part.consents == report.consents);
        let known = known.unwrap_or_else(|| {
            parts.push(part(state, past, report));
            parts.len() - 1
        });
        let part = &mut parts[known];
        part.report_count += 1;
        part.from = part.from.min(report.created_at);
        part.until = part.until.max(report.created_at);
        if part.is_offered() {
            offered.push(report);
        }
    }
    let newest = offered.len().saturating_sub(NEWEST_MAX);
    let newest = offered[newest..].iter().map(|report| report.id).collect();
    offered.sort_by_key(|report| report_number(report));
    Some(PastOffer {
        parts,
        ranges: ranges(&offered),
        report_count: offered.len() as u64,
        root: past_root(offered.iter().map(|report| report.values)),
        through_report,
        newest,
    })
}

/// Judges the reports that left under the same consents as this one; counts none of them.
fn part(state: &ConnectorState, past: &Past, report: &PastReport) -> PastPart {
    let present: BTreeMap<FieldName, &DisclosurePolicy> = state
        .fields_of(&past.request)
        .filter(|(_, field)| field.decision().is_mapped())
        .map(|(key, field)| (key.field_name, &**field.gate().policy()))
        .collect();
    let (mut closed_fields, mut looser_fields) = (Vec::new(), Vec::new());
    for (name, version) in &*report.consents {
        let Some(present) = present.get(name) else {
            closed_fields.push(name.clone());
            continue;
        };
        // A consent that is not known any more may have been to anything.
        let former = past.policies.get(&(name.clone(), *version));
        if !former.is_some_and(|former| present.allows_all_of(former)) {
            looser_fields.push(name.clone());
        }
    }
    PastPart {
        consents: report.consents.clone(),
        report_count: 0,
        from: report.created_at,
        until: report.created_at,
        closed_fields,
        looser_fields,
    }
}

const fn report_number(report: &PastReport) -> (u16, u32, u32) {
    (report.data_set_writer_id, report.epoch, report.sequence)
}

/// Groups reports, sorted by writer, epoch and sequence number, with neighbouring numbers.
fn ranges(reports: &[&PastReport]) -> Vec<(SequenceRange, ledger::Hash)> {
    let follows = |earlier: &&PastReport, later: &&PastReport| {
        (earlier.data_set_writer_id, earlier.epoch) == (later.data_set_writer_id, later.epoch)
            && earlier.sequence.checked_add(1) == Some(later.sequence)
    };
    let range = |neighbours: &[&PastReport]| {
        let (first, last) = (neighbours[0], neighbours[neighbours.len() - 1]);
        let range = SequenceRange {
            data_set_writer_id: first.data_set_writer_id,
            epoch: first.epoch,
            first_sequence: first.sequence,
            last_sequence: last.sequence,
        };
        (range, past_root(neighbours.iter().map(|report| report.values)))
    };
    reports.chunk_by(follows).map(range).collect()
}
