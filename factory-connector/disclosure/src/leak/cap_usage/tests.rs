use asi_model::DateTime;
use proptest::prelude::*;
use serde_json::json;

use super::*;
use crate::DocumentVersion;

const PARTNERS: [&str; 4] = ["acme", "hull", "keel", "mast"];

fn versioned<T>(id: &str, document: T) -> Versioned<T> {
    Versioned {
        key: DocumentVersion { id: id.parse().expect("an id"), version: 1 },
        document,
        changed_by: "eve".to_owned(),
        changed_at: DateTime::from_unix_micros(0),
    }
}

fn alliance(id: &str, members: &[&str]) -> Versioned<Alliance> {
    let document = json!({ "name": id, "memberList": members });
    versioned(id, serde_json::from_value(document).expect("an alliance"))
}

fn cap(id: &str, subject: serde_json::Value, most: f64, variable: Option<u8>) -> Versioned<Cap> {
    let mut document = json!({ "name": id, "subject": subject, "bitsPerHourMax": most });
    if let Some(number) = variable {
        document["variable"] = json!(variable_key(number));
    }
    versioned(id, serde_json::from_value(document).expect("a cap"))
}

fn variable_key(number: u8) -> VariableKey {
    let json = json!({ "sourceId": "mill", "nodeId": format!("nsu=urn:x;i={number}") });
    serde_json::from_value(json).expect("a variable")
}

fn used(bits: Option<f64>, readers: &[&str], variables: &[u8]) -> FieldUse {
    FieldUse {
        field: 0,
        policy: Arc::default(),
        bits_per_hour: bits,
        readers: readers.iter().map(|reader| reader.parse().expect("an id")).collect(),
        variables: variables.iter().copied().map(variable_key).collect(),
    }
}

fn usage(caps: &[Versioned<Cap>], alliances: &[Versioned<Alliance>]) -> CapUsage {
    CapUsage::new(caps.iter().filter_map(|cap| CapInForce::new(cap, alliances.iter())))
}

fn open(usage: &mut CapUsage, used: FieldUse) -> Result<(), Vec<CapExcess>> {
    usage.exchange(&[Exchange { before: None, after: Some(used) }])
}

#[test]
fn allies_are_counted_together_and_a_field_for_both_once() {
    let partner = cap("c", json!({ "partner": "acme" }), 100.0, None);
    let allied = [alliance("a", &["acme", "hull"])];
    for caps in [partner, cap("c", json!({ "allianceId": "a" }), 100.0, None)] {
        let mut usage = usage(&[caps], &allied);
        open(&mut usage, used(Some(60.0), &["acme", "hull"], &[])).expect("within the cap");
        let refused = open(&mut usage, used(Some(60.0), &["hull"], &[])).expect_err("over the cap");
        let figures = (refused[0].bits_per_hour_now, refused[0].bits_per_hour_then);
        assert_eq!(figures, (Some(60.0), Some(120.0)));
        assert!(refused[0].to_string().contains("allows 100.0 bits per hour"), "{}", refused[0]);
        open(&mut usage, used(Some(1e6), &["keel"], &[])).expect("another partner");
        open(&mut usage, used(Some(40.0), &["hull"], &[])).expect("exactly the cap");
    }
}

#[test]
fn a_field_without_a_bound_fits_no_cap() {
    let mut usage = usage(&[cap("c", json!({ "partner": "acme" }), 1e15, None)], &[]);
    let refused = open(&mut usage, used(None, &["acme"], &[])).expect_err("no bound");
    assert_eq!(refused[0].bits_per_hour_then, None);
}

#[test]
fn a_cap_of_a_variable_counts_the_fields_that_rest_on_it() {
    let mut usage = usage(&[cap("c", json!({ "partner": "acme" }), 10.0, Some(1))], &[]);
    open(&mut usage, used(Some(99.0), &["acme"], &[2])).expect("another variable");
    open(&mut usage, used(Some(8.0), &["acme"], &[1, 2])).expect("within the cap");
    open(&mut usage, used(Some(8.0), &["acme"], &[1])).expect_err("in sum too much");
}

#[test]
fn a_change_that_lowers_a_sum_is_never_refused() {
    let mut usage = usage(&[cap("c", json!({ "partner": "acme" }), 10.0, None)], &[]);
    let (much, less) = (used(Some(50.0), &["acme"], &[]), used(Some(20.0), &["acme"], &[]));
    usage.add(&much);
    let lower = Exchange { before: Some(much), after: Some(less.clone()) };
    usage.exchange(&[lower]).expect("lower");
    usage.exchange(&[Exchange { before: Some(less), after: None }]).expect("closed");
    assert_eq!(usage.sum(&"c".parse().expect("an id")).and_then(BitSum::bits), Some(0.0));
}

/// Returns the use of a field until a time, in microseconds after the cap was set.
fn ended(field: i64, policy: &str, bits: f64, at: i64) -> FormerUse {
    let policy = Arc::new(serde_json::from_str(policy).expect("a policy"));
    let used = FieldUse { field, policy, ..used(Some(bits), &["acme"], &[]) };
    FormerUse { used, ended_at: DateTime::from_unix_micros(at) }
}

#[test]
fn a_consent_that_ended_within_the_hour_counts_on() {
    let of_acme = || cap("c", json!({ "partner": "acme" }), 10.0, None);
    let usage = |former: Vec<FormerUse>| usage(&[of_acme()], &[]).after(former.into_iter());
    let (coarse, fine) = (r#"{"minimumIntervalMs":9000}"#, r#"{"minimumIntervalMs":1000}"#);
    let again = |field, policy, bits| ended(field, policy, bits, 0).used;
    // Another field - also the same one, requested again - finds no room.
    let refused = open(&mut usage(vec![ended(1, fine, 8.0, 1)]), again(2, fine, 4.0));
    let excess = &refused.expect_err("both within an hour")[0];
    assert_eq!((excess.bits_per_hour_now, excess.bits_per_hour_then), (Some(8.0), Some(12.0)));
    assert!(excess.to_string().contains("an hour longer"), "{excess}");
    open(&mut usage(vec![ended(1, fine, 8.0, 1)]), again(2, fine, 2.0)).expect("room for two");
    // The same field continues: the finer one of both counts.
    open(&mut usage(vec![ended(1, fine, 8.0, 1)]), again(1, fine, 8.0)).expect("as before");
    open(&mut usage(vec![ended(1, fine, 8.0, 1)]), again(1, coarse, 4.0)).expect("coarser");
    open(&mut usage(vec![ended(1, coarse, 4.0, 1)]), again(1, fine, 8.0)).expect("finer");
    let delayed = r#"{"minimumIntervalMs":500,"delayMs":9}"#;
    open(&mut usage(vec![ended(1, fine, 8.0, 1)]), again(1, delayed, 4.0)).expect_err("neither");
    // What ended before the cap was set does not count.
    open(&mut usage(vec![ended(1, fine, 8.0, 0)]), again(2, fine, 10.0)).expect("from then on");
}

fn any_use() -> impl Strategy<Value = FieldUse> {
    let readers = proptest::sample::subsequence(&PARTNERS[..], 1..=3);
    let variables = proptest::sample::subsequence(vec![1_u8, 2, 3], 0..=2);
    let bits = prop_oneof![9 => (0.0..80.0_f64).prop_map(Some), 1 => Just(None)];
    (bits, readers, variables)
        .prop_map(|(bits, readers, variables)| used(bits, &readers, &variables))
}

proptest! {
    /// Whatever is opened, changed and closed, each sum is that of the open fields, and none is
    /// above its cap.
    #[test]
    fn sums_are_exact_and_stay_within_their_caps(
        steps in prop::collection::vec((0..6_usize, prop::option::weighted(0.8, any_use())), 1..60),
        most in 0.0..200.0_f64,
    ) {
        let allied = [alliance("a", &["acme", "hull"])];
        let caps = [
            cap("partner", json!({ "partner": "hull" }), most, None),
            cap("variable", json!({ "partner": "keel" }), most / 2.0, Some(1)),
            cap("alliance", json!({ "allianceId": "a" }), most / 3.0, Some(2)),
        ];
        let mut usage = usage(&caps, &allied);
        let mut fields: [Option<FieldUse>; 6] = Default::default();
        for (index, after) in steps {
            let change = Exchange { before: fields[index].clone(), after: after.clone() };
            if usage.exchange(&[change]).is_ok() {
                fields[index] = after;
            }
            for cap in &caps {
                let cap = CapInForce::new(cap, allied.iter()).expect("in force");
                let covered = fields.iter().flatten().filter(|used| {
                    let variable = cap.cap.document.variable.as_ref();
                    used.readers.iter().any(|reader| cap.readers.contains(reader))
                        && variable.is_none_or(|own| used.variables.contains(own))
                });
                let naive: Option<f64> = covered.map(|used| used.bits_per_hour).sum();
                let sum = usage.sum(&cap.cap.key.id).and_then(BitSum::bits);
                let (naive, sum) = (naive.expect("bounded"), sum.expect("bounded"));
                prop_assert!((naive - sum).abs() < 1e-6, "{naive} {sum}");
                prop_assert!(naive <= cap.cap.document.bits_per_hour_max + 1e-5);
            }
        }
    }
}
