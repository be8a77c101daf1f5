//! Plan of faults and their times: drawn from a seed alone, so that a run can be played again.

use std::{collections::VecDeque, fmt, time::Duration};

use rand::{Rng as _, SeedableRng as _, seq::IndexedRandom as _};
use rand_chacha::ChaCha8Rng;

use crate::{
    frame_order::{HAMBURG, MUNICH},
    world::BrokerKind,
};

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
    /// `kill -9` of a broker of another make, which comes back with what was on its disk.
    CrashBroker,
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
/// Milliseconds that a disk is full at most, where its program notices at once.
const FULL_MS: u64 = 3_000;
/// Seconds that clocks are off.
const OFFSETS: [i32; 6] = [-5_400, -300, -2, 2, 300, 10_800];
/// Offsets that end sessions, leases and times to live, or bring times that have been.
const FAR_OFFSETS: [i32; 4] = [-5_400, -300, 300, 10_800];
/// Offset of the one connector's clock that every run sets back.
const SET_BACK: ClockOffset = ClockOffset(-300);

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
            | Self::RestartBroker
            | Self::CrashBroker => 1,
            Self::KillAll => 5,
            _ => 0,
        }
    }

    /// True where the platform's link to the broker ends, which gives back what is on its way.
    #[must_use]
    pub fn ends_the_platforms_link(self) -> bool {
        matches!(
            self,
            Self::KillPlatform
                | Self::KillAll
                | Self::RestartBroker
                | Self::CrashBroker
                | Self::FullDisk(PLATFORM, _)
        )
    }

    /// True where a broker of another make ends, which takes seconds to come back.
    #[must_use]
    pub const fn ends_the_broker(self) -> bool {
        matches!(self, Self::RestartBroker | Self::CrashBroker)
    }

    /// Returns the fault beside a broker of another make: its store is not ours to change.
    const fn beside_external_broker(self) -> Self {
        match self {
            Self::KillBroker | Self::LoseBrokerStore => Self::CrashBroker,
            Self::OldBrokerStore | Self::DoubleQueued => Self::RestartBroker,
            other => other,
        }
    }

    /// Returns the name for the summary.
    #[must_use]
    pub fn kind(self) -> &'static str {
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
            Self::CrashBroker => "crash broker",
            Self::ConnectorClock(..) => "connector clock",
            Self::PlatformClock(_) => "platform clock",
            Self::FullDisk(PLATFORM, _) => "full disk of the platform",
            Self::FullDisk(..) => "full disk of a factory",
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
            Self::FullDisk(PLATFORM, span) => write!(f, "{kind} {} ms", span.as_millis()),
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
    has_external_broker: bool,
    /// Faults that the next rounds have whatever is drawn.
    always: VecDeque<Vec<Fault>>,
}

impl Plan {
    /// Makes the plan of a seed.
    #[must_use]
    pub fn new(seed: u64, broker: BrokerKind) -> Self {
        let random = ChaCha8Rng::seed_from_u64(seed);
        let has_external_broker = broker != BrokerKind::Embedded;
        let mut plan = Self { random, has_external_broker, always: VecDeque::new() };
        plan.always = plan.rare_faults().into();
        plan
    }

    /// Returns faults of the first rounds that are drawn so seldom that a short run would have none of them: clocks
    /// that are set, full disks, an outage that a spool is too small for, and whatever a broker goes through.
    fn rare_faults(&mut self) -> [Vec<Fault>; 2] {
        let offset = ClockOffset(*FAR_OFFSETS.choose(&mut self.random).unwrap_or(&FAR_OFFSETS[0]));
        let first = vec![
            Fault::ConnectorClock(self.factory(), SET_BACK),
            Fault::Outage(OUTAGE),
            Fault::FullDisk(PLATFORM, self.span(FULL_MS)),
            Fault::Cut,
        ];
        let mut second =
            vec![Fault::PlatformClock(offset), Fault::FullDisk(self.factory(), self.span(FULL_MS))];
        second.extend(match self.has_external_broker {
            true => vec![Fault::RestartBroker, Fault::CrashBroker],
            false => vec![Fault::KillBroker, Fault::LoseBrokerStore],
        });
        [first, second]
    }

    /// Lets faults strike in the next round that could not be caused in this one.
    pub fn owe(&mut self, faults: impl IntoIterator<Item = Fault>) {
        if self.always.is_empty() {
            self.always.push_back(Vec::new());
        }
        if let Some(next) = self.always.front_mut() {
            next.extend(faults);
        }
    }

    /// Returns the faults of the next round; after each round everything must work again.
    pub fn round(&mut self) -> Vec<Strike> {
        let count = self.random.random_range(6..=14);
        let mut strikes = Vec::new();
        for _ in 0..count {
            let fault = self.fault();
            strikes.push(self.strike(fault));
        }
        for fault in self.always.pop_front().unwrap_or_default() {
            let place = self.random.random_range(0..=strikes.len());
            let strike = self.strike(fault);
            strikes.insert(place, strike);
        }
        strikes
    }

    fn strike(&mut self, fault: Fault) -> Strike {
        let fault = if self.has_external_broker { fault.beside_external_broker() } else { fault };
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
            93..95 => Fault::FullDisk(factory, self.span(FULL_MS)),
            95 => Fault::FullDisk(PLATFORM, self.span(FULL_MS)),
            96..98 => Fault::PauseConnector(factory, self.span(4_000)),
            _ => Fault::PausePlatform(self.span(4_000)),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    fn kinds(rounds: &[Vec<Strike>]) -> BTreeSet<&'static str> {
        rounds.iter().flatten().map(|strike| strike.fault.kind()).collect()
    }

    #[test]
    fn a_seed_is_a_plan() {
        let plan = |seed| Plan::new(seed, BrokerKind::Embedded);
        let (mut one, mut same, mut other) = (plan(7), plan(7), plan(8));
        let rounds: Vec<_> = (0..40).map(|_| one.round()).collect();
        assert_eq!(rounds, (0..40).map(|_| same.round()).collect::<Vec<_>>());
        assert_ne!(rounds, (0..40).map(|_| other.round()).collect::<Vec<_>>());
        assert_eq!(kinds(&rounds).len(), 19, "every kind of fault comes up: {:?}", kinds(&rounds));
    }

    #[test]
    fn two_rounds_have_what_is_rare() {
        for seed in 0..50 {
            for broker in [BrokerKind::Embedded, BrokerKind::RabbitMq, BrokerKind::Mosquitto] {
                let mut plan = Plan::new(seed, broker);
                let rounds = [plan.round(), plan.round()];
                let of_broker: &[_] = match broker {
                    BrokerKind::Embedded => &["kill broker", "broker store lost"],
                    _ => &["restart broker", "crash broker"],
                };
                let wanted = ["connector clock", "platform clock", "outage", "cut"]
                    .into_iter()
                    .chain(["full disk of the platform", "full disk of a factory"]);
                let kinds = kinds(&rounds);
                for kind in wanted.chain(of_broker.iter().copied()) {
                    assert!(kinds.contains(kind), "seed {seed} {broker:?}: no {kind} in {kinds:?}");
                }
                let has_store = kinds.contains("broker store lost");
                assert_eq!(has_store, broker == BrokerKind::Embedded, "seed {seed}");
                let mut faults = rounds.iter().flatten().map(|strike| strike.fault);
                assert!(faults.any(|fault| matches!(fault, Fault::ConnectorClock(_, SET_BACK))));
            }
        }
    }

    #[test]
    fn what_could_not_be_caused_comes_again() {
        let mut plan = Plan::new(7, BrokerKind::Embedded);
        for _ in 0..2 {
            plan.round();
        }
        plan.owe([Fault::KillAll, Fault::Outage(OUTAGE)]);
        let round = plan.round();
        let has = |fault: Fault| round.iter().any(|strike| strike.fault == fault);
        assert!(has(Fault::KillAll) && has(Fault::Outage(OUTAGE)));
    }
}
