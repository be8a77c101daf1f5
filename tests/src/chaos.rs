//! Everything that can go wrong between factory and cloud, in an order drawn from a seed, while
//! values flow: programs killed, lines cut and stalled, stores lost, clocks set, disks full. In the
//! end the stores of both sides are compared: every report that left is held once, in its order
//! within each lane, with the fields, values, statuses and times it left with, and the ledger knows of it;
//! every comment that one side took is on both sides once, and both have the same decisions, revocations and revisions,
//! as they were last taken.
//! No program ends by itself or panics, and all end well when they are asked to.
//! What was given up is announced, and nothing else is; what the machines counted is in reports. After each round every
//! writer has to send again.

mod broker_ends;
mod clock;
mod comments;
mod content;
mod control;
mod copied;
mod counted;
mod disk;
mod disturbances;
mod findings;
mod flow;
mod interruptions;
mod kinds;
mod line;
mod observed;
mod plan;
mod rolled_back;
mod set_back;
mod stage;
mod stores;

use std::time::{Duration, Instant};

use comments::CommentTraffic;
use control::{ControlTraffic, Taken};
pub use copied::copied;
pub use findings::Breach;
use findings::{Findings, breach};
use flow::{RECOVERY, flows};
pub use plan::{Fault, Plan, Strike};
pub use rolled_back::rolled_back;
use serde_json::Value;
use stage::Stage;
use stores::Comment;

use crate::{
    frame_order::{HAMBURG, MUNICH},
    harness::{Api, Daemon, DaemonCommand, Deadline, Steps, binary, eventually, say},
    scenario::{Cast, load, story},
    world::BrokerKind,
};

/// Length of a run.
#[derive(Debug, Clone, Copy)]
pub struct Length {
    /// No new round after so long.
    pub span: Duration,
    /// No new round after so many kills.
    pub kills: u32,
    /// A run with fewer kills proves less than was asked for, and fails.
    pub at_least_kills: u32,
    /// A run with fewer faults fails likewise.
    pub at_least_faults: u32,
    /// Rounds that are played whatever is over before. The first two have what every run has to have.
    pub rounds_at_least: u32,
    /// Full disks are left out where this user may not mount, instead of failing the run.
    pub may_lack_disks: bool,
    /// Clocks that jump are left out where libfaketime is missing, instead of failing the run.
    pub may_lack_clocks: bool,
}

/// Rounds that are added at most so that each fault strikes that every run has to have.
const ROUNDS_MORE: u32 = 3;
/// Time without anything waiting that counts as the end.
const QUIET: Duration = Duration::from_secs(5);

/// Plays the rounds of a seed and judges.
///
/// # Errors
/// The promise that does not hold.
pub async fn run(seed: u64, length: Length, broker: BrokerKind, keep: bool) -> anyhow::Result<()> {
    let folder = tempfile::Builder::new().prefix("verbund-chaos-").tempdir()?;
    say(&format!("Chaos with seed {seed}, in {}", folder.path().display()));
    let mut steps = Steps::default();
    let (mut stage, cast) = Stage::set(folder.path().to_owned(), broker, &mut steps).await?;
    let lacking = [
        (stage.lacking_disks(), length.may_lack_disks, "--may-lack-disks"),
        (stage.lacking_clocks(), length.may_lack_clocks, "--may-lack-clocks"),
    ];
    for (lacking, may_lack, option) in lacking {
        let Some(lacking) = lacking else { continue };
        anyhow::ensure!(may_lack, "{lacking}; or leave these faults out with {option}");
        say(&format!("  Left out on this machine: {lacking}"));
    }
    let mut outcome =
        play(&mut stage, &cast, &mut steps, &mut Plan::new(seed, broker), length).await;
    // A run that breaks off is not judged: what it noticed on the way is a fault all the same.
    if let Err(error) = &mut outcome
        && let Some(breach) = error.downcast_mut::<Breach>()
    {
        breach.add(&stage.faults);
    }
    if outcome.is_err() {
        for daemon in stage.world.daemons() {
            say(&format!("\n--- the end of {}:\n{}", daemon.log().display(), daemon.log_tail(15)));
        }
    }
    if outcome.is_err() || keep {
        save(&stage)?;
        say(&format!("\nKept for a look: {}", folder.keep().display()));
    }
    outcome
}

/// Data on a disk that goes away with this run are copied beside it.
fn save(stage: &Stage) -> anyhow::Result<()> {
    let folder = &stage.world.places.folder;
    for name in
        [format!("connector-{MUNICH}"), format!("connector-{HAMBURG}"), "platform".to_owned()]
    {
        let status = std::process::Command::new("cp")
            .arg("-a")
            .args([folder.join(&name), folder.join(format!("{name}-kept"))])
            .status()?;
        anyhow::ensure!(status.success(), "copying {name} failed");
    }
    Ok(())
}

async fn play(
    stage: &mut Stage,
    cast: &Cast,
    steps: &mut Steps,
    plan: &mut Plan,
    length: Length,
) -> anyhow::Result<()> {
    steps.run("every writer is kept busy", load::put_on(cast, &stage.world.places)).await?;
    // The clocks are only followed after a start.
    stage.strike(Fault::KillAll).await?;
    let comments = CommentTraffic::begin(&stage.world.places, &stage.comments_hurry.subscribe())?;
    let controls = ControlTraffic::begin(&stage.world.places, length.span)?;
    let start = Instant::now();
    let mut number = 0;
    while goes_on(stage, length, number, start) {
        number += 1;
        let strikes = plan.round();
        let failed = round(stage, steps, number, &strikes).await?;
        if !stage.missed().is_empty() {
            plan.owe(failed);
        }
    }
    let (said, taken) = (comments.end().await?, controls.end().await?);
    steps.run("the machines stop, and what waits arrives", drain(stage)).await?;
    steps.run("everything stops when asked", async { stage.stop().map(|()| "") }).await?;
    let took = start.elapsed();
    steps
        .run(
            "every report is held once, in order, and in the ledger",
            judge(stage, &said, Some(taken)),
        )
        .await?;
    summary(stage, length, number, took)
}

/// Returns whether another round is played. What every run has to have gets more rounds where it could not be caused.
fn goes_on(stage: &Stage, length: Length, number: u32, start: Instant) -> bool {
    let is_short = number < length.rounds_at_least
        || (number < length.rounds_at_least + ROUNDS_MORE && !stage.missed().is_empty());
    is_short || (start.elapsed() < length.span && stage.kills < length.kills)
}

/// Prints what was played, and fails where that is less than was asked for.
fn summary(stage: &Stage, length: Length, number: u32, took: Duration) -> anyhow::Result<()> {
    let counts: Vec<_> =
        stage.counts.iter().map(|(kind, count)| format!("{kind} {count}")).collect();
    say(&format!(
        "\n{} faults, {} kills in {number} rounds, {:.0} s; {}; {} programs ended by themselves.",
        stage.faults_struck(),
        stage.kills,
        took.as_secs_f64(),
        counts.join(", "),
        stage.ended
    ));
    anyhow::ensure!(
        stage.kills >= length.at_least_kills,
        "{} kills in the whole run, at least {} were asked for: let it go on for longer",
        stage.kills,
        length.at_least_kills
    );
    anyhow::ensure!(
        stage.faults_struck() >= length.at_least_faults,
        "{} faults in the whole run, at least {} were asked for: let it go on for longer",
        stage.faults_struck(),
        length.at_least_faults
    );
    let missed = stage.missed();
    anyhow::ensure!(missed.is_empty(), "the run had no {}", missed.join(" and no "));
    Ok(())
}

/// Plays a round. Returns the faults that could not be caused, or that nobody noticed.
async fn round(
    stage: &mut Stage,
    steps: &mut Steps,
    number: u32,
    strikes: &[Strike],
) -> anyhow::Result<Vec<Fault>> {
    let faults: Vec<_> = strikes.iter().map(|strike| strike.fault.to_string()).collect();
    let mut failed = Vec::new();
    steps
        .run(&format!("round {number}: {}", faults.join(", ")), async {
            for strike in strikes {
                tokio::time::sleep(strike.pause).await;
                if !stage.strike(strike.fault).await? {
                    failed.push(strike.fault);
                }
            }
            let quiet = Instant::now();
            flows(stage).await?;
            let names: Vec<_> = failed.iter().map(ToString::to_string).collect();
            let without = if names.is_empty() { "" } else { "; without effect: " };
            Ok(format!(
                "values flow after {:.1} s{without}{}",
                quiet.elapsed().as_secs_f64(),
                names.join(", ")
            ))
        })
        .await?;
    Ok(failed)
}

/// Lets the last values through: nothing new is made, and nothing waits any more.
async fn drain(stage: &mut Stage) -> anyhow::Result<String> {
    stage.supervise()?;
    stage.machines_stopped = Some(disturbances::now());
    for factory in &mut stage.world.factories {
        factory.simulator.stop(Duration::from_secs(15))?;
    }
    let munich = stage.world.connector_api(MUNICH).await?;
    let hamburg = stage.world.connector_api(HAMBURG).await?;
    both_are_empty(stage, &munich, &hamburg).await?;
    let platform = stage.world.platform_api().await?;
    let unanswered = control::parts_are_answered(&platform, RECOVERY).await?;
    unanswered.map_or(Ok(()), |fault| Err(breach(vec![fault])))?;
    // An answer to a part may have brought decisions with it.
    both_are_empty(stage, &munich, &hamburg).await?;
    Ok(String::new())
}

async fn both_are_empty(stage: &Stage, munich: &Api, hamburg: &Api) -> anyhow::Result<()> {
    story::link_is_up(munich).await?;
    story::link_is_up(hamburg).await?;
    let both = (nothing_waits(stage, MUNICH, munich), nothing_waits(stage, HAMBURG, hamburg));
    tokio::try_join!(both.0, both.1).map(drop)
}

/// Waits until the spool stays empty: clients notice lost machines one after the other, and each
/// then reports it.
async fn nothing_waits(stage: &Stage, factory: &str, connector: &Api) -> anyhow::Result<()> {
    let folder = &stage.world.places.folder;
    let deadline = Deadline::after(RECOVERY);
    let mut quiet_since = Instant::now();
    while quiet_since.elapsed() < QUIET {
        let backlog: Value = connector.get("/api/v1/spool").await?;
        let gaps = stores::unsettled_gaps(folder, factory).await?;
        if backlog["waiting"] != 0 || backlog["sent"] != 0 || gaps != 0 {
            if deadline.has_passed() {
                let fault = format!(
                    "not everything was receipted within {RECOVERY:?}: {backlog}, {gaps} gaps"
                );
                return Err(breach(vec![fault]));
            }
            quiet_since = Instant::now();
        }
        tokio::time::sleep(Duration::from_millis(100)).await;
    }
    Ok(())
}

/// Compares the stores. What the machines counted, and what was decided under faults, is judged where `taken` says that
/// it was put under faults.
async fn judge(stage: &Stage, said: &[Comment], taken: Option<Taken>) -> anyhow::Result<String> {
    let folder = &stage.world.places.folder;
    let mut findings = Findings { faults: stage.faults.clone(), ..Findings::default() };
    for factory in [MUNICH, HAMBURG] {
        findings::of_factory(stage, factory, taken.as_ref(), &mut findings).await?;
        if taken.is_some() {
            findings.of_machines(stage, factory).await?;
        }
        if let Err(error) = ledger_holds(stage, factory).await {
            findings.faults.push(format!("{error:#}"));
        }
    }
    findings.faults.extend(comments::faults(folder, said, &stage.lost_comments).await?);
    let (repeats, letters) = stores::repeats_and_dead_letters(folder).await?;
    if letters > 0 {
        findings.faults.push(format!("{letters} messages could not be used"));
    }
    let Findings { left, arrived, given_up, replayed, mut faults } = findings;
    let is_external = stage.world.external.is_some();
    let (share, fault) = set_back::share(stage.set_back.len(), left, is_external);
    faults.extend(fault);
    if !faults.is_empty() {
        return Err(breach(faults));
    }
    let is_silent = said.is_empty() && taken.is_some();
    anyhow::ensure!(left > 0 && !is_silent, "nothing left at all");
    let controls = taken.as_ref().map_or(Ok(String::new()), Taken::said)?;
    Ok(format!(
        "{left} reports left, {arrived} arrived ({replayed} of them replayed), {given_up} were given up, {repeats} repeats discarded, \
         {} set back by a broker ({share}); {} comments taken, {} of them on their way to a broker that lost its store{controls}",
        stage.set_back.len(),
        said.len(),
        stage.lost_comments.len()
    ))
}

/// Verifies a connector's ledger with the command that an auditor runs.
async fn ledger_holds(stage: &Stage, factory: &str) -> anyhow::Result<()> {
    let folder = &stage.world.places.folder;
    let config = folder.join(format!("connector-{factory}.toml")).display().to_string();
    let mut verify = Daemon::start(DaemonCommand {
        name: format!("verify-{factory}"),
        program: binary("factory-connector")?,
        arguments: ["ledger", "verify", "--config", &config].map(str::to_owned).to_vec(),
        environment: Vec::new(),
        log: folder.join(format!("verify-{factory}.log")),
    })?;
    let status = eventually("the ledger is verified", Duration::from_secs(120), || {
        let ended = verify.ended();
        async move { ended.map_err(|e| e.to_string())?.ok_or_else(|| "still running".to_owned()) }
    })
    .await?;
    anyhow::ensure!(
        status.success(),
        "the ledger of {factory} does not hold: {}",
        verify.log_tail(5)
    );
    Ok(())
}
