//! Factors of units against QUDT, an ontology of others (`tests/units`).

use std::collections::{BTreeMap, HashMap};

use asi_model::units::{EngineeringUnit, Quantity, convert, lookup};

/// A unit as QUDT has it: a value in SI units is `(value + offset) * multiplier`.
struct KnownUnit {
    multiplier: f64,
    offset: f64,
    dimensions: &'static str,
}

impl KnownUnit {
    fn convert(&self, value: f64, to: &Self) -> f64 {
        (value + self.offset) * self.multiplier / to.multiplier - to.offset
    }
}

/// Units that QUDT does not have, or with an angle (revolutions), each with its definition by another one.
const DEFINED: [(&str, f64, &str); 9] = [
    ("B7", 1.0, "H87"),
    ("DZN", 12.0, "H87"),
    ("EA", 1.0, "H87"),
    ("GRO", 144.0, "H87"),
    ("KLX", 1000.0, "LUX"),
    ("NX", 0.1, "P1"),
    ("PR", 2.0, "H87"),
    ("RPM", 1.0, "C94"),
    ("RPS", 1.0, "HTZ"),
];

fn table() -> BTreeMap<&'static str, KnownUnit> {
    let read = |line: &'static str| {
        let columns: [&'static str; 5] =
            line.split('\t').collect::<Vec<_>>().try_into().expect("five columns");
        let [code, _, multiplier, offset, dimensions] = columns;
        let number = |text: &str| text.parse::<f64>().expect("a number");
        (code, KnownUnit { multiplier: number(multiplier), offset: number(offset), dimensions })
    };
    include_str!("../units/qudt.tsv").lines().map(read).collect()
}

fn unit(code: &str) -> EngineeringUnit {
    lookup(code).filter(|unit| unit.code == code).expect(code)
}

#[test]
fn conversions_agree_with_qudt() {
    let table = table();
    let mut count = 0;
    for (from, known) in &table {
        for (to, other) in &table {
            // QUDT rounds, the torr most of all.
            let tolerance = if [*from, *to].contains(&"UA") { 3e-6 } else { 2e-7 };
            for value in [1.0, 100.0] {
                let Ok(found) = convert(value, &unit(from), &unit(to)) else { continue };
                assert_eq!(known.dimensions, other.dimensions, "{from} to {to}");
                let expected = known.convert(value, other);
                let is_alike = (found - expected).abs() <= expected.abs() * tolerance;
                assert!(is_alike, "{value} {from} are {found} {to}, but {expected} in QUDT");
                count += 1;
            }
        }
    }
    assert!(count > 3_000, "{count}");
}

#[test]
fn every_unit_that_converts_is_compared() {
    let table = table();
    let mut counts = HashMap::<Quantity, usize>::new();
    for unit in EngineeringUnit::all() {
        *counts.entry(unit.quantity).or_default() += 1;
    }
    for unit in EngineeringUnit::all() {
        let converts = !matches!(unit.quantity, Quantity::Other | Quantity::Packaging)
            && counts[&unit.quantity] > 1;
        let is_defined = DEFINED.iter().any(|(code, ..)| *code == unit.code);
        assert!(!converts || is_defined || table.contains_key(unit.code), "{}", unit.code);
    }
    for (code, factor, other) in DEFINED {
        let found = convert(1.0, &unit(code), &unit(other)).expect("the same quantity");
        assert!((found - factor).abs() <= factor * 1e-12, "{code}: {found}");
        assert!(!table.contains_key(code), "{code}");
    }
}
