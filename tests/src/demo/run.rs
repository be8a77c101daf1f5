//! The demo for a person.

use std::path::PathBuf;

use anyhow::Context as _;

use super::play;
use crate::{
    harness::{Steps, say},
    world::{ADMIN, ENGINEER, PASSWORD, Places, World},
};

/// Plays the story and runs until Ctrl-C.
///
/// # Errors
/// A step that fails, or a program that ends by itself.
pub async fn run(folder: PathBuf) -> anyhow::Result<()> {
    let places = Places::in_folder(folder)?;
    say(&format!("Verbund demo in {}\n", places.folder.display()));
    let mut world = World::start(places)?;
    let mut steps = Steps::default();
    let played = tokio::select! {
        played = play(&mut world, &mut steps) => Some(played),
        _ = tokio::signal::ctrl_c() => None,
    };
    match played {
        None => {}
        Some(Err(error)) => {
            let folder = world.places.folder.display().to_string();
            world.stop().ok();
            return Err(error.context(format!("the logs are in {folder}")));
        }
        Some(Ok(_)) => {
            say(&addresses(&world.places));
            until_stopped(&mut world).await?;
        }
    }
    say("\nStopping; the next `make demo` goes on from here.");
    world.stop()
}

fn addresses(places: &Places) -> String {
    let (munich, hamburg) = (&places.munich, &places.hamburg);
    format!(
        "\nEverything runs.\n\n\
         \x20 Partners' page    http://127.0.0.1:{}   sign in as {ADMIN} / {PASSWORD}\n\
         \x20 Munich engineer   http://127.0.0.1:{}   sign in as {ENGINEER} / {PASSWORD}\n\
         \x20 Hamburg engineer  http://127.0.0.1:{}   sign in as {ENGINEER} / {PASSWORD}\n\
         \x20 Munich's twin     opc.tcp://127.0.0.1:{}   (Basic256Sha256, user {ENGINEER})\n\
         \x20 Hamburg's twin    opc.tcp://127.0.0.1:{}   (Basic256Sha256, user {ENGINEER})\n\
         \x20 Broker            amqps://127.0.0.1:{}\n\
         \x20 Logs and data     {}\n\n\
         Ctrl-C stops everything.",
        places.platform_web,
        munich.connector_web,
        hamburg.connector_web,
        munich.twin,
        hamburg.twin,
        places.broker_tls,
        places.folder.display()
    )
}

/// Waits for Ctrl-C (or SIGTERM); a program that ends by itself is an error.
async fn until_stopped(world: &mut World) -> anyhow::Result<()> {
    let mut terminate = tokio::signal::unix::signal(tokio::signal::unix::SignalKind::terminate())?;
    let mut ticks = tokio::time::interval(std::time::Duration::from_millis(500));
    loop {
        tokio::select! {
            interrupted = tokio::signal::ctrl_c() => return interrupted.context("listening for Ctrl-C"),
            _ = terminate.recv() => return Ok(()),
            _ = ticks.tick() => {
                for daemon in world.daemons() {
                    if let Some(status) = daemon.ended()? {
                        anyhow::bail!("{} ended with {status}:\n{}", daemon.name(), daemon.log_tail(20));
                    }
                }
            }
        }
    }
}
