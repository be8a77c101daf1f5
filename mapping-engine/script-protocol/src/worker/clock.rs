//! Computing time. A call's budget is counted in it, so that a busy machine makes no script guilty.

use std::time::Duration;

use rustix::time::{ClockId, Timespec, clock_gettime};

/// The computing time of the calling thread so far.
#[must_use]
pub fn thread_time() -> Duration {
    duration(clock_gettime(ClockId::ThreadCPUTime))
}

/// The computing time of the process so far.
#[must_use]
pub fn process_time() -> Duration {
    duration(clock_gettime(ClockId::ProcessCPUTime))
}

fn duration(time: Timespec) -> Duration {
    Duration::new(u64::try_from(time.tv_sec).unwrap_or(0), u32::try_from(time.tv_nsec).unwrap_or(0))
}
