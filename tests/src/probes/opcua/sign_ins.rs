//! People who guess passwords at a connector's OPC UA server, and those who type theirs into the wrong box.

use std::{
    path::PathBuf,
    time::{Duration, Instant},
};

use super::{Client, trust};
use crate::{
    harness::Api,
    probes::route::{Relay, Route},
    world::{ENGINEER, PASSWORD},
};

/// Guesses of each of those who guess, one after the other: more than one client may have wrong.
const GUESSES: usize = 12;
/// People who guess at the same time.
const GUESSERS: usize = 3;
/// Time in which an honest engineer has to be let in meanwhile.
const SERVED_MAX: Duration = Duration::from_secs(5);
/// Password that was typed into the field of the name, with the space that no name has.
const TYPED: &str = "vErY-secret typed by mistake";

/// Guesses of an engineer's password from another address, while the engineer signs in at the usual place: each guess
/// is refused, and each honest sign-in is served in time.
pub(in crate::probes) async fn guesses_beside_an_honest_sign_in(
    engineer: Api,
    twin: Route,
    hostile: Route,
) -> anyhow::Result<String> {
    let honest = Client::named("probe of an honest engineer")?;
    trust(&engineer, &honest).await?;
    let folder = tempfile::tempdir()?;
    let signs_in = async || {
        let begun = Instant::now();
        let is_in = honest.has_session(folder.path(), &twin.opcua_url()).await?;
        anyhow::ensure!(is_in, "the engineer is not let in");
        let took = begun.elapsed();
        anyhow::ensure!(took < SERVED_MAX, "the engineer was let in after {took:?}");
        anyhow::Ok(took)
    };
    // From here on this is the usual place.
    signs_in().await?;
    let relay = Relay::along(hostile).await?;
    let mut guessing = tokio::task::JoinSet::new();
    for number in 0..GUESSERS {
        let guesser = honest.another(&format!("probe that guesses {number}"))?;
        trust(&engineer, &guesser).await?;
        guessing.spawn(guess(guesser, relay.route()));
    }
    let (mut slowest, mut served, mut refused) = (Duration::ZERO, 0, 0);
    while !guessing.is_empty() {
        slowest = slowest.max(signs_in().await?);
        served += 1;
        while let Some(guessed) = guessing.try_join_next() {
            refused += guessed??;
        }
    }
    slowest = slowest.max(signs_in().await?);
    Ok(format!("{refused} refused, {} of an engineer served within {slowest:.1?}", served + 1))
}

/// Guesses an engineer's password. Returns the number of refusals.
async fn guess(guesser: Client, route: Route) -> anyhow::Result<usize> {
    let folder = tempfile::tempdir()?;
    for number in 0..GUESSES {
        let password = format!("a guess like others, number {number}");
        let user = (ENGINEER, password.as_str());
        let is_in = guesser.signs_in(folder.path(), &route.opcua_url(), user).await?;
        anyhow::ensure!(!is_in, "a guess was right");
    }
    Ok(GUESSES)
}

/// A password in the field of the name: the sign-in is refused, and its name is in no line of the log.
pub(in crate::probes) async fn names_typed_by_mistake(
    engineer: Api,
    hostile: Route,
    log: PathBuf,
) -> anyhow::Result<String> {
    let client = Client::named("probe with a wrong box")?;
    trust(&engineer, &client).await?;
    let (folder, relay) = (tempfile::tempdir()?, Relay::along(hostile).await?);
    let url = relay.route().opcua_url();
    let is_in = client.signs_in(folder.path(), &url, (TYPED, PASSWORD)).await?;
    anyhow::ensure!(!is_in, "a password is a name");
    let mut pages = Api::new(engineer.base())?;
    anyhow::ensure!(pages.sign_in(TYPED, PASSWORD).await.is_err(), "a password is a name");
    let log = tokio::fs::read_to_string(&log).await?;
    let said = log.lines().filter(|line| line.contains("refused a sign-in")).count();
    anyhow::ensure!(said > 0, "the log says nothing of the refusal");
    let is_there = TYPED.split(' ').any(|word| log.contains(word) && word.len() > 8);
    anyhow::ensure!(!is_there, "the log has what was typed");
    Ok(format!("{said} refusals are in the log, and no name"))
}
