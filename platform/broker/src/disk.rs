//! Space on the disk of the database: who holds much leaves the last of it to those who hold little, and removals find
//! room in any case.

use std::{
    fmt,
    path::{Path, PathBuf},
    sync::Arc,
    time::{Duration, Instant},
};

use parking_lot::Mutex;
use serde::{Deserialize, Serialize};
use tracing::{error, info, warn};

/// Part of a disk that is kept for those who hold little.
const RESERVED_PART: u64 = 50;
/// Largest such part.
const RESERVED_MAX: u64 = 1 << 30;
/// Part of that reserve that no message gets: what removes messages has to be written, too.
const LAST_PART: u64 = 4;
/// Bytes on the disk for each byte of a message, which is written to the log first.
const WRITTEN_TIMES: u64 = 2;
/// Time for which a disk is not looked at again.
const LOOKED_EVERY: Duration = Duration::from_secs(1);

const SHORT: &str = "the broker's disk is nearly full, and this queue holds more than its part of it; try again once it \
                     was read, or there is room";
const FULL: &str = "the broker's disk has no room; try again later";

/// Space of a disk, in bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DiskSpace {
    pub free: u64,
    pub size: u64,
}

impl DiskSpace {
    /// Returns true where so little is left that it is for those who hold little.
    #[must_use]
    pub fn is_short(self) -> bool {
        self.free < self.reserve()
    }

    /// Returns true where what is left is for removals.
    fn is_full(self) -> bool {
        self.free < self.reserve() / LAST_PART
    }

    fn reserve(self) -> u64 {
        (self.size / RESERVED_PART).min(RESERVED_MAX)
    }
}

/// Reads the space of the disk that a file lies on; none where that says nothing.
type ReadSpace = dyn Fn(&Path) -> Option<DiskSpace> + Send + Sync;

/// Gauge of a disk. The default one sees nothing, and so keeps nothing free.
#[derive(Clone)]
pub struct DiskGauge(Arc<ReadSpace>);

impl DiskGauge {
    /// Returns a gauge that reads the space of the disk that a file lies on; none where that says nothing.
    pub fn new(read: impl Fn(&Path) -> Option<DiskSpace> + Send + Sync + 'static) -> Self {
        Self(Arc::new(read))
    }

    /// Returns the space of the disk that a file lies on.
    #[must_use]
    pub fn space_of(&self, file: &Path) -> Option<DiskSpace> {
        (self.0)(file)
    }
}

impl Default for DiskGauge {
    fn default() -> Self {
        Self::new(|_| None)
    }
}

impl fmt::Debug for DiskGauge {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("DiskGauge").finish_non_exhaustive()
    }
}

/// Queues for messages, with the bytes that they hold together.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct HeldByAll {
    pub queues: u64,
    pub bytes: u64,
}

/// Room on the disk of the database.
pub(crate) struct DiskRoom {
    gauge: DiskGauge,
    database: PathBuf,
    seen: Mutex<SeenDisk>,
}

/// Disk as it was seen last.
#[derive(Default)]
struct SeenDisk {
    at: Option<Instant>,
    /// Less what was taken since; none where nothing is known.
    space: Option<DiskSpace>,
    /// Numbers of the time since which the disk is short, or of the last look; none while there is enough.
    all: Option<HeldByAll>,
    state: DiskState,
}

/// Room on the disk of the embedded broker.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum DiskState {
    /// All that is sent is taken.
    #[default]
    Enough,
    /// Queues that hold more than their part take no further messages.
    Short,
    /// No messages are taken.
    Full,
}

impl DiskState {
    fn of(space: DiskSpace) -> Self {
        match space {
            full if full.is_full() => Self::Full,
            short if short.is_short() => Self::Short,
            _ => Self::Enough,
        }
    }
}

impl DiskRoom {
    pub(crate) fn new(gauge: DiskGauge, database: PathBuf) -> Self {
        Self { gauge, database, seen: Mutex::default() }
    }

    /// Takes room for a message of a queue that holds `held` bytes by now.
    ///
    /// # Errors
    /// The reason for which there is none at the moment.
    pub(crate) fn take(
        &self,
        bytes: u64,
        held: u64,
        all: impl Fn() -> HeldByAll,
    ) -> Result<(), &'static str> {
        let mut seen = self.seen.lock();
        self.look_into(&mut seen, &all);
        let Some(space) = seen.space else { return Ok(()) };
        match DiskState::of(space) {
            DiskState::Full => return Err(FULL),
            // It may have become short by what was taken since the look.
            DiskState::Short => {
                let all = *seen.all.get_or_insert_with(all);
                if is_beyond_its_part(held, all, space.free) {
                    return Err(SHORT);
                }
            }
            DiskState::Enough => {}
        }
        let free = space.free.saturating_sub(bytes.saturating_mul(WRITTEN_TIMES));
        seen.space = Some(DiskSpace { free, ..space });
        Ok(())
    }

    /// Looks at the disk, if that was not done a moment ago, and says what has changed.
    pub(crate) fn look(&self, all: impl FnOnce() -> HeldByAll) -> DiskState {
        let mut seen = self.seen.lock();
        self.look_into(&mut seen, all);
        seen.state
    }

    fn look_into(&self, seen: &mut SeenDisk, all: impl FnOnce() -> HeldByAll) {
        if seen.at.is_some_and(|at| at.elapsed() < LOOKED_EVERY) {
            return;
        }
        seen.at = Some(Instant::now());
        seen.space = self.gauge.space_of(&self.database);
        let state = seen.space.map_or(DiskState::Enough, DiskState::of);
        seen.all = (state != DiskState::Enough).then(all);
        metrics::gauge!("broker_disk_is_short")
            .set(f64::from(u8::from(state != DiskState::Enough)));
        if std::mem::replace(&mut seen.state, state) == state {
            return;
        }
        let free = seen.space.map(|space| space.free);
        match state {
            DiskState::Full => error!(
                free,
                "the broker's disk has no room: no messages are taken until it has, and those that are there are delivered"
            ),
            DiskState::Short => warn!(
                free,
                "the broker's disk is nearly full: queues that hold more than their part of it take no further messages"
            ),
            DiskState::Enough => info!(free, "the broker's disk has room again"),
        }
    }
}

/// Returns true for a queue that holds more than an equal part of what all hold and of what is left.
fn is_beyond_its_part(held: u64, all: HeldByAll, free: u64) -> bool {
    u128::from(held) * u128::from(all.queues) > u128::from(all.bytes) + u128::from(free)
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicU64, Ordering};

    use super::*;

    const SIZE: u64 = 100_000;

    fn room(free: u64) -> DiskRoom {
        let gauge = DiskGauge::new(move |_| Some(DiskSpace { free, size: SIZE }));
        DiskRoom::new(gauge, PathBuf::from("broker.db"))
    }

    #[test]
    fn a_reserve_is_a_part_of_a_disk_and_bounded() {
        let space = |free, size| DiskSpace { free, size };
        assert!(space(1_999, SIZE).is_short() && !space(2_000, SIZE).is_short());
        assert!(space(499, SIZE).is_full() && !space(500, SIZE).is_full());
        let large = u64::MAX / 2;
        assert!(
            space(RESERVED_MAX - 1, large).is_short() && !space(RESERVED_MAX, large).is_short()
        );
    }

    #[test]
    fn who_holds_more_than_a_part_waits_while_the_disk_is_short() {
        let all = || HeldByAll { queues: 3, bytes: 2_000 };
        // A part is a third of 3 000.
        assert_eq!(room(1_000).take(1, 1_001, all), Err(SHORT));
        assert_eq!(room(1_000).take(1, 1_000, all), Ok(()));
        assert_eq!(room(2_000).take(1, 2_000, all), Ok(()), "the disk is not short");
        let alone = || HeldByAll { queues: 1, bytes: 2_000 };
        assert_eq!(room(1_000).take(1, 2_000, alone), Ok(()), "there are no others");
    }

    #[test]
    fn a_disk_that_becomes_short_between_two_looks_is_shared_as_it_is_then() {
        let free = Arc::new(AtomicU64::new(1_000));
        let gauge = DiskGauge::new({
            let free = Arc::clone(&free);
            move |_| Some(DiskSpace { free: free.load(Ordering::Relaxed), size: SIZE })
        });
        let room = DiskRoom::new(gauge, PathBuf::from("broker.db"));
        let is_over = || room.seen.lock().at = None;
        let earlier = || HeldByAll { queues: 10, bytes: 0 };
        assert_eq!(room.take(1, 500, earlier), Err(SHORT), "a part is a tenth of 1 000");
        free.store(2_000, Ordering::Relaxed);
        is_over();
        let now = || HeldByAll { queues: 2, bytes: 5_000 };
        assert_eq!(room.take(100, 500, now), Ok(()), "there is enough");
        // What was taken made it short: a part is half of 6 800.
        assert_eq!(room.take(1, 500, now), Ok(()), "the former shortage is over");
        assert_eq!(room.take(1, 4_000, now), Err(SHORT));
    }

    #[test]
    fn the_last_room_is_for_removals() {
        let all = || HeldByAll { queues: 3, bytes: 0 };
        assert_eq!(room(499).take(1, 0, all), Err(FULL));
        // What is taken counts before the disk is looked at again: 700 - 2 * 101.
        let room = room(700);
        assert_eq!(room.take(101, 0, all), Ok(()));
        assert_eq!(room.take(1, 0, all), Err(FULL));
    }

    #[test]
    fn a_disk_that_says_nothing_has_room() {
        let room = DiskRoom::new(DiskGauge::default(), PathBuf::from("broker.db"));
        assert_eq!(room.take(u64::MAX, u64::MAX, HeldByAll::default), Ok(()));
    }
}
