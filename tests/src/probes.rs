//! Attacks that once worked, replayed from outside against the real programs: what each answers, how
//! long it takes, how much memory it costs, and whether honest people are served all the same. At the
//! end many attacks at once.

mod accounts;
mod amqp;
mod attacks;
mod behind_proxy;
mod downloads;
mod entrance;
mod files;
mod http;
mod impostors;
mod members;
mod opcua;
mod plant;
mod process;
mod route;
mod scene;
mod siege;
mod strangers;

use std::sync::Arc;

use attacks::attacks;
use route::Route;
use scene::{Scene, Target};

use crate::{
    demo::play,
    frame_order::{INSPECTOR, MAKER, MUNICH},
    harness::{Steps, say},
    scenario::{load, story},
    world::{Places, World},
};

/// Plays the frame order in a folder of its own, and then each attack whose name contains a text; all of
/// them without one.
///
/// # Errors
/// List of the attacks that were not borne, or the program that does not start.
pub async fn run(only: Option<&str>, keep: bool) -> anyhow::Result<()> {
    let folder = tempfile::Builder::new().prefix("verbund-probes-").tempdir()?;
    let mut places = Places::anywhere(folder.path().to_owned())?;
    places.broker_websocket = Some(free_ports::reserve::<1>()?[0]);
    places.counters = Some(free_ports::reserve()?);
    let mut world = World::start(places)?;
    let mut cast = play(&mut world, &mut Steps::default()).await?;
    let newcomer = opcua::comes_in_development(Route::honest(world.places.munich.twin)).await?;
    // From here on the connector's OPC UA server knows whom an engineer trusts alone, as a real one does.
    if let Some(connector) = &mut world.factory(MUNICH)?.connector {
        connector.set_environment("VERBUND_TWIN__SECURITY__TRUST_UNKNOWN_CERTIFICATES", "false");
        connector.restart()?;
    }
    cast.munich = world.connector_api(MUNICH).await?;
    story::link_is_up(&cast.munich).await?;
    let maker = members::planner(&cast.platform, MAKER).await?;
    let inspector = members::planner(&cast.platform, INSPECTOR).await?;
    let newcomer = Arc::new(newcomer);
    let mut scene = Scene { world, cast, maker, inspector, newcomer, failures: Vec::new() };
    say("\n  program      time      peak     grew  attack: answer");
    let outcome = play_attacks(&mut scene, only).await;
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

/// Name of the attack on the walls around scripts.
const WALLS: &str = "scripts without walls";

async fn play_attacks(scene: &mut Scene, only: Option<&str>) -> anyhow::Result<()> {
    let mut played = 0;
    let mut is_wanted = |name: &str| {
        let is_wanted = only.is_none_or(|only| name.contains(only));
        played += usize::from(is_wanted);
        is_wanted
    };
    let usual = if is_wanted("siege") { Some(siege::usual(scene).await?) } else { None };
    for attack in attacks(scene) {
        if is_wanted(attack.name) {
            let before = scene.before(attack.target)?;
            let outcome = attack.course.await;
            scene.judge(attack.name, before, outcome).await?;
        }
    }
    if let Some(usual) = usual {
        siege::run(scene, usual).await?;
    }
    // Last: the values that fill the ledger go on.
    let of_load = [WALLS, downloads::NAME].map(is_wanted);
    anyhow::ensure!(played > 0, "no attack is named {only:?}");
    if of_load.contains(&true) {
        load::put_on(&scene.cast, &scene.world.places).await?;
    }
    let [with_walls, with_downloads] = of_load;
    if with_walls {
        let before = scene.before(Target::Connector)?;
        let outcome = plant::walls(scene.cast.munich.clone()).await;
        scene.judge(WALLS, before, outcome).await?;
    }
    if with_downloads {
        downloads::run(scene).await?;
    }
    Ok(())
}
