//! The demo without a person: each step checked from outside, one line a step.

use super::play;
use crate::{
    harness::{Steps, say},
    world::{Places, World},
};

/// Plays the story in a folder of its own, checks it, and stops everything.
///
/// # Errors
/// The first step that does not hold.
pub async fn check(keep: bool) -> anyhow::Result<()> {
    let folder = tempfile::Builder::new().prefix("verbund-demo-").tempdir()?;
    let places = Places::anywhere(folder.path().to_owned())?;
    let mut steps = Steps::default();
    let mut world = World::start(places)?;
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
    play(world, steps).await?;
    world.stop()
}
