//! Handle to a running machine.

use std::{collections::HashMap, path::PathBuf, sync::Arc};

use asi_model::{BuiltInType, DataValue, DateTime, NodeId, StatusCode, Variant};
use parking_lot::RwLock;
use tokio::sync::{mpsc, oneshot};

use crate::{MachineCondition, MachineConfig, MachineEvent, MachineFault, SimulatorError};

/// A cloneable handle to a machine.
#[derive(Clone)]
pub struct MachineHandle {
    pub(super) config: Arc<MachineConfig>,
    pub(super) endpoint_url: String,
    pub(super) commands: mpsc::Sender<MachineCommand>,
    pub(super) node_ids: Arc<RwLock<HashMap<String, NodeId>>>,
    pub(super) pki_directory: PathBuf,
}

/// MachineCommand to a machine, with the channel for its reply.
pub(super) enum MachineCommand {
    Set {
        key: String,
        value: Variant,
        status: StatusCode,
        reply: oneshot::Sender<Result<DateTime, SimulatorError>>,
    },
    Release {
        key: String,
        reply: oneshot::Sender<Result<(), SimulatorError>>,
    },
    Values {
        reply: oneshot::Sender<Vec<(String, BuiltInType, DataValue)>>,
    },
    Raise {
        event: MachineEvent,
        reply: oneshot::Sender<Result<DateTime, SimulatorError>>,
    },
    SetCondition {
        name: String,
        condition: MachineCondition,
        reply: oneshot::Sender<DateTime>,
    },
    Inject {
        fault: MachineFault,
        reply: oneshot::Sender<Result<(), SimulatorError>>,
    },
}

impl MachineHandle {
    /// The machine's name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.config.name
    }

    /// Returns the configuration of the machine.
    #[must_use]
    pub fn config(&self) -> &MachineConfig {
        &self.config
    }

    /// Returns the address that clients connect to.
    #[must_use]
    pub fn endpoint_url(&self) -> &str {
        &self.endpoint_url
    }

    /// The present identity of a variable, by its key as `Spindle.Temperature`.
    #[must_use]
    pub fn node_id(&self, key: &str) -> Option<NodeId> {
        self.node_ids.read().get(key).cloned()
    }

    /// The keys of all variables.
    #[must_use]
    pub fn keys(&self) -> Vec<String> {
        let mut keys: Vec<_> = self.node_ids.read().keys().cloned().collect();
        keys.sort();
        keys
    }

    /// Sets a variable at once and holds it there; returns its source time.
    ///
    /// # Errors
    /// [`SimulatorError`] when there is no such variable, the type differs, or the server does not
    /// run.
    pub async fn set(
        &self,
        key: &str,
        value: impl Into<Variant>,
    ) -> Result<DateTime, SimulatorError> {
        self.set_with_status(key, value, StatusCode::GOOD).await
    }

    /// Sets like [`Self::set`], with a status.
    ///
    /// # Errors
    /// As [`Self::set`].
    pub async fn set_with_status(
        &self,
        key: &str,
        value: impl Into<Variant>,
        status: StatusCode,
    ) -> Result<DateTime, SimulatorError> {
        let (key, value) = (key.to_owned(), value.into());
        self.ask(|reply| MachineCommand::Set { key, value, status, reply }).await?
    }

    /// Lets a variable run by itself again.
    ///
    /// # Errors
    /// [`SimulatorError::UnknownVariable`].
    pub async fn release(&self, key: &str) -> Result<(), SimulatorError> {
        let key = key.to_owned();
        self.ask(|reply| MachineCommand::Release { key, reply }).await?
    }

    /// All variables with their types and values, by key.
    ///
    /// # Errors
    /// [`SimulatorError::Stopped`].
    pub async fn values(&self) -> Result<Vec<(String, BuiltInType, DataValue)>, SimulatorError> {
        self.ask(|reply| MachineCommand::Values { reply }).await
    }

    /// Raises an event; returns its time.
    ///
    /// # Errors
    /// [`SimulatorError::Down`] while the server does not run.
    pub async fn raise(&self, message: &str, severity: u16) -> Result<DateTime, SimulatorError> {
        let event = MachineEvent { message: message.to_owned(), severity };
        self.ask(|reply| MachineCommand::Raise { event, reply }).await?
    }

    /// Sets the state of a condition, also while the server does not run; returns the time.
    ///
    /// # Errors
    /// [`SimulatorError::Stopped`].
    pub async fn set_condition(
        &self,
        name: &str,
        condition: MachineCondition,
    ) -> Result<DateTime, SimulatorError> {
        let name = name.to_owned();
        self.ask(|reply| MachineCommand::SetCondition { name, condition, reply }).await
    }

    /// Makes the machine fail, or heals it. Ends when the fault is in effect; a restart when the
    /// server is back.
    ///
    /// # Errors
    /// [`SimulatorError`] when the fault needs a relay or a variable that is not there.
    pub async fn inject(&self, fault: MachineFault) -> Result<(), SimulatorError> {
        self.ask(|reply| MachineCommand::Inject { fault, reply }).await?
    }

    /// Trusts all clients whose certificates were rejected so far.
    ///
    /// # Errors
    /// The error of the file system.
    pub fn trust_rejected_clients(&self) -> std::io::Result<()> {
        let (rejected, trusted) =
            (self.pki_directory.join("rejected"), self.pki_directory.join("trusted"));
        for entry in std::fs::read_dir(&rejected)? {
            let entry = entry?;
            std::fs::rename(entry.path(), trusted.join(entry.file_name()))?;
        }
        Ok(())
    }

    async fn ask<T>(
        &self,
        command: impl FnOnce(oneshot::Sender<T>) -> MachineCommand,
    ) -> Result<T, SimulatorError> {
        let (reply, answer) = oneshot::channel();
        self.commands.send(command(reply)).await.map_err(|_| SimulatorError::Stopped)?;
        answer.await.map_err(|_| SimulatorError::Stopped)
    }
}
