//! The worker's side: read, call, answer - and end what nothing else ends.
//!
//! A worker binary brings a [`ScriptEngine`] and calls [`serve`]. Single-threaded but for the
//! watchdog.

mod clock;
pub mod fault;
mod loaded;
mod prelude;
pub mod result;
mod sandbox;
mod watchdog;

use std::{
    fs::File,
    io::{self, BufReader},
    os::fd::AsFd,
    sync::Arc,
    time::Instant,
};

use crate::{
    Call, CallResult, HostMessage, Load, PROTOCOL_VERSION, ScriptFault, ScriptId, ScriptLimits,
    WorkerMessage, Yielded, frame,
};
pub use clock::{process_time, thread_time};
pub use loaded::LoadedScript;
pub use prelude::PRELUDE;
pub use sandbox::{Confined, Handover, confine, hand_over};
use watchdog::Watchdog;

/// A JavaScript engine behind the protocol. One instance serves many scripts; each is apart from
/// the others in memory, globals and faults.
pub trait ScriptEngine {
    /// Name and version, as `quickjs-ng 0.16`.
    fn name(&self) -> String;

    /// Loads a script in place of the one with the same id.
    ///
    /// # Errors
    /// [`ScriptFault`] where it does not compile, throws, takes too long or is no function.
    fn load(&mut self, load: Load) -> Result<(), ScriptFault>;

    fn unload(&mut self, script: ScriptId);

    /// Calls a script. The second value is `ctx.state` where it changed.
    fn call(&mut self, call: Call) -> (Result<Yielded, ScriptFault>, Option<Arc<str>>);
}

/// Serves the host on standard input and output until it closes them.
///
/// # Errors
/// Those of the streams and of the sandbox; `InvalidData` for what is no message.
pub fn serve<E: ScriptEngine>(
    confined: &Confined,
    create: impl FnOnce(&ScriptLimits) -> E,
) -> io::Result<()> {
    // Unbuffered: whole frames are written at once.
    let output = File::from(io::stdout().as_fd().try_clone_to_owned()?);
    let mut input =
        BufReader::with_capacity(1 << 16, File::from(io::stdin().as_fd().try_clone_to_owned()?));
    let Some(HostMessage::Hello { version, limits }) = receive(&mut input)? else {
        return Err(io::Error::new(io::ErrorKind::InvalidData, "the host did not say hello"));
    };
    let watchdog = Watchdog::start(output, &limits)?;
    let sandbox = sandbox::enter(&limits, confined)?;
    let mut engine = create(&limits);
    watchdog.say(&WorkerMessage::Welcome {
        version: PROTOCOL_VERSION,
        engine: engine.name().into(),
        sandbox,
    })?;
    if version != PROTOCOL_VERSION {
        // The host sees our version and knows.
        return Ok(());
    }
    while let Some(message) = receive(&mut input)? {
        match message {
            HostMessage::Hello { .. } => {
                return Err(io::Error::new(
                    io::ErrorKind::InvalidData,
                    "the host said hello twice",
                ));
            }
            HostMessage::Load(load) => {
                let script = load.script;
                let fault = watchdog.loading(script, || engine.load(load)).err();
                watchdog.say(&WorkerMessage::Loaded { script, fault })?;
            }
            HostMessage::Unload(script) => engine.unload(script),
            HostMessage::Batch(calls) => run(&mut engine, &watchdog, &limits, calls)?,
        }
    }
    Ok(())
}

fn run<E: ScriptEngine>(
    engine: &mut E,
    watchdog: &Watchdog,
    limits: &ScriptLimits,
    calls: Vec<Call>,
) -> io::Result<()> {
    let begun = Instant::now();
    let mut last = begun;
    for call in calls {
        let (outcome, state) = watchdog.calling(|| engine.call(call));
        let now = Instant::now();
        let spent = now - last;
        last = now;
        watchdog.push(CallResult { outcome, state, spent });
        if now - begun > limits.batch_budget {
            break;
        }
    }
    watchdog.say_results()
}

fn receive(input: &mut impl io::Read) -> io::Result<Option<HostMessage>> {
    let Some(body) = frame::read(input)? else { return Ok(None) };
    HostMessage::decode(&body)
        .map(Some)
        .map_err(|error| io::Error::new(io::ErrorKind::InvalidData, error))
}
