//! Simulated machines: real OPC UA servers for the demo, the tests and the benchmarks.
//!
//! - [`machines`] describe what a machine shows and how its values run. Each value is a pure
//!   function of seed, machine and simulated time, so a run can be repeated.
//! - Values are pushed when they change; nothing is sampled.
//! - Machines raise events and have conditions on command, and some variables have a history.
//! - Machines fail on command, see [`MachineFault`]: through [`MachineHandle`] or the HTTP control
//!   interface ([`control`]).
//!
//! In tests: [`Simulator::new`] with port 0, [`SimulatorHandle::machine`],
//! [`MachineHandle::endpoint_url`].

pub mod blueprint;
mod clock;
mod config;
pub mod control;
mod error;
mod event;
mod fault;
mod handle;
mod host;
pub mod machines;
pub mod orders;
mod records;
mod relay;
mod server;
pub mod signals;
mod simulator;

pub use config::{
    Config, ConfigError, EXAMPLE, MachineConfig, MachineKind, SecurityConfig, UserConfig,
};
pub use error::SimulatorError;
pub use event::{MachineCondition, MachineEvent};
pub use fault::{Layout, MachineFault};
pub use handle::SimulatorHandle;
pub use host::MachineHandle;
pub use orders::{FailureConfig, OrdersConfig};
pub use simulator::Simulator;
