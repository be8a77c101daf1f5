//! Protocol between a script worker process and the process that started it, over standard input
//! and output.
//!
//! Frames are a length and a body ([`frame`]), bodies are messages ([`message`]) in a compact
//! binary form of our own ([`codec`]) that keeps 64-bit integers exact and is bounded wherever the
//! other side decides: a worker runs foreign scripts in a C engine, so its parent trusts it no more
//! than a peer on the network.
//!
//! Nothing here knows of mappings: a script has an id, named inputs, a state and is called with a
//! value.
//!
//! With the feature `worker` there is the worker's side too: its loop, the watchdog that ends a
//! call nothing else can end, and the sandbox.

pub mod codec;
pub mod frame;
pub mod message;
pub mod sandbox;
pub mod value;
#[cfg(feature = "worker")]
pub mod worker;

pub use message::{
    Call, CallResult, CallValue, FaultKind, HostMessage, InputValue, Load, ScriptFault, ScriptId,
    ScriptLimits, Spoken, WorkerMessage, Yielded,
};
pub use sandbox::{Landlock, Sandbox};
pub use value::ScriptValue;

/// The version of the protocol. Both sides must have the same; they are shipped together.
pub const PROTOCOL_VERSION: u16 = 2;
