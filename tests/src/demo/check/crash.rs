//! `kill -9` of every program in turn, and what is left afterwards.

use std::time::Duration;

use crate::{
    frame_order::{HAMBURG, MUNICH},
    harness::{Steps, eventually},
    scenario::{Cast, story},
    world::World,
};

/// Kills connector, platform (with its broker), a broker of another make and machines without warning, starts each again, and
/// waits until values flow as before.
pub(super) async fn every_program_in_turn(
    world: &mut World,
    cast: Cast,
    steps: &mut Steps,
) -> anyhow::Result<Cast> {
    let Cast { mut platform, mut munich, hamburg } = cast;
    steps
        .run("kill -9 of a connector, and it goes on", async {
            let factory = world.factory(MUNICH)?;
            if let Some(connector) = &mut factory.connector {
                connector.restart()?;
            }
            munich = world.connector_api(MUNICH).await?;
            story::link_is_up(&munich).await?;
            goes_on(&platform).await
        })
        .await?;
    steps
        .run("kill -9 of platform and broker, and they go on", async {
            world.platform.restart()?;
            platform = world.platform_api().await?;
            story::link_is_up(&munich).await?;
            goes_on(&platform).await
        })
        .await?;
    let title = match &world.external {
        None => "Proton in the platform's place sends a request and reads reports",
        Some(_) => "kill -9 of the broker of another make, and everything goes on",
    };
    steps
        .run(title, async {
            let mut read = String::new();
            if let Some(broker) = &mut world.external {
                broker.crash().await;
            } else {
                let mut broker = world.broker_alone()?;
                read = super::amqp::in_the_platforms_place(world).await?;
                broker.stop(Duration::from_secs(15))?;
                world.platform.restart()?;
                platform = world.platform_api().await?;
            }
            story::link_is_up(&munich).await?;
            goes_on(&platform).await.map(|_| read)
        })
        .await?;
    steps
        .run("kill -9 of the machines, and they are read again", async {
            world.factory(MUNICH)?.simulator.restart()?;
            goes_on(&platform).await
        })
        .await?;
    Ok(Cast { platform, munich, hamburg })
}

/// Waits for a newer report of the spindle's power, which changes all the time: it proves the whole
/// way.
async fn goes_on(platform: &crate::harness::Api) -> anyhow::Result<String> {
    let before = story::platform_field(platform, "spindlePower").await?;
    eventually("newer values arrive", Duration::from_secs(40), || async {
        let now =
            story::platform_field(platform, "spindlePower").await.map_err(|e| format!("{e:#}"))?;
        let is_newer = now["receivedAt"].as_str() > before["receivedAt"].as_str();
        if is_newer && !now["value"].is_null() { Ok(String::new()) } else { Err(now.to_string()) }
    })
    .await
}

/// Checks that every writer's sequence numbers have arrived, but for announced gaps.
pub(super) async fn nothing_lost(cast: &Cast) -> anyhow::Result<String> {
    let mut received = 0;
    for factory_id in [MUNICH, HAMBURG] {
        received += story::none_missing(&cast.platform, factory_id).await?;
    }
    Ok(format!("{received} reports received"))
}
