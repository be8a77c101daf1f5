//! Errors of a simulation.

use std::net::SocketAddr;

use asi_model::BuiltInType;

/// A machine or its server cannot do what was asked.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SimulatorError {
    /// The configuration is wrong.
    #[error("{0}")]
    Config(String),
    /// An address cannot be listened on.
    #[error("{address} cannot be listened on: {reason}")]
    Listen { address: SocketAddr, reason: String },
    /// A server cannot be started.
    #[error("the server of {machine} cannot be started: {reason}")]
    Server { machine: String, reason: String },
    /// No machine has this name.
    #[error("there is no machine {0}")]
    UnknownMachine(String),
    /// The machine has no such variable.
    #[error("the machine has no variable {0}")]
    UnknownVariable(String),
    /// The value is not of the variable's type.
    #[error("the value must be of the type {expected}")]
    WrongType { expected: BuiltInType },
    /// The fault needs the relay, which is configured away.
    #[error("this fault needs the machine's relay, which its configuration takes away")]
    NoRelay,
    /// The server does not run.
    #[error("the server of the machine does not run")]
    Down,
    /// The simulator has stopped.
    #[error("the simulator has stopped")]
    Stopped,
}
