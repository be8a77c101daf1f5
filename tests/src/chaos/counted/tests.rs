//! Reports that lack what they have to have.

use serde_json::{Value, json};

use super::*;
use crate::{
    chaos::content::{Content, FieldContent},
    frame_order::MUNICH,
};

/// Ticks between two reports.
const EACH: i64 = COUNTED_EACH_MS * (TICKS_A_SECOND / 1000);
/// Reports of each request: those of 50 s.
const COUNT: i64 = 200;

type All = BTreeMap<ReportKey, Left>;

fn field(value: Value, time: i64) -> FieldContent {
    FieldContent { value, status: "Good".to_owned(), source_time: Some(time) }
}

/// Returns reports of all requests, of which each has all fields. The last one says that the machines are gone.
fn all() -> All {
    let mut all = BTreeMap::new();
    for (writer, request) in (0..).zip(load::requests(MUNICH)) {
        for sequence in 0..=COUNT {
            let time = sequence * EACH;
            let fields = load::FIELDS.map(|name| {
                let is_count = name == load::COUNTED || name == load::STEPS;
                let value = if is_count { json!(sequence.to_string()) } else { json!(1.5) };
                let gone = FieldContent { status: "Bad".to_owned(), ..field(Value::Null, time) };
                (name.to_owned(), if sequence == COUNT { gone } else { field(value, time) })
            });
            let content = Content {
                request: request.clone(),
                report_time: Some(time),
                shopfloor_time: Some(time),
                fields: fields.into(),
                ..Content::default()
            };
            let key = ReportKey { factory: MUNICH.to_owned(), writer, epoch: 1, sequence };
            let left = Left { id: sequence, state: "DONE".to_owned(), recipients: 1, content };
            all.insert(key, left);
        }
    }
    all
}

/// Returns the faults after a change to the reports of the second request, from one number to another.
fn changed(
    range: std::ops::Range<i64>,
    disturbed: &[Span],
    change: impl Fn(&mut Left),
) -> Vec<String> {
    let mut all = all();
    for (key, left) in &mut all {
        if key.writer == 1 && range.contains(&key.sequence) {
            change(left);
        }
    }
    faults(MUNICH, &all, &Disturbances::of_munich(disturbed), COUNT * EACH)
}

fn without(name: &'static str) -> impl Fn(&mut Left) {
    move |left| drop(left.content.fields.remove(name))
}

fn of(left: &mut Left, name: &str) -> FieldContent {
    left.content.fields.remove(name).expect("a field")
}

fn span(from: i64, to: i64) -> Span {
    Span { from: from * EACH, to: to * EACH }
}

#[test]
fn counts_are_missing_only_where_something_was_disturbed() {
    let all = |lost: std::ops::Range<i64>| -> Counts {
        (0..100).filter(|count| !lost.contains(count)).map(|count| (count, count * 10)).collect()
    };
    assert_eq!(holes(&all(0..0), &[]).0, [""; 0]);
    assert_eq!(holes(&all(40..60), &[]).0.len(), 1);
    assert_eq!(holes(&all(40..60), &[Span { from: 420, to: 450 }]).0, [""; 0]);
    assert_eq!(holes(&all(40..60), &[Span { from: 700, to: 800 }]).0.len(), 1);
}

#[test]
fn a_disturbance_excuses_what_is_lost_around_it_and_no_more() {
    let second = TICKS_A_SECOND / EACH;
    let lost = |from: i64, to: i64, disturbed: &[Span]| {
        let counts = (0..400).filter(|count| !(from..to).contains(count));
        holes(&counts.map(|count| (count, count * EACH)).collect(), disturbed).0
    };
    let start = [span(100, 100 + 5 * second)];
    assert_eq!(lost(101, 101 + 19 * second, &start), [""; 0]);
    assert_eq!(lost(101, 101 + 25 * second, &start).len(), 1, "25 s after a start");
    let many: Vec<Span> = (0..10).map(|n| span(100 + 20 * n, 120 + 20 * n)).collect();
    assert_eq!(lost(101, 299, &many), [""; 0], "one disturbance after the other");
}

#[test]
fn what_is_lost_all_the_time_is_seen_though_it_is_little() {
    let counts = |is_lost: &dyn Fn(i64) -> bool| -> Counts {
        (0..400).filter(|count| !is_lost(*count)).map(|count| (count, count * EACH)).collect()
    };
    assert_eq!(holes(&counts(&|count| count % 7 == 3), &[]).0.len(), 1, "each seventh");
    assert_eq!(holes(&counts(&|count| count % 10 == 3), &[]).0.len(), 1, "each tenth");
    let in_spells = |count: i64| count % 200 > 160 && count % 2 == 0;
    assert_eq!(holes(&counts(&in_spells), &[]).0, [""; 0], "each second one, by spells");
}

#[test]
fn whole_reports_are_no_fault() {
    assert_eq!(changed(0..0, &[], |_| {}), [""; 0]);
    assert_eq!(changed(0..9, &[], without(load::COUNTED)), [""; 0], "it begins");
}

#[test]
fn a_field_that_one_request_lacks_is_seen() {
    for name in load::FIELDS {
        let faults = changed(0..COUNT, &[], without(name));
        let request = &load::requests(MUNICH)[1];
        assert!(faults.iter().all(|fault| fault.starts_with(request)), "{faults:?}");
        let is_named = faults.iter().any(|fault| fault.contains(&format!(", {name}: reports of")));
        assert!(is_named, "{name}: {faults:?}");
        assert_eq!(changed(90..94, &[], without(name)).len(), 1, "{name}, for a second");
        assert_eq!(changed(90..94, &[span(91, 92)], without(name)), [""; 0], "{name}, disturbed");
    }
    assert!(!changed(20..190, &[span(21, 22)], without(load::COUNTED)).is_empty(), "for too long");
}

#[test]
fn a_field_that_begins_late_or_ends_early_is_seen() {
    let has = |faults: &[String], text: &str| faults.iter().any(|fault| fault.contains(text));
    let late = changed(0..60, &[], without(load::COUNTED));
    assert!(has(&late, "begins late"), "{late:?}");
    let frozen = |left: &mut Left| {
        let frozen = field(json!("99"), 99 * EACH);
        left.content.fields.insert(load::COUNTED.to_owned(), frozen);
    };
    let early = changed(100..COUNT, &[], frozen);
    assert!(has(&early, "ends early"), "{early:?}");
    assert_eq!(changed(190..COUNT, &[], without(load::COUNTED)), [""; 0], "the machines stop");
}

#[test]
fn too_few_judged_counts_are_seen() {
    let faults = changed(0..0, &[span(0, COUNT - 5)], |_| {});
    let few =
        faults.iter().filter(|fault| fault.contains("counts of undisturbed times were judged"));
    assert_eq!(few.count(), 6, "{faults:?}");
    let one = changed(1..COUNT, &[], without(load::STEPS));
    assert!(one.iter().any(|fault| fault.contains("steps: only 0 counts")), "{one:?}");
}

#[test]
fn a_script_state_that_goes_back_is_seen() {
    let restarted = |left: &mut Left| {
        let mut step = of(left, load::STEPS);
        let count: i64 = step.value.as_str().expect("a count").parse().expect("a number");
        step.value = json!((count - 100).to_string());
        left.content.fields.insert(load::STEPS.to_owned(), step);
    };
    let faults = changed(150..COUNT, &[span(0, COUNT)], restarted);
    assert!(faults.iter().any(|fault| fault.contains("goes back from 149 to 50")), "{faults:?}");
}

#[test]
fn a_status_or_time_that_a_machine_did_not_give_is_seen() {
    let bad = |left: &mut Left| {
        let mut count = of(left, load::COUNTED);
        count.status = "Bad".to_owned();
        left.content.fields.insert(load::COUNTED.to_owned(), count);
    };
    assert_eq!(changed(90..94, &[], bad), [""; 0], "for a moment");
    assert_eq!(changed(90..110, &[], bad).len(), 1);
    assert_eq!(changed(90..110, &[span(91, 92)], bad), [""; 0]);
    let good = |left: &mut Left| {
        left.content.fields.insert(load::COUNTED.to_owned(), field(Value::Null, COUNT * EACH));
    };
    let faults = changed(COUNT..COUNT + 1, &[], good);
    assert!(faults.iter().any(|fault| fault.contains("good after the machines")), "{faults:?}");
    let shifted = |left: &mut Left| {
        let mut count = of(left, load::COUNTED);
        count.source_time = count.source_time.map(|time| time - 300 * TICKS_A_SECOND);
        left.content.fields.insert(load::COUNTED.to_owned(), count);
    };
    let faults = changed(90..94, &[span(0, COUNT / 2)], shifted);
    assert!(
        faults.iter().any(|fault| fault.contains("have another time than their own")),
        "{faults:?}"
    );
}
