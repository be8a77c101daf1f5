//! The demo: the frame order, played for a person or checked without one.

mod announcements;
mod check;
mod newcomer;
mod run;
mod supervision;
mod watch;

pub use check::{check, check_with, latency, screenshots};
pub use newcomer::{by_the_readme, newcomer};
pub use run::run;
pub use watch::watch;

pub use crate::scenario::Cast;
use crate::{
    frame_order::{HAMBURG, MUNICH},
    harness::Steps,
    scenario::{
        order::{order_decisions, send_round},
        story,
    },
    world::World,
};

/// Plays the story up to the point where values flow; each step is left alone where an earlier
/// start took it. In a world with a course the machines work off its orders, and the network has its plan.
///
/// # Errors
/// The first step that fails.
pub async fn play(world: &mut World, steps: &mut Steps) -> anyhow::Result<Cast> {
    let mut platform = None;
    steps
        .run("the platform is up, with its broker", async {
            platform = Some(world.platform_api().await?);
            let own = || format!("its own, AMQP 1.0 with TLS on port {}", world.places.broker_tls);
            Ok(world
                .external
                .as_ref()
                .map_or_else(own, |broker| format!("at {}", broker.address())))
        })
        .await?;
    let platform = platform.expect("the step above ended well");
    steps
        .run("three organisations found a collaboration", story::found_collaboration(&platform))
        .await?;
    let mut connectors = Vec::new();
    for factory_id in [MUNICH, HAMBURG] {
        steps
            .run(&format!("{factory_id}: the connector joins"), async {
                let how = story::join_factory(world, &platform, factory_id).await?;
                let connector = world.connector_api(factory_id).await?;
                story::link_is_up(&connector).await?;
                connectors.push(connector);
                Ok(how)
            })
            .await?;
        let connector = &connectors[connectors.len() - 1];
        steps
            .run(
                &format!("{factory_id}: the connector reads the machines over OPC UA"),
                story::add_sources(world, connector, factory_id),
            )
            .await?;
    }
    let course = world.places.course;
    let decisions = if course.is_some() { order_decisions() } else { story::decisions() };
    steps
        .run("the buyer sends the operation network", async {
            match &course {
                Some(course) => send_round(&platform, course, 0).await,
                None => story::send_network(&platform).await,
            }
        })
        .await?;
    for (factory_id, connector) in [MUNICH, HAMBURG].into_iter().zip(&connectors) {
        steps
            .run(
                &format!("{factory_id}: the engineer decides"),
                story::decide(connector, factory_id, &decisions),
            )
            .await?;
    }
    steps.run("values reach the buyer", story::values_flow(&platform, &decisions)).await?;
    let mut connectors = connectors.into_iter();
    let (Some(munich), Some(hamburg)) = (connectors.next(), connectors.next()) else {
        anyhow::bail!("both connectors were started above");
    };
    Ok(Cast { platform, munich, hamburg })
}
