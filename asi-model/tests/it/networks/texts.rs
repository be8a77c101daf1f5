//! Random texts, ids, units, quantities and times.

use asi_model::{DateTime, units::EngineeringUnit};
use proptest::{collection::vec, prelude::*, sample::select};

/// Pieces that get lost where something is trimmed, unescaped once too often or taken for a
/// separator.
const PIECES: [&str; 40] = [
    " ",
    "  ",
    "\u{a0}",
    "\u{3000}",
    "\u{2028}",
    "\u{2009}",
    "\u{feff}",
    "%",
    "%20",
    "%25",
    "%2F",
    "/",
    "#",
    "]]>",
    "<![CDATA[",
    "<a>",
    "&amp;",
    "&",
    "\"",
    "'",
    "--",
    "1:",
    "ns=1;",
    "nsu=urn:x;",
    "s=",
    ";",
    "\\",
    "\\u0041",
    "{",
    "}",
    "[",
    ",",
    "ü",
    "é",
    "漢",
    "😀",
    "\u{10ffff}",
    "\u{fffd}",
    "x",
    "Frame-1",
];

/// Pieces that ids must not have, but texts may.
const BREAKS: [&str; 5] = ["\t", "\n", "\r", "\r\n", "\u{9f}"];

fn pieces(breaks: bool, count_max: usize) -> impl Strategy<Value = String> {
    let mut all = PIECES.to_vec();
    if breaks {
        all.extend(BREAKS);
    }
    vec(select(all), 0..count_max).prop_map(|pieces| pieces.concat())
}

pub fn text() -> impl Strategy<Value = String> {
    pieces(true, 6)
}

pub fn said() -> impl Strategy<Value = String> {
    (pieces(true, 4), pieces(true, 4)).prop_map(|(before, after)| format!("{before}said{after}"))
}

/// Distinct ids with whatever may stand at their ends.
pub fn ids(count: usize) -> impl Strategy<Value = Vec<String>> {
    vec((pieces(false, 4), pieces(false, 4)), count).prop_map(|ends| {
        ends.into_iter()
            .enumerate()
            .map(|(number, (before, after))| format!("{before}({number}){after}"))
            .collect()
    })
}

/// An id for the part with this number, which leaves one end of the whole's as it is.
pub fn numbered(id: &str, number: usize) -> String {
    if number.is_multiple_of(2) { format!("{number}{id}") } else { format!("{id}{number}") }
}

pub fn name() -> impl Strategy<Value = String> {
    "[A-Za-z0-9_-]{1,12}"
}

pub fn quantity() -> impl Strategy<Value = f64> {
    prop_oneof![
        (0_u32..1000).prop_map(f64::from),
        0.0..1e9_f64,
        Just(f64::MAX),
        Just(f64::MIN_POSITIVE),
        Just(0.1)
    ]
}

pub fn unit() -> impl Strategy<Value = String> {
    let all: Vec<EngineeringUnit> = EngineeringUnit::all().collect();
    (select(all), any::<bool>())
        .prop_map(|(unit, by_code)| if by_code { unit.code.to_owned() } else { unit.alias() })
}

pub fn time() -> impl Strategy<Value = DateTime> {
    prop_oneof![
        Just(DateTime::MIN),
        Just(DateTime::MAX),
        (0..DateTime::MAX.ticks()).prop_map(DateTime::from_ticks),
        (0..DateTime::MAX.ticks() / 10_000_000)
            .prop_map(|seconds| DateTime::from_ticks(seconds * 10_000_000)),
    ]
}
