//! Simulation: all machines and the control interface.

use indexmap::IndexMap;
use tokio::{net::TcpListener, task::JoinSet};
use tokio_util::sync::CancellationToken;

use crate::{Config, SimulatorError, SimulatorHandle, clock, control, host::Host};

/// Simulation whose servers already listen.
pub struct Simulator {
    hosts: Vec<Host>,
    control: Option<TcpListener>,
    handle: SimulatorHandle,
}

impl Simulator {
    /// Binds all addresses and starts all servers. Values begin to change with [`Self::run`].
    ///
    /// # Errors
    /// [`SimulatorError`] when the configuration is wrong, an address is taken or a server cannot
    /// be made.
    pub async fn new(config: Config) -> Result<(Self, SimulatorHandle), SimulatorError> {
        config.check().map_err(|error| SimulatorError::Config(error.to_string()))?;
        let epoch = config.epoch().ok().flatten().unwrap_or_else(clock::now);
        let control =
            match config.control {
                Some(address) => Some(TcpListener::bind(address).await.map_err(|error| {
                    SimulatorError::Listen { address, reason: error.to_string() }
                })?),
                None => None,
            };
        let mut hosts = Vec::new();
        let mut machines = IndexMap::new();
        for machine in &config.machines {
            let (host, handle) = Host::start(&config, machine.clone(), epoch).await?;
            hosts.push(host);
            machines.insert(machine.name.clone(), handle);
        }
        let handle = SimulatorHandle::new(machines);
        Ok((Self { hosts, control, handle: handle.clone() }, handle))
    }

    /// Runs until `shutdown` is cancelled.
    pub async fn run(self, shutdown: CancellationToken) {
        let mut tasks = JoinSet::new();
        for host in self.hosts {
            tasks.spawn(host.run(shutdown.clone()));
        }
        if let Some(listener) = self.control {
            let app = control::router(self.handle);
            let stop = shutdown.clone().cancelled_owned();
            tasks.spawn(async move {
                if let Err(error) = axum::serve(listener, app).with_graceful_shutdown(stop).await {
                    tracing::error!(%error, "The control interface ended.");
                }
            });
        }
        while let Some(ended) = tasks.join_next().await {
            if let Err(error) = ended {
                tracing::error!(%error, "A machine ended in a panic.");
            }
        }
    }
}
