//! Values that machines count at a steady rate, and steps that scripts count: each is in a report, but for those of the
//! times in which a connector or its machines were killed, stood still or had no disk.

use std::collections::BTreeMap;

use super::{
    disturbances::Span,
    stores::{Left, ReportKey},
};
use crate::{scenario::load, world::counters::COUNTED_EACH_MS};

/// Values that one disturbance may cost at most: those of 30 s.
const HOLE_MAX: i64 = 30 * 1000 / COUNTED_EACH_MS;
/// Part of the other values, of a hundred, that may be missing: where a processor has too much to do, two come in one
/// notification, and the report has the second.
const MISSING_MAX: i64 = 15;

/// Value of a counter and its time at the machine.
type Counts = BTreeMap<i64, i64>;

/// Returns the requests whose reports lack values.
pub(super) fn faults(
    factory: &str,
    left: &BTreeMap<ReportKey, Left>,
    disturbed: &[Span],
) -> Vec<String> {
    let mut faults = Vec::new();
    for name in [load::COUNTED, load::STEPS] {
        let counters = counters(left, name);
        if counters.is_empty() {
            faults.push(format!("{factory}: no report has a value of {name}"));
        }
        for (request, counts) in counters {
            let holes = holes(&counts, disturbed).into_iter();
            faults.extend(holes.map(|hole| format!("{request}, {name}: {hole}")));
        }
    }
    faults
}

/// Returns the values of a field that counts, by request.
fn counters<'l>(left: &'l BTreeMap<ReportKey, Left>, name: &str) -> BTreeMap<&'l str, Counts> {
    let mut counters: BTreeMap<&str, Counts> = BTreeMap::new();
    for report in left.values() {
        let Some(field) = report.content.fields.get(name) else { continue };
        // A number of 64 bits is a text in JSON.
        let count = field.value.as_str().and_then(|text| text.parse().ok());
        if let Some((count, time)) = count.zip(field.source_time) {
            let counts = counters.entry(&report.content.request).or_default();
            // Later reports carry it again.
            counts.entry(count).and_modify(|first| *first = time.min(*first)).or_insert(time);
        }
    }
    counters
}

fn holes(counts: &Counts, disturbed: &[Span]) -> Vec<String> {
    let mut faults = Vec::new();
    let (mut missing, mut judged) = (0, 0);
    for ((before, from), (after, to)) in counts.iter().zip(counts.iter().skip(1)) {
        let lost = after - before - 1;
        if disturbed.iter().any(|span| span.meets(*from.min(to), *to.max(from))) {
            if lost > HOLE_MAX {
                faults.push(format!("{lost} counts after {before} are lost by one disturbance"));
            }
        } else {
            missing += lost;
            judged += lost + 1;
        }
    }
    if missing * 100 > judged * MISSING_MAX {
        faults.push(format!("{missing} of {judged} counts of undisturbed times are in no report"));
    }
    faults
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_missing_only_where_something_was_disturbed() {
        let all = |lost: std::ops::Range<i64>| -> Counts {
            (0..100)
                .filter(|count| !lost.contains(count))
                .map(|count| (count, count * 10))
                .collect()
        };
        assert_eq!(holes(&all(0..0), &[]), [""; 0]);
        assert_eq!(holes(&all(40..60), &[]).len(), 1);
        assert_eq!(holes(&all(40..60), &[Span { from: 420, to: 450 }]), [""; 0]);
        assert_eq!(holes(&all(40..60), &[Span { from: 700, to: 800 }]).len(), 1);
    }
}
