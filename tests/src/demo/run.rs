//! The demo for a person.

use std::{
    path::PathBuf,
    time::{Duration, Instant},
};

use anyhow::Context as _;
use time::OffsetDateTime;
use tokio::{
    signal::unix::{SignalKind, signal},
    time::MissedTickBehavior,
};

use super::{
    announcements::{Announcement, FORETOLD, minutes, of_round},
    play,
    supervision::{Supervision, Turn},
};
use crate::{
    course::{Course, HURRIED, UNHURRIED},
    frame_order::{HAMBURG, MUNICH},
    harness::{Steps, say},
    scenario::{order::send_round, story},
    world::{ADMIN, ENGINEER, PASSWORD, Places, World},
};

/// Pause between two looks at programs and clock.
const LOOK_EACH: Duration = Duration::from_millis(500);
/// Longest time that one look may take, so that a program that does not answer hides no other.
const LOOK_MAX: Duration = Duration::from_secs(10);

/// Plays the story, then round after round until Ctrl-C. Hurried, a round takes minutes.
///
/// # Errors
/// A step that fails, or a program that cannot be kept running.
pub async fn run(folder: PathBuf, is_hurried: bool) -> anyhow::Result<()> {
    let mut places = Places::in_folder(folder)?;
    say(&format!("Verbund demo in {}\n", places.folder.display()));
    let pace = if is_hurried { &HURRIED } else { &UNHURRIED };
    let course = Course::begin(pace, &places.folder, OffsetDateTime::now_utc())?;
    places.course = Some(course);
    let mut world = World::start(places)?;
    let mut terminate = signal(SignalKind::terminate())?;
    let outcome = tokio::select! {
        outcome = play_rounds(&mut world, course) => outcome,
        interrupted = tokio::signal::ctrl_c() => interrupted.context("listening for Ctrl-C"),
        _ = terminate.recv() => Ok(()),
    };
    if let Err(error) = outcome {
        let folder = world.places.folder.display().to_string();
        world.stop().ok();
        return Err(error.context(format!("the logs are in {folder}")));
    }
    say("\nStopping; the next `make demo` goes on from here, with the next order.");
    world.stop()
}

async fn play_rounds(world: &mut World, course: Course) -> anyhow::Result<()> {
    play(world, &mut Steps::default()).await?;
    say(&addresses(&world.places));
    let programs: Vec<String> = world
        .daemons()
        .map(|daemon| format!("{} {}", called(daemon.name()), daemon.pid()))
        .collect();
    say(&format!(
        "\nKill what you like (kill -9): it is started again.\n  {}",
        programs.join("\n  ")
    ));
    let mut rounds = Rounds::begin(course, &world.places);
    rounds.foretell();
    let mut ticks = tokio::time::interval(LOOK_EACH);
    ticks.set_missed_tick_behavior(MissedTickBehavior::Delay);
    loop {
        ticks.tick().await;
        rounds.look(world).await?;
    }
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

/// Name of a program in a sentence.
fn called(name: &str) -> String {
    let city = |factory: &str| if factory == MUNICH { "Munich" } else { "Hamburg" };
    match name.split_once('-') {
        Some(("connector", factory)) => format!("{}'s connector", city(factory)),
        Some(("machines", factory)) => format!("{}'s machines", city(factory)),
        _ => "the platform".to_owned(),
    }
}

/// Rounds of a running demo: what happened, and what comes next.
struct Rounds {
    course: Course,
    supervision: Supervision,
    round: u32,
    /// Rest of this round.
    to_come: std::vec::IntoIter<Announcement>,
    /// Round whose plan the platform does not have yet.
    to_plan: Option<u32>,
    /// Factories of which a kill may have cost reports, until it is proven that none is missing.
    to_prove: Vec<&'static str>,
}

impl Rounds {
    fn begin(course: Course, places: &Places) -> Self {
        Self {
            course,
            supervision: Supervision::new(Duration::from_secs(course.pace.kill.1.into())),
            round: 0,
            to_come: of_round(&course, 0, places).into_iter(),
            to_plan: None,
            to_prove: Vec::new(),
        }
    }

    /// Says what a newcomer should wait for.
    fn foretell(&self) {
        let (_, passed) = self.course.now(OffsetDateTime::now_utc());
        say(&format!(
            "\nWhat takes days in a plant takes {} min here. The next minutes:\n",
            minutes(self.course.pace.every)
        ));
        for announcement in self.to_come.as_slice() {
            let wait = u32::try_from(i64::from(announcement.at) - passed).unwrap_or(0);
            if announcement.at < FORETOLD {
                say(&announcement.lines(&format!("in {}", minutes(wait))));
            }
        }
        say("\nWhat happens, in minutes since the begin of the order:\n");
    }

    async fn look(&mut self, world: &mut World) -> anyhow::Result<()> {
        for turn in self.supervision.look(world.daemons(), Instant::now())? {
            self.report(turn);
        }
        let (round, seconds) = self.course.now(OffsetDateTime::now_utc());
        if round > self.round {
            self.round = round;
            self.to_come = of_round(&self.course, round, &world.places).into_iter();
            self.to_plan = Some(round);
            self.course.note(&world.places.folder, round)?;
        }
        while self.to_come.as_slice().first().is_some_and(|next| i64::from(next.at) <= seconds) {
            let Some(announcement) = self.to_come.next() else { break };
            say(&announcement.lines(&minutes(announcement.at)));
            if announcement.kills
                && let Some(connector) = &mut world.factory(MUNICH)?.connector
            {
                connector.kill()?;
            }
        }
        // Where the platform or a connector does not answer now, the next look tries again.
        if let Some(round) = self.to_plan {
            let planned = plan(world, &self.course, round);
            if let Ok(Ok(accepted)) = tokio::time::timeout(LOOK_MAX, planned).await {
                self.to_plan = None;
                say(&format!("{:9}The buyer has planned it: {accepted}.", ""));
            }
        }
        if let Some(&factory_id) = self.to_prove.first()
            && let Ok(Ok(received)) = tokio::time::timeout(LOOK_MAX, prove(world, factory_id)).await
        {
            self.to_prove.retain(|known| *known != factory_id);
            let connector = called(&format!("connector-{factory_id}"));
            say(&format!(
                "{:9}Nothing is missing: all {received} reports of {connector} are at the platform.",
                ""
            ));
        }
        Ok(())
    }

    fn report(&mut self, turn: Turn) {
        match turn {
            Turn::Ended { name, status } => {
                let away = self.course.pace.kill.1;
                say(&format!(
                    "{:9}Ended: {} ({status}). It starts again in {away} s.",
                    "",
                    called(&name)
                ));
            }
            Turn::Started { name, pid } => {
                say(&format!("{:9}Started again: {}, process {pid}.", "", called(&name)));
                // Reports are at stake where either end was killed.
                let is_end = |factory_id: &&str| {
                    name == "platform" || name == format!("connector-{factory_id}")
                };
                self.to_prove.extend([MUNICH, HAMBURG].into_iter().filter(is_end));
            }
        }
    }
}

async fn plan(world: &mut World, course: &Course, round: u32) -> anyhow::Result<String> {
    let platform = world.platform_api().await?;
    send_round(&platform, course, round).await
}

/// Waits until a connector is back, and returns the number of its reports at the platform, of which none is missing.
async fn prove(world: &mut World, factory_id: &str) -> anyhow::Result<u64> {
    let connector = world.connector_api(factory_id).await?;
    story::link_is_up(&connector).await?;
    let platform = world.platform_api().await?;
    story::none_missing(&platform, factory_id).await
}
