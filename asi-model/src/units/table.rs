//! The table of units: UNECE Recommendation 20 (and 21 for packages, with the leading X of
//! Recommendation 20), a text with a line for each unit in the order of codes.
//!
//! Nothing but the starts of the lines is kept beside the text. The first unit of a quantity with
//! factor 1 is its base unit. Units without a fixed relation to others do not convert.

use super::unit::{EngineeringUnit, Quantity};

/// The lines, which `units/update.mjs` writes and describes.
const TEXT: &str = include_str!("../../units/units.tsv");
/// Number of units.
pub(super) const COUNT: usize = count(TEXT.as_bytes());
static STARTS: [u32; COUNT] = starts(TEXT.as_bytes());

const fn count(text: &[u8]) -> usize {
    let (mut at, mut lines) = (0, 0);
    while at < text.len() {
        if text[at] == b'\n' {
            lines += 1;
        }
        at += 1;
    }
    lines
}

#[expect(clippy::cast_possible_truncation, reason = "the text is shorter than 4 GiB")]
const fn starts(text: &[u8]) -> [u32; COUNT] {
    let mut starts = [0; COUNT];
    let (mut at, mut line) = (0, 1);
    while line < COUNT {
        if text[at] == b'\n' {
            starts[line] = at as u32 + 1;
            line += 1;
        }
        at += 1;
    }
    starts
}

/// A line of the table.
#[derive(Clone, Copy)]
pub(super) struct UnitRow {
    pub(super) code: &'static str,
    pub(super) alias: &'static str,
    name: &'static str,
    symbol: &'static str,
    /// Quantity, factor and offset; empty where the unit converts into no other.
    conversion: &'static str,
}

impl UnitRow {
    /// The line at a position below [`COUNT`].
    pub(super) fn at(position: usize) -> Self {
        let line = &TEXT[STARTS[position] as usize..];
        let mut columns = line.lines().next().unwrap_or_default().splitn(5, '\t');
        let mut next = || columns.next().unwrap_or_default();
        Self { code: next(), alias: next(), name: next(), symbol: next(), conversion: next() }
    }

    /// The line of a code.
    pub(super) fn of(code: &str) -> Option<Self> {
        let (mut low, mut high) = (0, COUNT);
        while low < high {
            let middle = usize::midpoint(low, high);
            let row = Self::at(middle);
            match row.code.cmp(code) {
                std::cmp::Ordering::Less => low = middle + 1,
                std::cmp::Ordering::Greater => high = middle,
                std::cmp::Ordering::Equal => return Some(row),
            }
        }
        None
    }

    /// The symbol, or the name of a unit without one.
    pub(super) const fn display_name(&self) -> &'static str {
        if self.symbol.is_empty() { self.name } else { self.symbol }
    }

    pub(super) const fn has_symbol(&self) -> bool {
        !self.symbol.is_empty()
    }

    pub(super) fn unit(&self) -> EngineeringUnit {
        let mut columns = self.conversion.split('\t');
        let quantity = columns.next().and_then(Quantity::from_name).unwrap_or(Quantity::Other);
        let mut number =
            |otherwise| columns.next().and_then(|n| n.parse().ok()).unwrap_or(otherwise);
        EngineeringUnit {
            code: self.code,
            display_name: self.display_name(),
            description: self.name,
            quantity,
            factor: number(1.0),
            offset: number(0.0),
        }
    }
}
