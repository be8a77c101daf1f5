//! Judgement of a siege: times of honest requests, and memory of each process.

use std::time::Duration;

use crate::{
    harness::{Deadline, say},
    probes::{
        process::{Memory, mib},
        scene::{MEMORY_MAX, Scene},
    },
};

/// Usual time of an honest request, at least: below it a delay of the scheduler would be many times as long.
const USUAL_MIN: Duration = Duration::from_millis(2);
/// Factor by which an honest request may take longer under siege: one in the middle of all of its kind, and all but
/// one in twenty.
const FACTOR_MAX: f64 = 10.0;
/// Time that each single honest request has, however unlucky, where ten times the slowest usual one are not more: a
/// person waits that long without a thought of trying again, and one stall of the machine is no denial of service.
const SLOWEST_MAX: Duration = Duration::from_secs(2);
/// Honest requests of a kind, at least.
const REQUESTS_MIN: usize = 30;
/// Memory that a process may keep of a siege, beside what it had: blocks in which passwords are hashed are kept for the
/// next ones, 19 MiB each, and an allocator keeps a part of what was in use.
const KEPT_MAX: u64 = 96 << 20;
/// Time after which memory has to be back.
const RELIEF: Duration = Duration::from_secs(90);

/// Durations of one kind of honest requests.
#[derive(Debug, Default, Clone)]
pub(super) struct Times(Vec<Duration>);

impl Times {
    /// Adds that of one request.
    pub fn add(&mut self, took: Duration) {
        self.0.push(took);
    }

    /// Returns the duration that this part of all do not exceed.
    fn part(&self, part: f64) -> Duration {
        let mut sorted = self.0.clone();
        sorted.sort_unstable();
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            clippy::cast_precision_loss
        )]
        let place = (sorted.len() as f64 * part) as usize;
        sorted.get(place.min(sorted.len().saturating_sub(1))).copied().unwrap_or_default()
    }

    fn slowest(&self) -> Duration {
        self.0.iter().max().copied().unwrap_or_default()
    }
}

/// Prints how long honest requests took, and returns those that took too long.
pub(super) fn of_times(kinds: &[&str], usual: &[Times], under: &[Times]) -> Vec<String> {
    say(&format!("  (A usual time below {USUAL_MIN:?} counts as {USUAL_MIN:?}.)"));
    let mut faults = Vec::new();
    for (kind, (usual, under)) in kinds.iter().zip(usual.iter().zip(under)) {
        faults.extend(of_kind(kind, usual, under));
    }
    faults
}

fn of_kind(kind: &str, usual: &Times, under: &Times) -> Vec<String> {
    let count = under.0.len();
    let ratio =
        |part| under.part(part).as_secs_f64() / usual.part(part).max(USUAL_MIN).as_secs_f64();
    let (median, most) = (ratio(0.5), ratio(0.95));
    let (slowest, allowed) = (under.slowest(), slowest_allowed(usual));
    say(&format!(
        "  {kind}: usually {:?} (95 % {:?}, slowest {:?}), under siege {:?} (95 % {:?}, slowest {slowest:?}): \
         {median:.1} and {most:.1} times, of {count}",
        usual.part(0.5),
        usual.part(0.95),
        usual.slowest(),
        under.part(0.5),
        under.part(0.95),
    ));
    let mut faults = Vec::new();
    if count < REQUESTS_MIN {
        faults.push(format!("{kind}: {count} of {REQUESTS_MIN} requests at least"));
    }
    if median > FACTOR_MAX || most > FACTOR_MAX {
        faults.push(format!("{kind} took {median:.1} and {most:.1} times as long, of {count}"));
    }
    if slowest > allowed {
        faults.push(format!("{kind} took {slowest:?} once, of {allowed:?} at most"));
    }
    faults
}

/// Returns the time that each single request of a kind has.
fn slowest_allowed(usual: &Times) -> Duration {
    usual.slowest().mul_f64(FACTOR_MAX).max(SLOWEST_MAX)
}

/// A process under siege.
pub(super) struct Watched {
    name: String,
    memory: Memory,
    before: u64,
    /// Time of processors that it had used before.
    used: Duration,
}

/// Returns all processes of a world: the programs, and those that they have started.
pub(super) fn watched(scene: &mut Scene) -> anyhow::Result<Vec<Watched>> {
    let mut all = Vec::new();
    for daemon in scene.world.daemons() {
        let memory = Memory::of(daemon.pid());
        all.push((daemon.name().to_owned(), memory));
        for child in memory.children()? {
            all.push((format!("{} of {}", child.program()?, daemon.name()), child));
        }
    }
    let watch = |(name, memory): (String, Memory)| {
        memory.reset_peak()?;
        let (before, used) = (memory.resident()?, memory.processor_time()?);
        Ok(Watched { name, memory, before, used })
    };
    all.into_iter().map(watch).collect()
}

/// Prints what each process needed, waits until it gave that back, and returns those that did not, took too much or
/// ended.
pub(super) async fn of_memory(watched: &[Watched]) -> Vec<String> {
    let deadline = Deadline::after(RELIEF);
    let mut faults = Vec::new();
    for Watched { name, memory, before, used } in watched {
        // A supervisor starts a broker or a worker again that has crashed: as another process.
        let Ok(peak) = memory.peak() else {
            faults.push(format!("{name} ended"));
            continue;
        };
        let used = memory.processor_time().unwrap_or_default().saturating_sub(*used);
        let allowed = before + KEPT_MAX;
        let mut after = memory.resident().unwrap_or_default();
        while after > allowed && !deadline.has_passed() {
            tokio::time::sleep(Duration::from_secs(1)).await;
            after = memory.resident().unwrap_or_default();
        }
        say(&format!(
            "  {name}: {} MiB before, {} MiB at most, {} MiB after the siege, {used:.0?} of processors",
            mib(*before),
            mib(peak),
            mib(after)
        ));
        if peak > MEMORY_MAX {
            faults.push(format!("{name} took {} MiB", mib(peak)));
        }
        if after > allowed {
            faults.push(format!("{name} keeps {} MiB more", mib(after - before)));
        }
    }
    faults
}

#[cfg(test)]
mod tests {
    use super::*;

    fn times(millis: impl IntoIterator<Item = u64>) -> Times {
        Times(millis.into_iter().map(Duration::from_millis).collect())
    }

    #[test]
    fn one_stall_among_many_honest_requests_is_found() {
        let usual = times([10; 40]);
        assert_eq!(of_kind("a page", &usual, &times([90; 300])), [] as [&str; 0]);
        let stalled = times([10; 299].into_iter().chain([2_001]));
        let faults = of_kind("a page", &usual, &stalled);
        assert_eq!(faults, ["a page took 2.001s once, of 2s at most"]);
    }

    #[test]
    fn requests_of_which_one_in_ten_is_slow_are_found() {
        let usual = times([10; 40]);
        let slow = times((0..300).map(|number| if number % 10 == 0 { 150 } else { 10 }));
        let faults = of_kind("a page", &usual, &slow);
        assert_eq!(faults, ["a page took 1.0 and 15.0 times as long, of 300"]);
    }

    #[test]
    fn a_kind_that_was_hardly_asked_proves_nothing() {
        let faults = of_kind("a page", &times([10; 40]), &times([10; 29]));
        assert_eq!(faults, ["a page: 29 of 30 requests at least"]);
    }

    #[test]
    fn what_usually_takes_seconds_has_ten_times_as_long() {
        let usual = times([300; 40]);
        assert_eq!(slowest_allowed(&usual), Duration::from_secs(3));
        assert_eq!(slowest_allowed(&times([1; 40])), SLOWEST_MAX);
    }
}
