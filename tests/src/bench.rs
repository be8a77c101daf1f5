//! Benchmarks of the whole path: machine, connector, broker, platform, page. Never part of the
//! tests: machines are noisy, so distributions are printed with a description of the machine.

mod browsable;
mod figures;
pub mod goals;
mod ledger;
mod links;
mod mappings;
pub mod part;
pub mod part_runner;
mod reports;
mod subject;
mod throughput;
mod twin;
mod usage;

use anyhow::Context as _;
use clap::ValueEnum as _;
use figures::distribution;
use serde_json::Value;

pub use self::subject::Subject;
use crate::{
    demo::{latency, play},
    harness::{Steps, repository, say},
    world::{Places, World},
};

/// Changes whose latency is measured.
const CHANGES: u32 = 300;
/// Requests whose way into the address space is measured.
const REQUESTS: u32 = 40;

/// Measures these subjects, all where there are none, and writes the results.
///
/// # Errors
/// When the story does not play, something stays away, or a figure misses its goal or was not
/// measured.
pub async fn run(subjects: &[Subject]) -> anyhow::Result<()> {
    let subjects = if subjects.is_empty() { Subject::value_variants() } else { subjects };
    say(&format!("{}\n", machine()));
    let (mut results, mut measured, mut outcome) = (Vec::new(), Vec::new(), Ok(()));
    for subject in subjects {
        match measure(*subject).await {
            Ok(figures) => results.extend(figures),
            Err(error) => {
                outcome = Err(error.context(format!("{subject:?} could not be measured")));
                break;
            }
        }
        measured.push(*subject);
    }
    // What was measured before a failure took minutes, and is written nonetheless.
    let short = write(&mut results, &measured)?;
    outcome?;
    anyhow::ensure!(
        short.is_empty(),
        "{} goals are not met:\n  {}",
        short.len(),
        short.join("\n  ")
    );
    Ok(())
}

async fn measure(subject: Subject) -> anyhow::Result<Vec<Value>> {
    match subject {
        Subject::Reports => reports::measure(),
        Subject::Path => path().await,
        Subject::Twin => twin::measure().await,
        Subject::Mappings => mappings::measure().await,
        Subject::Ledger => ledger::measure().await,
        Subject::Links => links::measure().await,
    }
}

/// Judges the figures of these subjects, writes and prints them. Returns a line for each goal that
/// is not met.
fn write(results: &mut [Value], subjects: &[Subject]) -> anyhow::Result<Vec<String>> {
    let file = repository()?.join("target/bench/results.json");
    std::fs::create_dir_all(file.parent().context("the file lies in a folder")?)?;
    let short = goals::judge(results, subjects);
    std::fs::write(&file, serde_json::to_vec_pretty(results)?)?;
    let summary = goals::summary(results);
    say(&format!("\nFigures with goals:\n  {}", summary.join("\n  ")));
    say(&format!("\nWritten to {}", file.display()));
    Ok(short)
}

async fn path() -> anyhow::Result<Vec<Value>> {
    let folder = tempfile::Builder::new().prefix("verbund-bench-").tempdir()?;
    let mut world = World::start(Places::anywhere(folder.path().to_owned())?)?;
    let mut results = Vec::new();
    let cast = play(&mut world, &mut Steps::default()).await?;
    let latencies = latency::measure(&world, &cast.platform, CHANGES).await?;
    results.extend(distribution(
        "value changed on the machine -> on the buyer's live stream",
        latencies,
    ));
    let latencies = browsable::measure(&world, &cast.platform, REQUESTS).await?;
    results.extend(distribution("request sent -> nodes browsable in the twin", latencies));
    results.extend(throughput::measure(&mut world, &cast).await?);
    world.stop()?;
    Ok(results)
}

/// Processor, cores, load and kernel: what figures depend on.
fn machine() -> String {
    let read = |file: &str| std::fs::read_to_string(file).unwrap_or_default();
    let processor = read("/proc/cpuinfo")
        .lines()
        .find_map(|line| {
            line.strip_prefix("model name")
                .map(|rest| rest.trim_start_matches([' ', '\t', ':']).to_owned())
        })
        .unwrap_or_else(|| "unknown processor".to_owned());
    let cores = std::thread::available_parallelism().map_or(0, std::num::NonZero::get);
    let profile = if cfg!(debug_assertions) { "dev" } else { "release" };
    format!(
        "{processor}, {cores} cores, load {}, Linux {}, {profile} build",
        read("/proc/loadavg").split(' ').next().unwrap_or_default(),
        read("/proc/sys/kernel/osrelease").trim()
    )
}
