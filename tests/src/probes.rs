//! Attacks that once worked, replayed from outside against the real programs: what each answers, how
//! long it takes, how much memory it costs, and whether honest people are served all the same. At the
//! end many attacks at once ([`siege`]).

mod amqp;
mod attacks;
mod files;
mod http;
mod members;
mod opcua;
mod process;
mod siege;

use std::time::{Duration, Instant};

use anyhow::Context as _;
use attacks::attacks;
use process::{Memory, mib};

use crate::{
    demo::{Cast, play},
    frame_order::{INSPECTOR, MAKER},
    harness::{Api, Steps, say},
    world::{Places, World},
};

/// Growth of a program by one attack, at most.
const GROWTH_MAX: u64 = 96 << 20;
/// Memory of a program, whatever happens.
const MEMORY_MAX: u64 = 512 << 20;
/// Time in which an honest request has to be answered after an attack.
const ANSWER_MAX: Duration = Duration::from_secs(2);

/// The program that an attack is aimed at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Target {
    Platform,
    /// The platform's broker, a process of its own.
    Broker,
    Connector,
}

/// The running programs, and people who are signed in.
struct Scene {
    world: World,
    cast: Cast,
    /// Planners of the maker and of the inspector.
    maker: Api,
    inspector: Api,
    failures: Vec<String>,
}

/// Plays the frame order in a folder of its own, and then each attack whose name contains a text; all of
/// them without one.
///
/// # Errors
/// When the programs do not start, or with the list of attacks that were not borne.
pub async fn run(only: Option<&str>, keep: bool) -> anyhow::Result<()> {
    let folder = tempfile::Builder::new().prefix("verbund-probes-").tempdir()?;
    let mut places = Places::anywhere(folder.path().to_owned())?;
    places.broker_websocket = Some(free_ports::reserve::<1>()?[0]);
    let mut world = World::start(places)?;
    let cast = play(&mut world, &mut Steps::default()).await?;
    let maker = members::planner(&cast.platform, MAKER).await?;
    let inspector = members::planner(&cast.platform, INSPECTOR).await?;
    let mut scene = Scene { world, cast, maker, inspector, failures: Vec::new() };
    say("\n  program      time      peak     grew  attack: answer");
    let outcome = scene.play(only).await;
    if keep {
        say(&format!("Kept for a look: {}", folder.keep().display()));
    }
    outcome?;
    scene.world.stop()?;
    let failures = scene.failures;
    anyhow::ensure!(
        failures.is_empty(),
        "{} attacks were not borne:\n  {}",
        failures.len(),
        failures.join("\n  ")
    );
    Ok(())
}

impl Scene {
    async fn play(&mut self, only: Option<&str>) -> anyhow::Result<()> {
        let is_wanted = |name: &str| only.is_none_or(|only| name.contains(only));
        for attack in attacks(self) {
            if is_wanted(attack.name) {
                let before = self.before(attack.target)?;
                let outcome = attack.course.await;
                self.judge(attack.name, before, outcome).await?;
            }
        }
        if is_wanted("siege") {
            siege::run(self).await?;
        }
        Ok(())
    }

    fn before(&self, target: Target) -> anyhow::Result<Before> {
        let memory = self.memory(target)?;
        memory.reset_peak()?;
        Ok(Before { target, resident: memory.resident()?, since: Instant::now() })
    }

    fn memory(&self, target: Target) -> anyhow::Result<Memory> {
        let platform = self.world.platform.pid();
        Ok(match target {
            Target::Platform => Memory::of(platform),
            Target::Broker => Memory::of_child(platform)?,
            Target::Connector => {
                let connector = self.world.factories[0].connector.as_ref();
                Memory::of(connector.context("the connector is not started")?.pid())
            }
        })
    }

    /// Prints what an attack brought, and notes it where it was not borne.
    async fn judge(
        &mut self,
        name: &str,
        before: Before,
        outcome: anyhow::Result<String>,
    ) -> anyhow::Result<()> {
        let took = before.since.elapsed();
        let Before { target, resident, .. } = before;
        let peak = self.memory(target).and_then(Memory::peak).unwrap_or_default();
        let grew = peak.saturating_sub(resident);
        let mut faults = Vec::new();
        let answer = outcome.unwrap_or_else(|error| {
            faults.push(format!("{error:#}"));
            "not as expected".to_owned()
        });
        if let Err(error) = self.is_served(target).await {
            faults.push(format!("honest people are not served: {error:#}"));
        }
        if grew > GROWTH_MAX || peak > MEMORY_MAX {
            faults.push(format!("{} MiB more, {} MiB in all", mib(grew), mib(peak)));
        }
        let shown = format!("{target:?}").to_lowercase();
        say(&format!(
            "  {shown:<10} {:>6.2} s {:>5} MiB {:>4} MiB  {name}: {answer}",
            took.as_secs_f64(),
            mib(peak),
            mib(grew)
        ));
        for fault in faults {
            say(&format!("  FAIL {name}: {fault}"));
            self.failures.push(format!("{shown}: {name}: {fault}"));
        }
        Ok(())
    }

    /// Fails if the program has ended.
    fn runs(&mut self, target: Target) -> anyhow::Result<()> {
        let daemon = match target {
            // The platform ends with its broker.
            Target::Platform | Target::Broker => &mut self.world.platform,
            Target::Connector => {
                let connector = self.world.factories[0].connector.as_mut();
                connector.context("the connector is not started")?
            }
        };
        if let Some(status) = daemon.ended()? {
            anyhow::bail!("{} ended with {status}:\n{}", daemon.name(), daemon.log_tail(20));
        }
        Ok(())
    }

    /// Fails unless the program runs, and answers an honest request within some time.
    async fn is_served(&mut self, target: Target) -> anyhow::Result<()> {
        self.runs(target)?;
        let took = match target {
            Target::Platform => honest_request(&self.cast.platform).await?,
            Target::Broker => amqp::sign_in(self.world.places.broker_plain).await?,
            Target::Connector => honest_request(&self.cast.munich).await?,
        };
        anyhow::ensure!(took < ANSWER_MAX, "an answer took {took:?}");
        Ok(())
    }
}

/// State of a program before an attack.
struct Before {
    target: Target,
    resident: u64,
    since: Instant,
}

/// Asks as an honest person does, and returns the time that the answer took.
async fn honest_request(api: &Api) -> anyhow::Result<Duration> {
    let begun = Instant::now();
    let _: serde_json::Value = api.get("/api/v1/status").await?;
    Ok(begun.elapsed())
}
