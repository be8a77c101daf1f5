//! A factory that has just installed its connector: nothing in it yet, a machine that shows a
//! certificate, and later more requests and nodes than any page can show at once.

use std::{path::Path, time::Duration};

use anyhow::Context as _;

use super::check::browser;
use crate::{
    frame_order::{HAMBURG, MUNICH},
    harness::{Daemon, DaemonCommand, Steps, binary, kill_started_in, say},
    scenario::story,
    world::{Places, World},
};

/// Variables of the server that is larger than any page.
const NODES: u32 = 100_000;

/// Goes the way from an empty installation to the first mapped field in a browser, counting clicks
/// and texts. With very much, it then fills the inbox and the sources and measures how quickly the
/// pages answer.
///
/// # Errors
/// The first step that does not hold.
pub async fn newcomer(with_very_much: bool) -> anyhow::Result<()> {
    let folder = tempfile::Builder::new().prefix("verbund-newcomer-").tempdir()?;
    let mut world = World::start(Places::anywhere(folder.path().to_owned())?)?;
    let mut steps = Steps::default();
    let [machine, bank, control] = free_ports::reserve::<3>()?;
    let bank = with_very_much.then_some(bank);
    let mut machines = plant(folder.path(), machine, bank, control)?;
    let outcome = everything(&mut world, &mut steps, machine, bank).await;
    if outcome.is_err() {
        for daemon in world.daemons() {
            say(&format!("\n--- the end of {}:\n{}", daemon.log().display(), daemon.log_tail(15)));
        }
        say(&format!("\nKept for a look: {}", folder.keep().display()));
    }
    machines.stop(Duration::from_secs(15))?;
    world.stop()?;
    outcome
}

async fn everything(
    world: &mut World,
    steps: &mut Steps,
    machine: u16,
    bank: Option<u16>,
) -> anyhow::Result<()> {
    let platform = world.platform_api().await?;
    steps
        .run("three organisations found a collaboration", story::found_collaboration(&platform))
        .await?;
    for factory_id in [MUNICH, HAMBURG] {
        let step = format!("{factory_id}: an empty connector joins");
        steps.run(&step, story::join_factory(world, &platform, factory_id)).await?;
        story::link_is_up(&world.connector_api(factory_id).await?).await?;
    }
    steps.run("the buyer sends the operation network", story::send_network(&platform)).await?;
    let variables = [("MACHINE_URL", format!("opc.tcp://127.0.0.1:{machine}"))];
    let newcomer = browser::run_with(world, "test", &["--project=newcomer"], &variables);
    steps.run("from nothing to the first mapped field", newcomer).await?;
    let Some(bank) = bank else { return Ok(()) };
    let variables = [("BANK_URL", format!("opc.tcp://127.0.0.1:{bank}"))];
    let scale = browser::run_with(world, "test", &["--project=scale"], &variables);
    steps.run("20 000 fields and 100 000 nodes leave the pages quick", scale).await
}

/// Goes the way of the README without the demo: its commands in an empty folder, then both pages in a browser, up to the
/// first value that a partner sees. Clicks, texts, lines and time are counted.
///
/// # Errors
/// The first step that does not hold, or a way that is too long.
pub async fn by_the_readme() -> anyhow::Result<()> {
    let folder = tempfile::Builder::new().prefix("verbund-readme-").tempdir()?;
    let home = folder.path().canonicalize()?.join("home");
    let programs = binary("platform")?;
    let programs = programs.parent().context("a program is in a folder")?;
    std::fs::create_dir_all(home.join("target"))?;
    std::os::unix::fs::symlink(programs, home.join("target/release"))?;
    let [platform, broker, connector, twin, machine, control] = free_ports::reserve::<6>()?;
    let mut machines = plant(folder.path(), machine, None, control)?;
    let variables = [
        ("README_FOLDER", home.display().to_string()),
        ("MACHINE_URL", format!("opc.tcp://127.0.0.1:{machine}")),
        ("PLATFORM_PORT", platform.to_string()),
        ("BROKER_PORT", broker.to_string()),
        ("CONNECTOR_PORT", connector.to_string()),
        ("TWIN_PORT", twin.to_string()),
    ];
    let way = browser::run_alone("test", &["--project=readme"], &variables);
    let outcome = Steps::default().run("from the README to the first value", way).await;
    // Shells of a browser that was ended leave behind what they had started.
    kill_started_in(&home)?;
    if outcome.is_err() {
        say(&format!("\nKept for a look: {}", folder.keep().display()));
    }
    machines.stop(Duration::from_secs(15))?;
    outcome
}

/// Starts a milling cell whose certificate is not trusted yet, and with a port for it a bank of counters too large for
/// a page.
fn plant(folder: &Path, machine: u16, bank: Option<u16>, control: u16) -> anyhow::Result<Daemon> {
    let config = folder.join("machines-newcomer.toml");
    let bank = bank.map(|port| {
        format!(
            "\n[[machines]]\nname = \"Bank1\"\nkind = \"bank\"\nport = {port}\nvariables = {NODES}\nchanges_per_second = 10.0\n"
        )
    });
    let text = format!(
        "seed = 1\nhost = \"127.0.0.1\"\ncontrol = \"127.0.0.1:{control}\"\n\
         pki_directory = \"{folder}/machines-newcomer\"\n\n\
         [[machines]]\nname = \"MillingCell1\"\nkind = \"milling-cell\"\nport = {machine}\n\
         security = {{ unprotected = false, protected = true, trusts_all_clients = true }}\n{bank}",
        folder = folder.display(),
        bank = bank.unwrap_or_default(),
    );
    std::fs::write(&config, text).with_context(|| format!("writing {}", config.display()))?;
    Daemon::start(DaemonCommand {
        name: "machines-newcomer".to_owned(),
        program: binary("simulator")?,
        arguments: vec!["--config".to_owned(), config.display().to_string()],
        environment: Vec::new(),
        log: folder.join("machines-newcomer.log"),
    })
}
