//! The demo for people, watched from outside: a hurried `demo run`, its terminal, the platform and a browser.

mod samples;

use std::{
    path::Path,
    time::{Duration, Instant},
};

use anyhow::Context as _;
use rustix::process::{Pid, Signal, kill_process};
use samples::{Sample, Samples};
use serde_json::Value;

use super::check::browser;
use crate::{
    course::HURRIED,
    frame_order::{HAMBURG, MUNICH, NETWORK},
    harness::{Api, Daemon, DaemonCommand, Steps, binary, eventually, say},
    scenario::story,
    world::{ADMIN, ENGINEER, PASSWORD, Places},
};

/// Time for the start of everything on a busy machine.
const PATIENCE: Duration = Duration::from_secs(180);
/// Time in which anything of a round has happened.
const ROUND: Duration = Duration::from_secs(HURRIED.every as u64 + 60);

/// Starts a demo, watches an order from its first frame to its last and the begin of the next one, and starts the demo a
/// second time.
///
/// # Errors
/// The first step that does not hold.
pub async fn watch(keep: bool) -> anyhow::Result<()> {
    let folder = tempfile::Builder::new().prefix("verbund-order-").tempdir()?;
    let places = Places::anywhere(folder.path().to_owned())?;
    places.note()?;
    let mut steps = Steps::default();
    let mut demo = Daemon::start(DaemonCommand {
        name: "demo".to_owned(),
        program: binary("demo")?,
        arguments: ["run", "--hurried", "--folder"]
            .into_iter()
            .map(str::to_owned)
            .chain([places.folder.display().to_string()])
            .collect(),
        environment: Vec::new(),
        log: folder.path().join("demo.log"),
    })?;
    let outcome = everything(&mut demo, &places, &mut steps).await;
    if outcome.is_err() || keep {
        say(&format!("\n--- the terminal of the demo:\n{}", demo.log_tail(usize::MAX)));
        say(&format!("\nKept for a look: {}", folder.keep().display()));
    }
    demo.stop(Duration::from_secs(60))?;
    outcome?;
    let (count, took) = steps.total();
    say(&format!("\n{count} steps hold, {:.1} s.", took.as_secs_f64()));
    Ok(())
}

async fn everything(demo: &mut Daemon, places: &Places, steps: &mut Steps) -> anyhow::Result<()> {
    steps.run("the demo starts, and says what comes", starts(demo)).await?;
    let platform = signed_in(places.platform_web, ADMIN).await?;
    let samples = Samples::take(platform.clone());
    steps.run("lateness, what it hits, a failure and recovery on the pages", pages(places)).await?;
    steps.run("frames are counted from the start of the order", counted(&samples)).await?;
    steps
        .run("one operation is late before it ends, and others wait for it", late(&samples))
        .await?;
    steps.run("the milling cell fails and works again", fails_and_recovers(&samples)).await?;
    steps
        .run(
            "a killed connector starts again, and nothing is lost",
            killed(demo, &platform, MUNICH),
        )
        .await?;
    steps.run("the partner saw values grow old, and go on", silent(&samples)).await?;
    steps
        .run("a program that a person kills starts again, too", async {
            kill(demo, "Hamburg's connector")?;
            killed(demo, &platform, HAMBURG).await
        })
        .await?;
    steps.run("the order ends at its quantity, all along the chain", ends(&samples)).await?;
    steps.run("the next order begins, with a plan of its own", next_order(&samples)).await?;
    steps.run("nothing goes beyond the plan", async { within_plan(&samples) }).await?;
    drop(samples);
    steps.run("a second start goes on, with the next order", second_start(demo, places)).await
}

async fn signed_in(port: u16, user: &str) -> anyhow::Result<Api> {
    let mut api = Api::new(format!("http://127.0.0.1:{port}"))?;
    api.sign_in(user, PASSWORD).await?;
    Ok(api)
}

fn terminal(log: &Path) -> String {
    std::fs::read_to_string(log).unwrap_or_default()
}

/// Waits until the terminal shows a text.
async fn shown(demo: &mut Daemon, text: &str, limit: Duration) -> anyhow::Result<()> {
    let log = demo.log().to_owned();
    let ended = eventually(&format!("the terminal shows {text:?}"), limit, || {
        let ended = demo.ended();
        let is_shown = terminal(&log).contains(text);
        async move {
            match ended {
                Ok(Some(status)) => Ok(Some(status)),
                _ if is_shown => Ok(None),
                _ => Err("not yet".to_owned()),
            }
        }
    })
    .await?;
    match ended {
        Some(status) => anyhow::bail!("the demo ended with {status}:\n{}", demo.log_tail(30)),
        None => Ok(()),
    }
}

async fn starts(demo: &mut Daemon) -> anyhow::Result<String> {
    shown(demo, "What happens, in minutes", PATIENCE).await?;
    let text = terminal(demo.log());
    for word in ["Everything runs.", "Munich begins order 4711-1", "fails for", "kills"] {
        anyhow::ensure!(text.contains(word), "the terminal does not say {word:?}:\n{text}");
    }
    Ok(String::new())
}

async fn pages(places: &Places) -> anyhow::Result<String> {
    browser::run_at(places, "test", &["--project=order"], &[]).await
}

/// Waits until a sample shows something.
async fn seen(
    samples: &Samples,
    what: &str,
    shows: impl Fn(&Sample) -> bool,
) -> anyhow::Result<Sample> {
    eventually(what, ROUND, || async {
        samples.find(&shows).ok_or_else(|| format!("last seen: {:?}", samples.last()))
    })
    .await
}

async fn counted(samples: &Samples) -> anyhow::Result<String> {
    let sample = seen(samples, "a frame is counted", |sample| {
        sample.of("MakeFrame1").quantity.is_some_and(|quantity| (1.0..12.0).contains(&quantity))
    })
    .await?;
    let make = sample.of("MakeFrame1");
    Ok(format!("{:?} of {:?}", make.quantity.unwrap_or_default(), make.planned_quantity))
}

async fn late(samples: &Samples) -> anyhow::Result<String> {
    let sample = seen(samples, "an end later than planned, before it has come", |sample| {
        let make = sample.of("MakeFrame1");
        make.state == "Running" && make.expected_late_s >= 60
    })
    .await?;
    Ok(format!("{} s late", sample.of("MakeFrame1").expected_late_s))
}

async fn fails_and_recovers(samples: &Samples) -> anyhow::Result<String> {
    let failed = seen(samples, "the operation is interrupted, with the reason", |sample| {
        sample.of("MakeFrame1").state == "Interrupted"
            && sample.interrupted_by == "Tool life exceeded"
    })
    .await?;
    let again = seen(samples, "it runs again", |sample| {
        sample.taken_at > failed.taken_at
            && sample.of("MakeFrame1").state == "Running"
            && sample.interrupted_by == "none"
    })
    .await?;
    Ok(format!("after {:.0} s", (again.taken_at - failed.taken_at).as_secs_f64()))
}

/// Kills the program that the terminal names so.
fn kill(demo: &Daemon, name: &str) -> anyhow::Result<()> {
    let text = terminal(demo.log());
    let process = text.lines().find_map(|line| line.trim().strip_prefix(name)?.trim().parse().ok());
    let process =
        process.and_then(Pid::from_raw).with_context(|| format!("no process of {name}"))?;
    Ok(kill_process(process, Signal::KILL)?)
}

/// Waits until the terminal has said of a factory's connector that it ended, runs again, and lost nothing; the platform has
/// to agree.
async fn killed(demo: &mut Daemon, platform: &Api, factory_id: &str) -> anyhow::Result<String> {
    let city = if factory_id == MUNICH { "Munich" } else { "Hamburg" };
    for text in [
        format!("Ended: {city}'s connector"),
        format!("Started again: {city}'s connector"),
        format!("reports of {city}'s connector are at the platform"),
    ] {
        shown(demo, &text, ROUND).await?;
    }
    let received = story::none_missing(platform, factory_id).await?;
    Ok(format!("{received} reports received"))
}

/// Waits until an operation that runs had no report for most of the time that a killed connector stays away, and then had
/// one again.
async fn silent(samples: &Samples) -> anyhow::Result<String> {
    let silence = |sample: &Sample| {
        let make = sample.of("MakeFrame1");
        make.silence.filter(|_| make.state == "Running").map(|silence| silence.as_seconds_f64())
    };
    let away = f64::from(HURRIED.kill.1);
    let quiet = seen(samples, "no report while the connector is away", |sample| {
        silence(sample).is_some_and(|seconds| seconds > away - 1.0)
    })
    .await?;
    seen(samples, "reports again", |sample| {
        sample.taken_at > quiet.taken_at
            && silence(sample).is_some_and(|seconds| seconds < away - 1.0)
    })
    .await?;
    Ok(String::new())
}

async fn ends(samples: &Samples) -> anyhow::Result<String> {
    for (operation, quantity) in
        [("MakeFrame1", 12.0), ("ShipFrame1", 12.0), ("AssembleFrame1", 1.0)]
    {
        seen(samples, &format!("{operation} is done"), |sample| {
            let operation = sample.of(operation);
            operation.state == "Ended" && operation.quantity == Some(quantity)
        })
        .await?;
    }
    seen(samples, "InspectFrame1 is done, with scrap", |sample| {
        let inspect = sample.of("InspectFrame1");
        inspect.state == "Ended"
            && inspect.quantity.unwrap_or_default() + inspect.scrap.unwrap_or_default() >= 12.0
    })
    .await?;
    Ok(String::new())
}

async fn next_order(samples: &Samples) -> anyhow::Result<String> {
    let first = samples.find(&|_| true).context("no sample was taken")?;
    let next = seen(samples, "a later plan, and a count from 0", |sample| {
        let make = sample.of("MakeFrame1");
        sample.revision > first.revision
            && make.planned_end > first.of("MakeFrame1").planned_end
            && make.state == "Running"
            && make.quantity.is_some_and(|quantity| quantity < 12.0)
    })
    .await?;
    Ok(format!("revision {}", next.revision))
}

fn within_plan(samples: &Samples) -> anyhow::Result<String> {
    let beyond = samples.find(&|sample| {
        sample
            .operations
            .values()
            .any(|operation| operation.quantity.unwrap_or_default() > operation.planned_quantity)
    });
    anyhow::ensure!(beyond.is_none(), "more than planned: {beyond:?}");
    Ok(format!("{} looks at the platform", samples.count()))
}

async fn second_start(demo: &mut Daemon, places: &Places) -> anyhow::Result<String> {
    demo.stop(Duration::from_secs(60))?;
    let before = terminal(demo.log());
    std::fs::write(demo.log(), "")?;
    demo.restart()?;
    let start = Instant::now();
    shown(demo, "What happens, in minutes", PATIENCE).await?;
    let text = terminal(demo.log());
    anyhow::ensure!(text.contains("enrolled before"), "it does not go on:\n{text}");
    let known = before.lines().filter_map(order_number).max().unwrap_or_default();
    let next = text.lines().find_map(order_number).unwrap_or_default();
    anyhow::ensure!(next == known + 1, "after order {known} comes {next}");
    let platform = signed_in(places.platform_web, ADMIN).await?;
    let samples = Samples::take(platform);
    seen(&samples, "it counts from 0", |sample| {
        let make = sample.of("MakeFrame1");
        make.state == "Running" && make.quantity.is_some_and(|quantity| quantity < 12.0)
    })
    .await?;
    let connector = signed_in(places.munich.connector_web, ENGINEER).await?;
    let inbox: Value = connector.get(&format!("/api/v1/operation-networks/{NETWORK}")).await?;
    anyhow::ensure!(inbox.to_string().contains("MakeFrame1"), "the connector forgot: {inbox}");
    Ok(format!("order 4711-{next}, after {:.0} s", start.elapsed().as_secs_f64()))
}

/// Returns the number of the order that a line says begins.
fn order_number(line: &str) -> Option<u64> {
    let (_, rest) = line.split_once("Munich begins order 4711-")?;
    rest.split(':').next()?.parse().ok()
}
