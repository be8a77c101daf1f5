//! Signals: pure functions of seed and simulated time.

use crate::orders::{OrderPhase, OrderProgress, OrderRhythm};

/// A moment of a simulation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moment {
    pub seed: u64,
    /// Simulated seconds since the simulation's epoch; never negative.
    pub seconds: f64,
}

/// A well mixed number for each seed, stream and index (SplitMix64).
#[must_use]
pub const fn hash(seed: u64, stream: u64, index: u64) -> u64 {
    let mut x = seed
        ^ stream.wrapping_mul(0x9E37_79B9_7F4A_7C15)
        ^ index.wrapping_mul(0xD1B5_4A32_D192_ED03);
    x = x.wrapping_add(0x9E37_79B9_7F4A_7C15);
    x = (x ^ (x >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    x ^ (x >> 31)
}

/// A number in 0..1 for each seed, stream and index.
#[must_use]
pub fn uniform(seed: u64, stream: u64, index: u64) -> f64 {
    (hash(seed, stream, index) >> 11) as f64 / (1_u64 << 53) as f64
}

impl Moment {
    /// Smooth noise in -1..1 that wanders within about `period` seconds.
    #[must_use]
    pub fn noise(&self, stream: u64, period: f64) -> f64 {
        let position = self.seconds / period;
        let index = position.floor();
        let between = position - index;
        let index = index as u64;
        let (from, to) = (uniform(self.seed, stream, index), uniform(self.seed, stream, index + 1));
        let weight = (1.0 - (between * std::f64::consts::PI).cos()) / 2.0;
        (from + (to - from) * weight) * 2.0 - 1.0
    }

    /// A sine in -1..1 with a phase of its own per seed and stream.
    #[must_use]
    pub fn wave(&self, stream: u64, period: f64) -> f64 {
        let phase = uniform(self.seed, stream, 0);
        ((self.seconds / period + phase) * std::f64::consts::TAU).sin()
    }
}

/// Rounded to a multiple of `step`, as a converter with limited resolution gives it.
#[must_use]
pub fn quantised(value: f64, step: f64) -> f64 {
    let steps = (value / step).round();
    // The reciprocal of a decimal step is exact, the step itself is not: 0.1 * 3 would be
    // 0.30000000000000004.
    if step < 1.0 { steps / (1.0 / step).round() } else { steps * step }
}

/// Rhythm of production: one part per cycle, one interruption per period. With orders, they say when the machine works.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Production {
    /// Time from part to part, in seconds.
    pub cycle: f64,
    /// Seconds from one interruption's period to the next.
    pub period: f64,
    /// Seconds that an interruption lasts.
    pub interruption: f64,
    /// Orders that are worked off; none where the machine produces without end.
    pub orders: Option<OrderRhythm>,
}

/// Progress of production at a moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Seconds that it has been producing in all.
    pub running_seconds: f64,
    /// Parts finished: of the present order, where there are orders.
    pub parts: u64,
    /// Parts finished in all.
    pub parts_in_all: u64,
    /// Parts of [`Self::parts`] that were no good.
    pub scrap: u64,
    /// Completed fraction of the current part, 0..1.
    pub cycle_progress: f64,
    /// The kind of the present interruption, 0 to 255, where there is one.
    pub interruption: Option<u8>,
    /// Interruptions that have begun so far.
    pub interruptions: u64,
    pub order: Option<OrderProgress>,
}

impl Progress {
    /// True while parts are made.
    #[must_use]
    pub fn works(&self) -> bool {
        self.interruption.is_none()
            && self.order.is_none_or(|order| order.phase == OrderPhase::Running)
    }
}

/// One part in so many is scrap.
const PARTS_PER_SCRAP: u64 = 25;
const INTERRUPTIONS: u64 = 1;
const INTERRUPTION_KINDS: u64 = 2;
const PART_TIMES: u64 = 3;
const SCRAP: u64 = 4;
const ORDERS: u64 = 5;
/// Kind of the interruption in an order: an alarm.
const FAILURE: u8 = 0;

impl Production {
    /// Returns the progress at a moment.
    #[must_use]
    pub fn at(&self, moment: Moment) -> Progress {
        match self.orders {
            Some(rhythm) => self.in_orders(rhythm, moment),
            None => self.without_end(moment),
        }
    }

    fn in_orders(&self, rhythm: OrderRhythm, moment: Moment) -> Progress {
        let order = rhythm.at(moment.seconds, self.cycle);
        let seed = hash(moment.seed, ORDERS, order.index);
        let quantity = u64::from(rhythm.quantity);
        let (parts, cycle_progress) = self.parts(seed, order.worked);
        let parts = parts.min(quantity);
        Progress {
            running_seconds: order.worked_in_all,
            parts,
            parts_in_all: order.index * quantity + parts,
            scrap: scrap(seed, parts),
            cycle_progress,
            interruption: (order.phase == OrderPhase::Interrupted).then_some(FAILURE),
            interruptions: order.failures,
            order: Some(order),
        }
    }

    fn without_end(&self, moment: Moment) -> Progress {
        let period = (moment.seconds / self.period).floor();
        let index = period as u64;
        let within = moment.seconds - period * self.period;
        let begin = uniform(moment.seed, INTERRUPTIONS, index) * (self.period - self.interruption);
        let is_interrupted = (begin..begin + self.interruption).contains(&within);
        let running_within = within.min(begin) + (within - begin - self.interruption).max(0.0);
        let running_seconds = period * (self.period - self.interruption) + running_within;
        let (parts, cycle_progress) = self.parts(moment.seed, running_seconds);
        Progress {
            running_seconds,
            parts,
            parts_in_all: parts,
            scrap: scrap(moment.seed, parts),
            cycle_progress,
            interruption: is_interrupted
                .then(|| hash(moment.seed, INTERRUPTION_KINDS, index) as u8),
            interruptions: index + u64::from(within >= begin),
            order: None,
        }
    }

    /// A part is finished in the second half of its cycle, at a moment of its own.
    fn parts(&self, seed: u64, running_seconds: f64) -> (u64, f64) {
        let cycle = (running_seconds / self.cycle).floor();
        let index = cycle as u64;
        let within = running_seconds / self.cycle - cycle;
        let done_at = 0.55 + 0.4 * uniform(seed, PART_TIMES, index);
        (index + u64::from(within >= done_at), (within / done_at).min(1.0))
    }
}

/// Exactly one part of each block is scrap, so that counting needs no history.
fn scrap(seed: u64, parts: u64) -> u64 {
    let block = parts / PARTS_PER_SCRAP;
    let position = hash(seed, SCRAP, block) % PARTS_PER_SCRAP;
    block + u64::from(parts % PARTS_PER_SCRAP > position)
}

#[cfg(test)]
mod tests {
    use super::*;

    const PRODUCTION: Production =
        Production { cycle: 4.0, period: 600.0, interruption: 40.0, orders: None };

    #[test]
    fn counters_only_grow_by_one_and_scrap_is_part_of_them() {
        let mut last = PRODUCTION.at(Moment { seed: 7, seconds: 0.0 });
        assert_eq!((last.parts, last.scrap), (0, 0));
        for tenth in 1..60_000 {
            let next = PRODUCTION.at(Moment { seed: 7, seconds: f64::from(tenth) / 10.0 });
            assert!((0..=1).contains(&(next.parts - last.parts)), "{last:?} {next:?}");
            assert!((0..=1).contains(&(next.scrap - last.scrap)), "{last:?} {next:?}");
            assert!(next.scrap <= next.parts);
            if last.interruption.is_some() && next.interruption.is_some() {
                assert_eq!(last.parts, next.parts, "nothing is made while interrupted");
            }
            last = next;
        }
        assert_eq!(last.parts, 1400);
        assert_eq!(last.interruptions, 10);
    }

    #[test]
    fn an_order_is_counted_from_its_start_to_its_quantity_and_no_further() {
        let rhythm = OrderRhythm { quantity: 12, begins_after: 20.0, every: 100.0, failure: None };
        let production = Production { orders: Some(rhythm), ..PRODUCTION };
        for seconds in 0..1000 {
            let progress = production.at(Moment { seed: 7, seconds: f64::from(seconds) });
            let order = progress.order.expect("there are orders");
            assert!(progress.parts <= 12 && progress.scrap <= progress.parts, "{progress:?}");
            assert_eq!(progress.works(), order.phase == OrderPhase::Running);
            match order.phase {
                OrderPhase::Waiting => assert_eq!(progress.parts, 0),
                OrderPhase::Done => assert_eq!(progress.parts, 12, "{progress:?}"),
                _ => assert!(f64::from(seconds) - order.start < 48.0, "{progress:?}"),
            }
        }
        let last = production.at(Moment { seed: 7, seconds: 999.0 });
        assert_eq!((last.parts, last.parts_in_all), (12, 120));
    }

    #[test]
    fn the_same_moment_is_always_the_same() {
        let moment = Moment { seed: 1, seconds: 12_345.6 };
        assert_eq!(PRODUCTION.at(moment), PRODUCTION.at(moment));
        assert!((moment.noise(5, 10.0) - moment.noise(5, 10.0)).abs() < f64::EPSILON);
        assert_ne!(hash(1, 2, 3), hash(2, 2, 3));
    }

    #[test]
    fn noise_is_bounded_and_smooth() {
        let mut last = Moment { seed: 3, seconds: 0.0 }.noise(1, 10.0);
        for hundredth in 1..10_000 {
            let next = Moment { seed: 3, seconds: f64::from(hundredth) / 100.0 }.noise(1, 10.0);
            assert!(next.abs() <= 1.0 && (next - last).abs() < 0.01);
            last = next;
        }
    }

    #[test]
    fn quantised_values_are_clean_decimals() {
        for (value, step, expected) in
            [(0.3000001, 0.1, 0.3), (21.37, 0.05, 21.35), (1234.0, 100.0, 1200.0)]
        {
            assert!((quantised(value, step) - expected).abs() < 1e-12, "{value}");
        }
    }
}
