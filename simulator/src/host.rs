//! A machine: it runs by itself, shows what it does through its server, and fails on command.

mod engine;
mod handle;

use std::{
    collections::HashMap,
    net::SocketAddr,
    path::PathBuf,
    sync::Arc,
    time::{Duration, Instant},
};

use asi_model::{DataValue, DateTime, NodeId, StatusCode, Variant, values::BuiltInType};
use parking_lot::RwLock;
use tokio::{
    net::TcpListener,
    sync::{mpsc, oneshot},
};
use tokio_util::sync::CancellationToken;

use crate::{
    Config, Layout, MachineCondition, MachineConfig, MachineEvent, MachineFault, SimulatorError,
    blueprint::Blueprint, machines, records::MachineRecords, relay::Relay, server::MachineServer,
};

use engine::Engine;
use handle::MachineCommand;

pub use handle::MachineHandle;

/// Commands that may wait for a machine.
const COMMANDS_MAX: usize = 64;

/// A machine before it runs.
pub(crate) struct Host {
    config: Arc<MachineConfig>,
    blueprint: Arc<Blueprint>,
    engine: Engine,
    update_interval: Duration,
    pki_directory: PathBuf,
    host: std::net::IpAddr,
    public_port: u16,
    /// Listener for clients; a clone of it is served.
    listener: std::net::TcpListener,
    relay: Option<Arc<Relay>>,
    server: Option<MachineServer>,
    layout: Layout,
    back_at: Option<(Instant, oneshot::Sender<Result<(), SimulatorError>>)>,
    commands: mpsc::Receiver<MachineCommand>,
    node_ids: Arc<RwLock<HashMap<String, NodeId>>>,
    records: Arc<MachineRecords>,
}

impl Host {
    /// Binds the machine's address and starts its server.
    pub(crate) async fn start(
        simulation: &Config,
        config: MachineConfig,
        epoch: DateTime,
    ) -> Result<(Self, MachineHandle), SimulatorError> {
        let address = SocketAddr::new(simulation.host, config.port);
        let listen =
            |error: std::io::Error| SimulatorError::Listen { address, reason: error.to_string() };
        let listener =
            TcpListener::bind(address).await.map_err(listen)?.into_std().map_err(listen)?;
        let public_port = listener.local_addr().map_err(listen)?.port();
        let config = Arc::new(config);
        let blueprint = Arc::new(machines::blueprint(&config));
        let (sender, commands) = mpsc::channel(COMMANDS_MAX);
        let node_ids = Arc::new(RwLock::new(HashMap::new()));
        let handle = MachineHandle {
            config: Arc::clone(&config),
            endpoint_url: format!("opc.tcp://{}", SocketAddr::new(simulation.host, public_port)),
            commands: sender,
            node_ids: Arc::clone(&node_ids),
            pki_directory: simulation.pki_directory.join(&config.name),
        };
        let mut host = Self {
            engine: Engine::new(
                &config,
                Arc::clone(&blueprint),
                simulation.seed,
                simulation.speed,
                epoch,
            ),
            relay: config.relay.then(Relay::new),
            config,
            blueprint,
            update_interval: simulation.update_interval(),
            pki_directory: simulation.pki_directory.clone(),
            host: simulation.host,
            public_port,
            listener,
            server: None,
            layout: Layout::default(),
            back_at: None,
            commands,
            node_ids,
            records: Arc::default(),
        };
        host.start_server().await?;
        Ok((host, handle))
    }

    /// Runs until told to stop.
    pub(crate) async fn run(mut self, shutdown: CancellationToken) {
        if let Some(relay) = self.relay.clone() {
            match self.public_listener() {
                Ok(listener) => {
                    tokio::spawn(relay.run(listener, shutdown.clone()));
                }
                Err(error) => {
                    tracing::error!(machine = %self.config.name, %error, "A machine cannot be reached.");
                    return;
                }
            }
        }
        let mut tick = tokio::time::interval(self.update_interval);
        tick.set_missed_tick_behavior(tokio::time::MissedTickBehavior::Skip);
        loop {
            tokio::select! {
                biased;
                () = shutdown.cancelled() => break,
                command = self.commands.recv() => match command {
                    Some(command) => self.handle_command(command).await,
                    None => break,
                },
                _ = tick.tick() => self.tick().await,
            }
        }
        self.stop_server().await;
    }

    async fn tick(&mut self) {
        if self.back_at.as_ref().is_some_and(|(at, _)| *at <= Instant::now())
            && let Some((_, reply)) = self.back_at.take()
        {
            let _ = reply.send(self.start_server().await);
        }
        if let Some(server) = &self.server {
            self.engine.update(server);
        }
    }

    async fn handle_command(&mut self, command: MachineCommand) {
        // A caller may have dropped its receiver; send errors are ignored.
        match command {
            MachineCommand::Set { key, value, status, reply } => {
                let _ = reply.send(self.set(&key, value, status));
            }
            MachineCommand::Release { key, reply } => {
                let known = self.node_ids.read().contains_key(&key);
                let _ = reply.send(if known {
                    self.engine.release(&key);
                    Ok(())
                } else {
                    Err(SimulatorError::UnknownVariable(key))
                });
            }
            MachineCommand::Values { reply } => {
                let _ = reply.send(self.values());
            }
            MachineCommand::Raise { event, reply } => {
                let _ = reply.send(self.raise(&event));
            }
            MachineCommand::SetCondition { name, condition, reply } => {
                let _ = reply.send(self.set_condition(&name, condition));
            }
            MachineCommand::Inject { fault, reply } => self.inject(fault, reply).await,
        }
    }

    fn set(
        &mut self,
        key: &str,
        value: Variant,
        status: StatusCode,
    ) -> Result<DateTime, SimulatorError> {
        let server = self.server.as_ref().ok_or(SimulatorError::Down)?;
        let expected =
            server.built_in(key).ok_or_else(|| SimulatorError::UnknownVariable(key.to_owned()))?;
        if value.built_in_type().is_some_and(|found| found != expected) {
            return Err(SimulatorError::WrongType { expected });
        }
        let value = self.engine.hold(key, value, status);
        let source_timestamp = value.source_timestamp.unwrap_or_default();
        server.publish([(key, value)]);
        Ok(source_timestamp)
    }

    fn raise(&self, event: &MachineEvent) -> Result<DateTime, SimulatorError> {
        let at = self.engine.time();
        self.server.as_ref().ok_or(SimulatorError::Down)?.raise(event, at);
        Ok(at)
    }

    fn set_condition(&self, name: &str, condition: MachineCondition) -> DateTime {
        let at = self.engine.time();
        // Recorded first: a refresh between both must name the new state.
        self.records.set_condition(name, condition.clone(), at);
        if let Some(server) = &self.server {
            server.show_condition(name, &condition, at);
        }
        at
    }

    fn values(&self) -> Vec<(String, BuiltInType, DataValue)> {
        let Some(server) = &self.server else { return Vec::new() };
        let mut keys: Vec<String> = self.node_ids.read().keys().cloned().collect();
        keys.sort();
        keys.into_iter()
            .filter_map(|key| {
                let (built_in, value) = (server.built_in(&key)?, server.value(&key)?);
                Some((key, built_in, value))
            })
            .collect()
    }

    async fn inject(
        &mut self,
        fault: MachineFault,
        reply: oneshot::Sender<Result<(), SimulatorError>>,
    ) {
        tracing::info!(machine = %self.config.name, ?fault, "A fault is injected.");
        let result = match fault {
            MachineFault::None => self.heal().await,
            MachineFault::DropConnections => self.with_relay(Relay::drop_connections),
            MachineFault::HangNetwork => self.with_relay(|relay| relay.set_hanging(true)),
            MachineFault::StopUpdating => {
                self.engine.stand_still(true);
                Ok(())
            }
            MachineFault::StallSubscriptions => match &self.server {
                Some(server) => {
                    server.mute(true);
                    Ok(())
                }
                None => Err(SimulatorError::Down),
            },
            MachineFault::BadStatus { variable: Some(key), .. }
                if !self.node_ids.read().contains_key(&key) =>
            {
                Err(SimulatorError::UnknownVariable(key))
            }
            MachineFault::BadStatus { status, variable } => {
                self.engine.have_status(variable, StatusCode(status));
                self.tick().await;
                Ok(())
            }
            MachineFault::WrongClock { ahead_ms } => {
                self.engine.set_clock(ahead_ms);
                self.tick().await;
                Ok(())
            }
            MachineFault::Kill => {
                self.stop_server().await;
                Ok(())
            }
            MachineFault::Restart { layout, down_ms } => {
                self.stop_server().await;
                self.layout = layout;
                self.back_at = Some((Instant::now() + Duration::from_millis(down_ms), reply));
                self.tick().await;
                return;
            }
        };
        let _ = reply.send(result);
    }

    async fn heal(&mut self) -> Result<(), SimulatorError> {
        self.engine.heal();
        if let Some(relay) = &self.relay {
            relay.set_hanging(false);
        }
        match &self.server {
            Some(server) => server.mute(false),
            None => {
                self.back_at = None;
                self.start_server().await?;
            }
        }
        self.tick().await;
        Ok(())
    }

    fn with_relay(&self, act: impl FnOnce(&Relay)) -> Result<(), SimulatorError> {
        act(self.relay.as_ref().ok_or(SimulatorError::NoRelay)?);
        Ok(())
    }

    fn public_listener(&self) -> std::io::Result<TcpListener> {
        TcpListener::from_std(self.listener.try_clone()?)
    }

    async fn start_server(&mut self) -> Result<(), SimulatorError> {
        let fail = |error: std::io::Error| SimulatorError::Server {
            machine: self.config.name.clone(),
            reason: error.to_string(),
        };
        let listener = match &self.relay {
            Some(_) => TcpListener::bind(SocketAddr::new(self.host, 0)).await,
            None => self.public_listener(),
        };
        let server = MachineServer::start(
            &self.config,
            &self.blueprint,
            self.layout,
            listener.map_err(fail)?,
            self.public_port,
            &self.pki_directory,
            Arc::clone(&self.records),
        )
        .await?;
        *self.node_ids.write() = server.node_ids();
        self.engine.forget();
        self.engine.update(&server);
        if let Some(relay) = &self.relay {
            relay.set_target(Some(server.address()));
        }
        self.server = Some(server);
        Ok(())
    }

    async fn stop_server(&mut self) {
        // The network is cut first, so that no client receives a CloseSession response.
        if let Some(relay) = &self.relay {
            relay.set_target(None);
            relay.drop_connections();
        }
        if let Some(server) = self.server.take() {
            server.stop().await;
        }
    }
}
