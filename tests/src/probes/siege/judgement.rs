//! Judgement of a siege: its strength, times of honest requests, memory of each process, and what their logs say.

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
const SLOWEST_MAX: Duration = Duration::from_secs(1);
/// Honest requests of a kind, at least.
const REQUESTS_MIN: usize = 30;
/// Memory that any process may keep of a siege, beside what it had: an allocator keeps a part of what was in use, and the
/// throttles know ten thousand names and addresses for a while.
const KEPT_MAX: u64 = 32 << 20;
/// Memory that a program with pages may keep beside that: blocks of 19 MiB in which passwords are hashed are kept for the
/// next hashes. Two are computed at once, and the threads that did before may each keep one in their part of the
/// allocator: up to 83 MiB in all were seen, after ten thousand guesses as after two thousand.
const KEPT_FOR_HASHES: u64 = 3 * (19 << 20);
/// Part of the time of a siege for which attackers have to have a processor: one sixth, which is less than half of what
/// they get on a machine of two that they share with all that they attack. With less of it they have hardly attacked.
const ATTACKERS_PART: u32 = 6;
/// Words of a panic in a log.
const PANICKED: &str = "panicked at";
/// Time after which memory has to be back.
const RELIEF: Duration = Duration::from_secs(90);

/// Prints the time of processors that attackers had, and returns that it was too little.
pub(super) fn of_attackers(used: Duration, span: Duration) -> Option<String> {
    say(&format!("  processors: {used:.0?} for the attackers, of {span:.0?} on each"));
    let at_least = span / ATTACKERS_PART;
    (used < at_least)
        .then(|| format!("the attackers had processors for {used:.0?}, of {at_least:.0?} at least"))
}

/// Returns the panics of which the logs of all programs say: of a task, which another one replaces, no other trace is left.
pub(super) fn of_logs(scene: &mut Scene) -> Vec<String> {
    let mut faults = Vec::new();
    for daemon in scene.world.daemons() {
        faults.extend(panics(daemon.name(), &daemon.log_tail(usize::MAX)));
    }
    faults
}

fn panics(name: &str, log: &str) -> Vec<String> {
    let lines = log.lines().filter(|line| line.contains(PANICKED));
    lines.map(|line| format!("the log of {name} says that it panicked: {line}")).collect()
}

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
    /// Memory that it may have afterwards.
    allowed: u64,
    /// Time of processors that it had used before.
    used: Duration,
}

/// Returns all processes of a world: the programs, and those that they have started.
pub(super) fn watched(scene: &mut Scene) -> anyhow::Result<Vec<Watched>> {
    let mut all = Vec::new();
    for daemon in scene.world.daemons() {
        let memory = Memory::of(daemon.pid());
        all.push((daemon.name().to_owned(), memory, kept_max(daemon.name())));
        for child in memory.children()? {
            all.push((format!("{} of {}", child.program()?, daemon.name()), child, KEPT_MAX));
        }
    }
    let watch = |(name, memory, kept_max): (String, Memory, u64)| {
        memory.reset_peak()?;
        let (before, used) = (memory.resident()?, memory.processor_time()?);
        Ok(Watched { name, memory, before, allowed: before + kept_max, used })
    };
    all.into_iter().map(watch).collect()
}

/// Returns the memory that a program may keep. Its broker and its workers, processes of their own, hash no passwords.
fn kept_max(name: &str) -> u64 {
    let has_pages = name == "platform" || name.starts_with("connector-");
    KEPT_MAX + if has_pages { KEPT_FOR_HASHES } else { 0 }
}

/// Prints what each process needed, waits until it gave that back, and returns those that did not, took too much or
/// ended.
pub(super) async fn of_memory(watched: &[Watched]) -> Vec<String> {
    let deadline = Deadline::after(RELIEF);
    let mut faults = Vec::new();
    for Watched { name, memory, before, allowed, used } in watched {
        // A supervisor starts a broker or a worker again that has crashed: as another process.
        let Ok(peak) = memory.peak() else {
            faults.push(format!("{name} ended"));
            continue;
        };
        let used = memory.processor_time().unwrap_or_default().saturating_sub(*used);
        let mut after = memory.resident().unwrap_or_default();
        while after > *allowed && !deadline.has_passed() {
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
        if after > *allowed {
            let more = mib(after.saturating_sub(*before));
            faults.push(format!(
                "{name} keeps {more} MiB more, of {} at most",
                mib(allowed - before)
            ));
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
        let stalled = times([10; 299].into_iter().chain([1_001]));
        let faults = of_kind("a page", &usual, &stalled);
        assert_eq!(faults, ["a page took 1.001s once, of 1s at most"]);
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
    fn attackers_that_hardly_had_a_processor_prove_nothing() {
        let span = Duration::from_secs(96);
        assert_eq!(of_attackers(Duration::from_secs(37), span), None);
        assert_eq!(
            of_attackers(Duration::from_secs(15), span).as_deref(),
            Some("the attackers had processors for 15s, of 16s at least")
        );
    }

    #[test]
    fn programs_that_hash_passwords_keep_memory_for_the_next_hashes() {
        assert_eq!(mib(kept_max("platform")), 89);
        assert_eq!(mib(kept_max("connector-FOR_MUC")), 89);
        assert_eq!(mib(kept_max("simulator-FOR_MUC")), 32);
    }

    #[test]
    fn a_panic_of_which_a_log_says_is_found() {
        let log = "{\"level\":\"INFO\"}\nthread 'a' (7) panicked at src/a.rs:1:2:\nno\n";
        assert_eq!(panics("platform", log).len(), 1);
        assert_eq!(panics("platform", "all is well\n"), [] as [&str; 0]);
    }

    #[test]
    fn what_usually_takes_seconds_has_ten_times_as_long() {
        let usual = times([300; 40]);
        assert_eq!(slowest_allowed(&usual), Duration::from_secs(3));
        assert_eq!(slowest_allowed(&times([1; 40])), SLOWEST_MAX);
    }
}
