//! The demo without a person: each step checked from outside - as an OPC UA client, an AMQP client,
//! an HTTP client and a browser see it - one line a step.

mod amqp;
pub(super) mod browser;
mod crash;
pub mod latency;
mod opcua;
mod tool;

use super::{Cast, play};
use crate::{
    harness::{Steps, say},
    world::{BrokerKind, ExternalBroker, Places, World},
};

/// Plays the story in a folder of its own, checks it, and stops everything.
///
/// # Errors
/// The first step that does not hold.
pub async fn check(keep: bool) -> anyhow::Result<()> {
    check_with(BrokerKind::Embedded, keep).await
}

/// Plays and checks the story with a broker of some make. What other clients say to the platform's own broker, and what
/// a browser shows, is checked with that one alone.
///
/// # Errors
/// The first step that does not hold.
pub async fn check_with(broker: BrokerKind, keep: bool) -> anyhow::Result<()> {
    let folder = tempfile::Builder::new().prefix("verbund-demo-").tempdir()?;
    let places = Places::anywhere(folder.path().to_owned())?;
    let mut steps = Steps::default();
    let mut world = World::start_beside(places, ExternalBroker::start(broker).await)?;
    let outcome = everything(&mut world, &mut steps).await;
    if outcome.is_err() || keep {
        for daemon in world.daemons() {
            say(&format!("\n--- the end of {}:\n{}", daemon.log().display(), daemon.log_tail(15)));
        }
        say(&format!("\nKept for a look: {}", folder.keep().display()));
    }
    outcome?;
    let (count, took) = steps.total();
    say(&format!("\n{count} steps hold, {:.1} s.", took.as_secs_f64()));
    Ok(())
}

async fn everything(world: &mut World, steps: &mut Steps) -> anyhow::Result<()> {
    let cast = play(world, steps).await?;
    seen_from_outside(world, &cast, steps).await?;
    steps
        .run(
            "a change on the machine reaches the buyer",
            latency::of_values(world, &cast.platform, 20),
        )
        .await?;
    if world.external.is_none() {
        steps.run("a browser shows the buyer's page", browser::partners_page(world)).await?;
        steps.run("no page has barriers", browser::without_barriers(world)).await?;
        steps
            .run("pages are as people need them in their first week", browser::findings(world))
            .await?;
        steps.run("an operator works on without a network", browser::operators_page(world)).await?;
        steps.run("a passkey signs in on a page", browser::passkey(world)).await?;
    }
    let cast = crash::every_program_in_turn(world, cast, steps).await?;
    steps.run("no report was lost and none counted twice", crash::nothing_lost(&cast)).await?;
    steps.run("everything stops when asked", async { world.stop().map(|()| "") }).await
}

/// Plays the story, looks for barriers on every page, and takes pictures of all.
///
/// # Errors
/// When the story does not play, a page has barriers, or one does not show.
pub async fn screenshots() -> anyhow::Result<()> {
    let folder = tempfile::Builder::new().prefix("verbund-pictures-").tempdir()?;
    let mut world = World::start(Places::anywhere(folder.path().to_owned())?)?;
    play(&mut world, &mut Steps::default()).await?;
    let without_barriers = browser::run(&world, "test", &["--project=accessibility"]).await?;
    say(&format!("no barriers: {without_barriers}"));
    let taken = browser::run(&world, "test", &["--project=screenshots"]).await?;
    say(&format!("{taken}; the pictures are in target/screenshots"));
    world.stop()
}

async fn seen_from_outside(world: &World, cast: &Cast, steps: &mut Steps) -> anyhow::Result<()> {
    steps.run("asyncua browses the interface", opcua::browse(world)).await?;
    steps
        .run(
            "asyncua writes the field decided External",
            opcua::write_external(world, &cast.platform),
        )
        .await?;
    steps.run("asyncua may not write another field", opcua::write_mapped(world)).await?;
    if world.external.is_some() {
        let asking = tool::asks_and_reads(world, cast);
        return steps.run("a tool asks and reads over the broker of another make", asking).await;
    }
    steps
        .run("rubbish over AMQP is answered and changes nothing", amqp::rubbish(world, cast))
        .await?;
    steps.run("an oversize body is refused by the broker", amqp::oversize(world)).await
}
