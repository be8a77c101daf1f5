//! Plan of faults and their times: drawn from a seed alone, so that a run can be played again.

use std::{fmt, time::Duration};

use rand::{Rng as _, SeedableRng as _, seq::IndexedRandom as _};
use rand_chacha::ChaCha8Rng;

use crate::frame_order::{HAMBURG, MUNICH};

/// Name of the platform beside the factories.
pub(super) const PLATFORM: &str = "platform";

/// Failure that is caused. Whatever is killed is started again at once.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fault {
    /// `kill -9` of a factory's connector.
    KillConnector(&'static str),
    /// `kill -9` of platform and broker.
    KillPlatform,
    /// `kill -9` of the broker alone, which the platform starts again.
    KillBroker,
    /// `kill -9` of a factory's machines.
    KillMachines(&'static str),
    /// `kill -9` of everything at once, as when the power fails.
    KillAll,
    /// All connections between factories and broker are reset.
    Cut,
    /// Silence between factories and broker for a while; the connections stay open.
    Stall(Duration),
    /// Silence for so long that a small spool has no room for what waits.
    Outage(Duration),
    /// For a while everything sent is swallowed, then the connections are reset: the peer was gone
    /// all along.
    HalfOpen(Duration),
    /// A thin line for a while.
    Slow(Duration),
    /// Platform and broker are killed, and the broker comes back with an empty store.
    LoseBrokerStore,
    /// Platform and broker are killed, and the broker comes back with the store it had the last
    /// time this happened.
    OldBrokerStore,
    /// Platform and broker are killed, and the broker comes back with every waiting message twice.
    DoubleQueued,
    /// A broker of another make ends and comes back.
    RestartBroker,
    /// The clock of a factory's connector jumps and stays so.
    ConnectorClock(&'static str, ClockOffset),
    /// The platform's clock jumps and stays so.
    PlatformClock(ClockOffset),
    /// The disk of a factory's connector, or of the platform, is full for a while.
    FullDisk(&'static str, Duration),
    /// A factory's connector stands still for a while, as on an overloaded machine.
    PauseConnector(&'static str, Duration),
    /// The platform stands still for a while.
    PausePlatform(Duration),
}

/// Length of an outage: a connector looks every ten seconds whether its spool is too large.
const OUTAGE: Duration = Duration::from_secs(14);
/// Seconds that clocks are off.
const OFFSETS: [i32; 6] = [-5_400, -300, -2, 2, 300, 10_800];

/// Seconds that a clock is off.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ClockOffset(pub i32);

impl Fault {
    /// Number of programs it kills.
    #[must_use]
    pub const fn kills(self) -> u32 {
        match self {
            Self::KillConnector(_)
            | Self::KillPlatform
            | Self::KillBroker
            | Self::KillMachines(_)
            | Self::LoseBrokerStore
            | Self::OldBrokerStore
            | Self::DoubleQueued
            | Self::RestartBroker => 1,
            Self::KillAll => 5,
            _ => 0,
        }
    }

    /// Returns the fault beside a broker of another make: its store is not ours to change.
    #[must_use]
    pub const fn beside_external_broker(self) -> Self {
        match self {
            Self::LoseBrokerStore
            | Self::OldBrokerStore
            | Self::DoubleQueued
            | Self::KillBroker => Self::RestartBroker,
            other => other,
        }
    }

    /// Returns the name for the summary.
    #[must_use]
    pub const fn kind(self) -> &'static str {
        match self {
            Self::KillConnector(_) => "kill connector",
            Self::KillPlatform => "kill platform",
            Self::KillBroker => "kill broker",
            Self::KillMachines(_) => "kill machines",
            Self::KillAll => "kill everything",
            Self::Cut => "cut",
            Self::Stall(_) => "stall",
            Self::Outage(_) => "outage",
            Self::HalfOpen(_) => "half-open",
            Self::Slow(_) => "slow line",
            Self::LoseBrokerStore => "broker store lost",
            Self::OldBrokerStore => "old broker store",
            Self::DoubleQueued => "queued twice",
            Self::RestartBroker => "restart broker",
            Self::ConnectorClock(..) => "connector clock",
            Self::PlatformClock(_) => "platform clock",
            Self::FullDisk(..) => "full disk",
            Self::PauseConnector(..) => "pause connector",
            Self::PausePlatform(_) => "pause platform",
        }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kind = self.kind();
        match self {
            Self::KillConnector(factory) | Self::KillMachines(factory) => {
                write!(f, "{kind} {factory}")
            }
            Self::Stall(span)
            | Self::Outage(span)
            | Self::HalfOpen(span)
            | Self::Slow(span)
            | Self::PausePlatform(span) => {
                write!(f, "{kind} {} ms", span.as_millis())
            }
            Self::FullDisk(factory, span) | Self::PauseConnector(factory, span) => {
                write!(f, "{kind} {factory} {} ms", span.as_millis())
            }
            Self::ConnectorClock(factory, offset) => write!(f, "{kind} {factory} {:+} s", offset.0),
            Self::PlatformClock(offset) => write!(f, "{kind} {:+} s", offset.0),
            _ => f.write_str(kind),
        }
    }
}

/// A fault and how long after the last one it strikes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Strike {
    /// Pause after the fault before.
    pub pause: Duration,
    pub fault: Fault,
}

/// An endless source of rounds.
pub struct Plan {
    random: ChaCha8Rng,
    /// Faults that the next round has whatever is drawn.
    always: Vec<Fault>,
}

impl Plan {
    /// Makes the plan of a seed.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        let random = ChaCha8Rng::seed_from_u64(seed);
        let mut plan = Self { random, always: Vec::new() };
        plan.always = plan.rare_faults();
        plan
    }

    /// Returns faults that are drawn so seldom that a short run would have none of them: a clock that is set, a
    /// full disk, and an outage that a spool is too small for.
    fn rare_faults(&mut self) -> Vec<Fault> {
        let offset = ClockOffset(*OFFSETS.choose(&mut self.random).unwrap_or(&OFFSETS[0]));
        let factory = self.factory();
        let clock = match self.random.random_range(0..3) {
            0 => Fault::PlatformClock(offset),
            _ => Fault::ConnectorClock(factory, offset),
        };
        let whose = *[MUNICH, HAMBURG, PLATFORM].choose(&mut self.random).unwrap_or(&MUNICH);
        vec![clock, Fault::Outage(OUTAGE), Fault::FullDisk(whose, self.span(3_000))]
    }

    /// Returns the faults of the next round; after each round everything must work again.
    pub fn round(&mut self) -> Vec<Strike> {
        let count = self.random.random_range(6..=14);
        let mut strikes = Vec::new();
        for _ in 0..count {
            let fault = self.fault();
            strikes.push(self.strike(fault));
        }
        for fault in std::mem::take(&mut self.always) {
            let place = self.random.random_range(0..=strikes.len());
            let strike = self.strike(fault);
            strikes.insert(place, strike);
        }
        strikes
    }

    fn strike(&mut self, fault: Fault) -> Strike {
        Strike { pause: Duration::from_millis(self.pause_ms()), fault }
    }

    fn factory(&mut self) -> &'static str {
        [MUNICH, HAMBURG].choose(&mut self.random).unwrap_or(&MUNICH)
    }

    /// Mostly short, so that programs die while they start, connect, and catch up.
    fn pause_ms(&mut self) -> u64 {
        match self.random.random_range(0..10) {
            0..4 => self.random.random_range(0..250),
            4..8 => self.random.random_range(250..1_200),
            _ => self.random.random_range(1_200..4_000),
        }
    }

    fn span(&mut self, most_ms: u64) -> Duration {
        Duration::from_millis(self.random.random_range(50..most_ms))
    }

    fn fault(&mut self) -> Fault {
        let factory = self.factory();
        // Now and then it is right again.
        let offset = match self.random.random_range(0..=OFFSETS.len()) {
            0 => ClockOffset(0),
            place => ClockOffset(OFFSETS[place - 1]),
        };
        match self.random.random_range(0..100) {
            0..34 => Fault::KillConnector(factory),
            34..54 => Fault::KillPlatform,
            54..60 => Fault::KillBroker,
            60..63 => Fault::KillMachines(factory),
            63..66 => Fault::KillAll,
            66..72 => Fault::Cut,
            72..74 => Fault::Stall(self.span(3_000)),
            74 => Fault::Outage(OUTAGE),
            75..78 => Fault::HalfOpen(self.span(3_000)),
            78..81 => Fault::Slow(self.span(3_000)),
            81..83 => Fault::LoseBrokerStore,
            83..85 => Fault::OldBrokerStore,
            85..88 => Fault::DoubleQueued,
            88..91 => Fault::ConnectorClock(factory, offset),
            91..93 => Fault::PlatformClock(offset),
            93..95 => Fault::FullDisk(factory, self.span(3_000)),
            95 => Fault::FullDisk(PLATFORM, self.span(3_000)),
            96..98 => Fault::PauseConnector(factory, self.span(4_000)),
            _ => Fault::PausePlatform(self.span(4_000)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_seed_is_a_plan() {
        let (mut one, mut same, mut other) = (Plan::new(7), Plan::new(7), Plan::new(8));
        let rounds: Vec<_> = (0..40).map(|_| one.round()).collect();
        assert_eq!(rounds, (0..40).map(|_| same.round()).collect::<Vec<_>>());
        assert_ne!(rounds, (0..40).map(|_| other.round()).collect::<Vec<_>>());
        let first = rounds[0].iter().map(|strike| strike.fault);
        let is_rare = |fault: &Fault| {
            matches!(
                fault,
                Fault::FullDisk(..) | Fault::ConnectorClock(..) | Fault::PlatformClock(_)
            )
        };
        assert!(first.filter(is_rare).count() >= 2, "the first round has a clock and a disk");
        let mut kinds: Vec<_> = rounds.iter().flatten().map(|strike| strike.fault.kind()).collect();
        kinds.sort_unstable();
        kinds.dedup();
        assert_eq!(kinds.len(), 18, "every kind of fault comes up: {kinds:?}");
    }
}
