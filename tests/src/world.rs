//! Two factories and a cloud: every program that takes part in the frame order, in one folder, on
//! ports of its own.

mod accounts;
mod copies;
pub(crate) mod counters;
mod external_broker;
mod files;
mod places;

use std::{path::Path, time::Duration};

pub use accounts::{ADMIN, ENGINEER, OBSERVER, OBSERVER_PASSWORD, PASSWORD};
use anyhow::Context as _;
pub use external_broker::{BrokerKind, ExternalBroker, TOOL};
pub use places::{FactoryPlaces, Places};

use crate::{
    frame_order::{HAMBURG, MUNICH},
    harness::{Api, Daemon, DaemonCommand, binary, eventually},
};

/// One factory: its machines and its connector.
#[derive(Debug)]
pub struct Factory {
    pub id: &'static str,
    pub simulator: Daemon,
    /// The connector, once it is enrolled and started.
    pub connector: Option<Daemon>,
}

/// Everything that runs.
#[derive(Debug)]
pub struct World {
    /// Folder and ports of all programs.
    pub places: Places,
    pub platform: Daemon,
    /// The broker, where it is not the platform's own.
    pub external: Option<ExternalBroker>,
    /// Munich and Hamburg.
    pub factories: [Factory; 2],
}

fn daemon(name: &str, program: &str, arguments: &[&str], folder: &Path) -> anyhow::Result<Daemon> {
    Daemon::start(DaemonCommand {
        name: name.to_owned(),
        program: binary(program)?,
        arguments: arguments.iter().map(|&a| a.to_owned()).collect(),
        environment: Vec::new(),
        log: folder.join(format!("{name}.log")),
    })
}

impl World {
    /// Writes the configuration where there is none, and starts the cloud and the machines.
    ///
    /// # Errors
    /// When a file cannot be written or a program was not built or does not start.
    pub fn start(places: Places) -> anyhow::Result<Self> {
        Self::start_beside(places, None)
    }

    /// Starts everything beside a broker of another make, if there is one.
    ///
    /// # Errors
    /// As [`Self::start`].
    pub fn start_beside(places: Places, external: Option<ExternalBroker>) -> anyhow::Result<Self> {
        files::write_all(&places, external.as_ref())?;
        let folder = places.folder.clone();
        let config = |name: &str| folder.join(name).display().to_string();
        let platform = daemon(
            "platform",
            "platform",
            &["serve", "--config", &config("platform.toml")],
            &folder,
        )?;
        let start_factory = |id: &'static str| -> anyhow::Result<Factory> {
            let simulator = daemon(
                &format!("machines-{id}"),
                "simulator",
                &["--config", &config(&format!("machines-{id}.toml"))],
                &folder,
            )?;
            Ok(Factory { id, simulator, connector: None })
        };
        let factories = [start_factory(MUNICH)?, start_factory(HAMBURG)?];
        Ok(Self { platform, external, factories, places })
    }

    /// Returns the platform's API, signed in as administrator, once it answers.
    ///
    /// # Errors
    /// When it does not become ready.
    pub async fn platform_api(&mut self) -> anyhow::Result<Api> {
        let mut api = Api::new(format!("http://127.0.0.1:{}", self.places.platform_web))?;
        ready(&api, &mut self.platform).await?;
        api.sign_in(ADMIN, PASSWORD).await?;
        Ok(api)
    }

    /// Enrols a factory's connector with a token, unless it is enrolled already, and starts it.
    ///
    /// # Errors
    /// When the platform refuses the token or the connector does not start.
    pub async fn start_connector(
        &mut self,
        factory_id: &str,
        token: Option<&str>,
    ) -> anyhow::Result<()> {
        let folder = self.places.folder.clone();
        let config = folder.join(format!("connector-{factory_id}.toml")).display().to_string();
        let name = format!("connector-{factory_id}");
        if let Some(token) = token {
            let token_file = folder.join(format!("token-{factory_id}"));
            std::fs::write(&token_file, token)?;
            let mut enrol = daemon(
                &format!("enrol-{factory_id}"),
                "factory-connector",
                &[
                    "enrol",
                    "--token-file",
                    &token_file.display().to_string(),
                    "--platform",
                    &format!("http://127.0.0.1:{}", self.places.platform_web),
                    "--config",
                    &config,
                ],
                &folder,
            )?;
            let status = eventually("enrolling", Duration::from_secs(20), || {
                let ended = enrol.ended();
                async move {
                    ended.map_err(|e| e.to_string())?.ok_or_else(|| "still running".to_owned())
                }
            })
            .await?;
            anyhow::ensure!(
                status.success(),
                "enrolling {factory_id} failed:\n{}",
                enrol.log_tail(20)
            );
        }
        let connector = daemon(&name, "factory-connector", &["run", "--config", &config], &folder)?;
        self.factory(factory_id)?.connector = Some(connector);
        Ok(())
    }

    /// Returns a connector's API, signed in as engineer, once it answers.
    ///
    /// # Errors
    /// When it does not become ready.
    pub async fn connector_api(&mut self, factory_id: &str) -> anyhow::Result<Api> {
        let port = self.places.factory(factory_id)?.connector_web;
        let mut api = Api::new(format!("http://127.0.0.1:{port}"))?;
        let connector =
            self.factory(factory_id)?.connector.as_mut().context("the connector is not started")?;
        ready(&api, connector).await?;
        api.sign_in(ENGINEER, PASSWORD).await?;
        Ok(api)
    }

    /// Returns the control interface of a factory's simulator, which needs no sign-in.
    ///
    /// # Errors
    /// When the factory is not part of this world.
    pub fn machines_api(&self, factory_id: &str) -> anyhow::Result<Api> {
        Api::new(format!("http://127.0.0.1:{}", self.places.factory(factory_id)?.machines_control))
    }

    /// Stops the platform and runs its broker alone, with the same users and queues.
    ///
    /// # Errors
    /// When the platform does not stop or the broker does not start.
    pub fn broker_alone(&mut self) -> anyhow::Result<Daemon> {
        self.platform.stop(Duration::from_secs(15))?;
        let config = self.places.folder.join("platform.toml").display().to_string();
        daemon("broker", "platform", &["broker", "--config", &config], &self.places.folder)
    }

    /// Returns one of the two factories.
    ///
    /// # Errors
    /// When there is no such factory.
    pub fn factory(&mut self, factory_id: &str) -> anyhow::Result<&mut Factory> {
        self.factories
            .iter_mut()
            .find(|factory| factory.id == factory_id)
            .with_context(|| format!("there is no factory {factory_id}"))
    }

    /// Returns every running program, the connectors first: the order in which to stop them.
    pub fn daemons(&mut self) -> impl Iterator<Item = &mut Daemon> {
        let (mut connectors, mut machines) = (Vec::new(), Vec::new());
        for factory in &mut self.factories {
            connectors.extend(factory.connector.as_mut());
            machines.push(&mut factory.simulator);
        }
        connectors.into_iter().chain(machines).chain(std::iter::once(&mut self.platform))
    }

    /// Stops everything in good order.
    ///
    /// # Errors
    /// When a program had to be killed; the others are stopped all the same.
    pub fn stop(&mut self) -> anyhow::Result<()> {
        let mut failed = Vec::new();
        for daemon in self.daemons() {
            if let Err(error) = daemon.stop(Duration::from_secs(15)) {
                failed.push(error.to_string());
            }
        }
        anyhow::ensure!(failed.is_empty(), "{}", failed.join("; "));
        Ok(())
    }
}

/// Waits until a daemon says that it is ready; if it ends instead, the end of its log is the error.
async fn ready(api: &Api, daemon: &mut Daemon) -> anyhow::Result<()> {
    let name = daemon.name().to_owned();
    let outcome = eventually(&format!("{name} is ready"), Duration::from_secs(60), || {
        let ended = daemon.ended();
        async move {
            if let Ok(Some(status)) = ended {
                return Ok(Err(status));
            }
            api.get::<serde_json::Value>("/readyz")
                .await
                .map(|_| Ok(()))
                .map_err(|e| format!("{e:#}"))
        }
    })
    .await?;
    outcome
        .map_err(|status| anyhow::anyhow!("{name} ended with {status}:\n{}", daemon.log_tail(20)))
}
