//! Tasks of a running connector. All are essential: the first that ends early stops the others.

use connector_state::EngineCommand;
use daemon::lifecycle::{Importance, Lifecycle};
use mapping_engine::{MappingEngine, MappingEngineHandle};
use messaging::Link;
use shop_floor::ShopFloor;
use tokio::sync::mpsc;
use twin::Twin;

use super::{broker_login::BrokerLogin, mappings, recorded_values::RecordedValues};
use crate::{
    catalog::Catalog, coordinator::Coordinator, lease::LeaseClient, twin_adapter::UserWatch,
};

/// Opened parts of a connector that run as tasks, with the channels between them.
pub(super) struct Tasks {
    pub(super) coordinator: Coordinator,
    pub(super) twin: Twin,
    pub(super) user_watch: UserWatch,
    pub(super) floor: ShopFloor,
    pub(super) catalog: Catalog,
    pub(super) engine: MappingEngine,
    pub(super) engine_handle: MappingEngineHandle,
    /// Commands for the mapping engine, in the order of the decisions.
    pub(super) mapping_work: mpsc::Receiver<Vec<EngineCommand>>,
    pub(super) recorded_values: RecordedValues,
    pub(super) lease_client: LeaseClient,
    pub(super) broker_login: BrokerLogin,
    pub(super) link: Link,
}

impl Tasks {
    /// Spawns the tasks, which end at the lifecycle's shutdown.
    pub(super) fn spawn(self, lifecycle: &Lifecycle) {
        let Self {
            coordinator,
            twin,
            user_watch,
            floor,
            catalog,
            engine,
            engine_handle,
            mapping_work,
            recorded_values,
            lease_client,
            broker_login,
            link,
        } = self;
        let token = lifecycle.shutdown();
        lifecycle.spawn("coordinator", Importance::Essential, async move {
            coordinator.run(token).await.map_err(anyhow::Error::from)
        });
        let token = lifecycle.shutdown();
        lifecycle.spawn("twin", Importance::Essential, async move {
            twin.run(token).await.map_err(anyhow::Error::from)
        });
        let token = lifecycle.shutdown();
        lifecycle.spawn("user watch", Importance::Essential, async move {
            user_watch.run(token).await;
            anyhow::Ok(())
        });
        let token = lifecycle.shutdown();
        lifecycle.spawn("shop floor", Importance::Essential, async move {
            floor.run(token).await;
            anyhow::Ok(())
        });
        let token = lifecycle.shutdown();
        lifecycle.spawn("catalog", Importance::Essential, async move {
            catalog.run(token).await;
            anyhow::Ok(())
        });
        let token = lifecycle.shutdown();
        lifecycle.spawn("mapping engine", Importance::Essential, async move {
            engine.run(token).await;
            anyhow::Ok(())
        });
        let (token, recorded) = (lifecycle.shutdown(), engine_handle.clone());
        lifecycle.spawn("recorded values", Importance::Essential, async move {
            recorded_values.run(recorded, token).await;
            anyhow::Ok(())
        });
        let token = lifecycle.shutdown();
        lifecycle.spawn("mappings", Importance::Essential, async move {
            mappings::publish(mapping_work, engine_handle, token).await;
            anyhow::Ok(())
        });
        let token = lifecycle.shutdown();
        lifecycle.spawn("lease", Importance::Essential, async move {
            lease_client.run(token).await;
            anyhow::Ok(())
        });
        let token = lifecycle.shutdown();
        lifecycle.spawn("broker login", Importance::Essential, async move {
            broker_login.run(token).await;
            anyhow::Ok(())
        });
        let token = lifecycle.shutdown();
        lifecycle.spawn("link", Importance::Essential, async move {
            link.run(token).await;
            anyhow::Ok(())
        });
    }
}
