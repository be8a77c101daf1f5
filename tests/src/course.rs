//! Course of the demo's order: the plan of each round, and what the machines make of it.

use std::path::Path;

use anyhow::Context as _;
use time::{Duration, OffsetDateTime};

/// Time between the start of the machines and that of the first order, in which everything else starts.
const LEAD: Duration = Duration::seconds(20);
/// Name of the orders; each has a number behind it.
const NAME: &str = "4711";
/// File with the number of the newest order.
const FILE: &str = "order-number";

/// One operation, in seconds from the begin of a round.
#[derive(Debug, Clone, Copy)]
pub struct Timing {
    /// Start and end as the buyer plans them.
    pub planned: (u32, u32),
    /// Start at the machine.
    pub start: u32,
    /// Seconds per part at the machine.
    pub cycle: u32,
    pub quantity: u32,
}

impl Timing {
    /// Returns the seconds of work.
    const fn work(self) -> u32 {
        self.cycle * self.quantity
    }
}

/// A round: one order from its first frame to its last, in seconds from its begin.
#[derive(Debug)]
pub struct Pace {
    pub make: Timing,
    pub ship: Timing,
    pub inspect: Timing,
    pub assemble: Timing,
    /// Failure of the milling cell, and its length.
    pub failure: (u32, u32),
    /// Kill of Munich's connector, and the time for which it, or any other program that ends, stays away.
    pub kill: (u32, u32),
    /// Longest and least time that the plan leaves between two operations.
    pub gaps: (u32, u32),
    /// Time from round to round.
    pub every: u32,
}

/// The demo for people.
pub const UNHURRIED: Pace = Pace {
    make: Timing { planned: (0, 300), start: 0, cycle: 40, quantity: 12 },
    ship: Timing { planned: (320, 430), start: 540, cycle: 8, quantity: 12 },
    inspect: Timing { planned: (450, 640), start: 650, cycle: 15, quantity: 12 },
    assemble: Timing { planned: (700, 830), start: 890, cycle: 120, quantity: 1 },
    failure: (60, 45),
    kill: (125, 15),
    gaps: (480, 60),
    every: 1200,
};

/// The same within minutes, for tests: late by more than the minute that the pages begin to count at.
pub const HURRIED: Pace = Pace {
    make: Timing { planned: (0, 24), start: 0, cycle: 8, quantity: 12 },
    ship: Timing { planned: (26, 38), start: 118, cycle: 1, quantity: 12 },
    inspect: Timing { planned: (40, 64), start: 132, cycle: 2, quantity: 12 },
    assemble: Timing { planned: (68, 78), start: 160, cycle: 8, quantity: 1 },
    failure: (25, 20),
    kill: (60, 5),
    gaps: (60, 3),
    every: 180,
};

impl Pace {
    /// Returns the time from the begin of a round to the end of the milling cell's order.
    #[must_use]
    pub const fn made_after(&self) -> u32 {
        self.make.start + self.make.work() + self.failure.1
    }

    /// Returns the time by which the frames are late.
    #[must_use]
    pub const fn late(&self) -> u32 {
        self.made_after() - self.make.planned.1
    }

    /// Returns start and end of an operation at its machine.
    #[must_use]
    pub const fn actual(&self, timing: Timing) -> (u32, u32) {
        (timing.start, timing.start + timing.work())
    }
}

/// The rounds of one start of the demo.
#[derive(Debug, Clone, Copy)]
pub struct Course {
    pub pace: &'static Pace,
    /// Zero of the machines' time.
    epoch: OffsetDateTime,
    /// Number of the first round's order.
    first_number: u64,
}

impl Course {
    /// Returns the course that begins now, with the number after the newest order of this folder.
    ///
    /// # Errors
    /// When the number can be neither read nor written.
    pub fn begin(pace: &'static Pace, folder: &Path, now: OffsetDateTime) -> anyhow::Result<Self> {
        let file = folder.join(FILE);
        let newest: u64 = match std::fs::read_to_string(&file) {
            Ok(text) => {
                text.trim().parse().with_context(|| format!("reading {}", file.display()))?
            }
            Err(_) => 0,
        };
        let course = Self { pace, epoch: now.replace_nanosecond(0)?, first_number: newest + 1 };
        course.note(folder, 0)?;
        Ok(course)
    }

    /// Notes that a round has begun, so that no later start counts its order again.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn note(&self, folder: &Path, round: u32) -> anyhow::Result<()> {
        let number = self.first_number + u64::from(round);
        let file = folder.join(FILE);
        std::fs::write(&file, number.to_string())
            .with_context(|| format!("writing {}", file.display()))
    }

    /// Returns the id of a round's order, as the machines show it.
    #[must_use]
    pub fn order_id(&self, round: u32) -> String {
        format!("{NAME}-{}", self.first_number + u64::from(round))
    }

    /// Returns the begin of a round, from 0.
    #[must_use]
    pub fn begin_of(&self, round: u32) -> OffsetDateTime {
        self.epoch + LEAD + Duration::seconds(i64::from(self.pace.every)) * round
    }

    /// Returns the number of the round that runs, and the seconds since its begin: negative before the first.
    #[must_use]
    pub fn now(&self, now: OffsetDateTime) -> (u32, i64) {
        let since = (now - self.begin_of(0)).whole_seconds();
        let every = i64::from(self.pace.every);
        let round = u32::try_from(since.div_euclid(every)).unwrap_or(0);
        (round, since - i64::from(round) * every)
    }

    /// Returns the zero of the machines' time.
    #[must_use]
    pub const fn epoch(&self) -> OffsetDateTime {
        self.epoch
    }

    /// Returns the lines of a machine's configuration that give it its orders; with the failure for the milling cell.
    #[must_use]
    pub fn configuration(&self, timing: Timing, fails: bool) -> String {
        let (after, lasts) = self.pace.failure;
        let failure = if fails {
            format!(", failure = {{ after_seconds = {after}, lasts_seconds = {lasts} }}")
        } else {
            String::new()
        };
        format!(
            "cycle_seconds = {}\norders = {{ name = \"{NAME}\", first_number = {}, quantity = {}, \
             begins_after_seconds = {}, every_seconds = {}{failure} }}",
            timing.cycle,
            self.first_number,
            timing.quantity,
            LEAD.whole_seconds() + i64::from(timing.start),
            self.pace.every,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_order_is_done_before_the_next_and_each_operation_follows_the_one_before() {
        for pace in [&UNHURRIED, &HURRIED] {
            let Pace { make, ship, inspect, assemble, failure, kill, gaps, every } = *pace;
            assert!(pace.made_after() <= ship.start);
            assert!(pace.actual(ship).1 <= inspect.start);
            assert!(pace.actual(inspect).1 + gaps.1 <= assemble.start);
            assert!(inspect.start - pace.actual(ship).1 <= gaps.0);
            assert!(pace.actual(assemble).1 < every);
            assert!(make.planned.1 <= ship.planned.0 && ship.planned.1 <= inspect.planned.0);
            assert!(inspect.planned.1 + gaps.1 <= assemble.planned.0);
            assert!(pace.late() >= 60, "pages count lateness from a minute on");
            assert!(failure.0 + failure.1 < kill.0, "one thing at a time");
            assert!(kill.0 + kill.1 < 180, "a newcomer sees all of it within three minutes");
        }
    }

    #[test]
    fn rounds_follow_each_other_and_numbers_go_on_at_the_next_start() {
        let folder = tempfile::tempdir().expect("a folder");
        let now = OffsetDateTime::UNIX_EPOCH;
        let first = Course::begin(&HURRIED, folder.path(), now).expect("a course");
        assert_eq!(first.now(now), (0, -20));
        let in_third = now + LEAD + Duration::seconds(365);
        assert_eq!(first.now(in_third), (2, 5));
        assert_eq!(first.order_id(2), "4711-3");
        first.note(folder.path(), 2).expect("noted");
        let second = Course::begin(&HURRIED, folder.path(), in_third).expect("a course");
        assert_eq!(second.order_id(0), "4711-4");
    }
}
