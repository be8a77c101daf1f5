//! Values that machines count at a steady rate, and steps that scripts count: each is in a report, but for those of the
//! times in which a connector or its machines were killed, stood still or had no disk. All fields of a busy writer are
//! in each of its reports, from the beginning to the end.

use std::collections::BTreeMap;

use super::{
    disturbances::{Disturbances, Span, TICKS_A_SECOND},
    observed::Observed,
    stores::{Left, ReportKey},
};
use crate::{scenario::load, world::counters::COUNTED_EACH_MS};

/// Ticks around disturbances for which values may be missing, too: a machine that is busy with something else starts
/// programs and opens sessions slowly.
const AROUND_MAX: i64 = 15 * TICKS_A_SECOND;
/// Part of the other values, of a hundred, that may be missing: where a processor has too much to do, two come in one
/// notification, and the report has the second.
const MISSING_MAX: i64 = 15;
/// Number of undisturbed counts in a row that are looked at together: those of ten seconds.
const WINDOW: usize = 40;
/// Missing ones of a window, in at least half of all windows. A processor with too much to do is so by spells, and what
/// comes in one notification is missing then; a program that loses values does so all the time.
const USUAL_MAX: i64 = 3;
/// Counts of undisturbed times without which a run proves nothing: an outage alone has more.
const JUDGED_MIN: i64 = 12;
/// One of so many counts of undisturbed times is judged at least: the others may be lost around disturbances.
const JUDGED_PART_MIN: i64 = 8;
/// Ticks after the first report, and before the machines stop, in which a field may have no value yet, or none any more.
const EDGE_MAX: i64 = 10 * TICKS_A_SECOND;
/// Ticks for which a value may be not good without a disturbance.
const MOMENT_MAX: i64 = 3 * TICKS_A_SECOND;
/// Ticks by which the time of a count may differ from when the machine counted it: a report has the newest time of all
/// its values, and a count may come late. Clocks that are set differ by more.
const OFF_MAX: i64 = 60 * TICKS_A_SECOND;

/// Values of a counter, each with its first time at the machine.
type Counts = BTreeMap<i64, i64>;

/// Returns what the reports of a factory's busy writers lack. Its machines stopped at `end`.
pub(super) fn faults(
    factory: &str,
    left: &BTreeMap<ReportKey, Left>,
    disturbances: &Disturbances,
    end: i64,
) -> Vec<String> {
    let disturbed = disturbances.of(factory);
    let mut faults = Vec::new();
    for (number, request) in load::requests(factory).iter().enumerate() {
        let reports = Observed::of(left, request);
        let mut found = Vec::new();
        for name in [load::COUNTED, load::STEPS] {
            let counts = reports.counts(name);
            found.extend(
                of_counter(&reports, &counts, disturbed, end).into_iter().map(|f| (name, f)),
            );
        }
        found.extend(unjudged(&reports, disturbed, end).map(|fault| (load::COUNTED, fault)));
        // The consent to the toggled field of the first request ends again and again.
        let fields = load::FIELDS.into_iter().filter(|name| number > 0 || *name != load::TOGGLED);
        for name in fields {
            let is_edge = |span: &Span| span.from == reports.begin() || end - span.to <= MOMENT_MAX;
            let is_free = |span: &Span| is_edge(span) && span.to - span.from <= EDGE_MAX;
            let absent = reports.lacking(name, false, end).into_iter();
            let absent = absent.filter(|span| !is_free(span) && !is_excused(*span, disturbed));
            found.extend(absent.map(|span| (name, lacks(span, end))));
        }
        // A machine that is busy with something else makes a connector take a source for silent for a moment.
        let is_free = |span: &Span| {
            let is_edge = span.from == reports.begin() || span.to == end;
            span.to - span.from <= if is_edge { EDGE_MAX } else { MOMENT_MAX }
        };
        let absent = reports.lacking(load::COUNTED, false, end);
        let bad = reports.lacking(load::COUNTED, true, end).into_iter();
        let bad = bad.filter(|span| !absent.contains(span) && !is_free(span));
        let bad = bad.filter(|span| !is_excused(*span, disturbed));
        found.extend(bad.map(|span| (load::COUNTED, lacks(span, end))));
        // A connector notices that its machines are gone, and says so.
        let ends_well = reports.ends_well(load::COUNTED);
        found.extend(
            ends_well.then(|| (load::COUNTED, "it is good after the machines stopped".to_owned())),
        );
        found.extend(off(&reports.counts(load::COUNTED)).map(|fault| (load::COUNTED, fault)));
        found.extend(set_back(&reports).map(|fault| (load::STEPS, fault)));
        faults.extend(found.into_iter().map(|(name, fault)| format!("{request}, {name}: {fault}")));
    }
    faults
}

fn lacks(span: Span, end: i64) -> String {
    let seconds = (span.to - span.from) / TICKS_A_SECOND;
    let before_end = (end - span.to) / TICKS_A_SECOND;
    format!("reports of {seconds} s lack a good value, {before_end} s before the machines stopped")
}

/// True where a field may have had no good value from one time to another.
fn is_excused(span: Span, disturbed: &[Span]) -> bool {
    meets_any(disturbed, span.from, span.to) && undisturbed(span, disturbed) <= AROUND_MAX
}

/// Returns the ticks of a time in which nothing was disturbed.
fn undisturbed(span: Span, disturbed: &[Span]) -> i64 {
    let mut met: Vec<Span> =
        disturbed.iter().filter(|other| other.meets(span.from, span.to)).copied().collect();
    met.sort_unstable_by_key(|other| other.from);
    let (mut alone, mut through) = (0, span.from);
    for other in met {
        alone += (other.from - through).max(0);
        through = through.max(other.to);
    }
    alone + (span.to - through).max(0)
}

/// Returns where too little of what a machine counted in undisturbed times was judged.
fn unjudged(reports: &Observed<'_>, disturbed: &[Span], end: i64) -> Option<String> {
    let (_, judged) = holes(&reports.counts(load::COUNTED), disturbed);
    let whole = undisturbed(Span { from: reports.begin(), to: end }, disturbed);
    let counted = whole / (COUNTED_EACH_MS * (TICKS_A_SECOND / 1000));
    (judged * JUDGED_PART_MIN < counted)
        .then(|| format!("of {counted} counts of undisturbed times only {judged} could be judged"))
}

fn meets_any(disturbed: &[Span], from: i64, to: i64) -> bool {
    disturbed.iter().any(|span| span.meets(from, to))
}

/// Judges the values of one field that counts.
fn of_counter(
    reports: &Observed<'_>,
    counts: &Counts,
    disturbed: &[Span],
    end: i64,
) -> Vec<String> {
    let times = counts.values();
    let (Some(first), Some(last)) = (times.clone().min(), times.max()) else {
        return vec!["no report has a value".to_owned()];
    };
    let (mut faults, judged) = holes(counts, disturbed);
    for (what, from, to) in [("begins late", reports.begin(), *first), ("ends early", *last, end)] {
        let is_free = to - from <= EDGE_MAX || is_excused(Span { from, to }, disturbed);
        if !is_free {
            faults.push(format!("it {what}, by {} s", (to - from) / TICKS_A_SECOND));
        }
    }
    if judged < JUDGED_MIN {
        faults.push(format!("only {judged} counts of undisturbed times were judged"));
    }
    faults
}

/// Returns what is missing, and the number of counts that were judged.
fn holes(counts: &Counts, disturbed: &[Span]) -> (Vec<String>, i64) {
    let (mut faults, mut in_row) = (Vec::new(), Vec::new());
    for ((before, from), (after, to)) in counts.iter().zip(counts.iter().skip(1)) {
        let lost = after - before - 1;
        let span = Span { from: *from.min(to), to: *to.max(from) };
        if !meets_any(disturbed, span.from, span.to) {
            in_row.push(lost);
        } else if lost > 0 && !is_excused(span, disturbed) {
            faults.push(format!("{lost} counts after {before} are lost by one disturbance"));
        }
    }
    let missing: i64 = in_row.iter().sum();
    let judged = missing + i64::try_from(in_row.len()).unwrap_or(i64::MAX);
    let mut windows: Vec<i64> =
        in_row.chunks_exact(WINDOW).map(|window| window.iter().sum()).collect();
    windows.sort_unstable();
    let usual = windows.get(windows.len() / 2).copied().unwrap_or_default();
    if missing * 100 > judged * MISSING_MAX || usual > USUAL_MAX {
        faults.push(format!("{missing} of {judged} counts of undisturbed times are in no report"));
    }
    (faults, judged)
}

/// Returns what counts were reported with another time than that at which a machine counts them: it counts evenly.
fn off(counts: &Counts) -> Option<String> {
    let each = COUNTED_EACH_MS * (TICKS_A_SECOND / 1000);
    let mut offsets: Vec<i64> = counts.iter().map(|(count, time)| time - count * each).collect();
    offsets.sort_unstable();
    let usual = *offsets.get(offsets.len() / 2)?;
    let wrong = offsets.iter().filter(|offset| (*offset - usual).abs() > OFF_MAX).count();
    (wrong > 0)
        .then(|| format!("{wrong} of {} counts have another time than their own", offsets.len()))
}

/// Returns where the state of a script went back. Nothing excuses that: a state is stored with what the script made of it,
/// and where that cannot be stored, as on a full disk, the script goes on all the same.
fn set_back(reports: &Observed<'_>) -> Option<String> {
    let steps = reports.steps_of(load::STEPS);
    let mut pairs = steps.iter().zip(steps.iter().skip(1));
    let is_back = |((before, _), (after, _)): &(&(i64, i64), &(i64, i64))| after < before;
    pairs.find(is_back).map(|((before, _), (after, _))| {
        format!("the state of the script goes back from {before} to {after}")
    })
}

#[cfg(test)]
mod tests;
