//! Times in which a connector may miss what its machines count.

use std::collections::BTreeMap;

use asi_model::DateTime;

use super::plan::Fault;
use crate::frame_order::{HAMBURG, MUNICH};

/// Ticks in which sessions and subscriptions are made again after a disturbance.
const SETTLING: i64 = 5 * TICKS_A_SECOND;
/// Ticks of 100 ns.
pub(super) const TICKS_A_SECOND: i64 = 10_000_000;

/// Times from and to, in ticks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Span {
    pub from: i64,
    pub to: i64,
}

impl Span {
    /// True where both have a time in common.
    pub const fn meets(&self, from: i64, to: i64) -> bool {
        self.from <= to && from <= self.to
    }
}

/// Disturbances of each factory.
#[derive(Debug, Default)]
pub(super) struct Disturbances {
    all: BTreeMap<&'static str, Vec<Span>>,
}

impl Disturbances {
    /// Returns those of a factory.
    pub fn of(&self, factory: &str) -> &[Span] {
        self.all.get(factory).map_or(&[], Vec::as_slice)
    }

    /// Notes a fault that has been over since now.
    pub fn struck(&mut self, fault: Fault, from: i64) {
        for factory in [MUNICH, HAMBURG] {
            if disturbs(fault, factory) {
                self.put(factory, from);
            }
        }
    }

    /// Notes that a factory's program has ended by itself, since it was seen to run.
    pub fn ended(&mut self, factory: &'static str, from: i64) {
        self.put(factory, from);
    }

    /// Makes some of one factory.
    #[cfg(test)]
    pub fn of_munich(spans: &[Span]) -> Self {
        Self { all: BTreeMap::from([(MUNICH, spans.to_vec())]) }
    }

    fn put(&mut self, factory: &'static str, from: i64) {
        let span = Span { from, to: now() + SETTLING };
        self.all.entry(factory).or_default().push(span);
    }
}

/// Returns the time in ticks, by the clock that the machines have.
pub(super) fn now() -> i64 {
    DateTime::from(time::OffsetDateTime::now_utc()).ticks()
}

fn disturbs(fault: Fault, factory: &str) -> bool {
    match fault {
        Fault::KillAll => true,
        Fault::KillConnector(whose)
        | Fault::KillMachines(whose)
        | Fault::ConnectorClock(whose, _)
        | Fault::FullDisk(whose, _)
        | Fault::PauseConnector(whose, _) => whose == factory,
        _ => false,
    }
}
