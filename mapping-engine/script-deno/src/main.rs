//! The script worker with V8: gives itself walls and becomes Deno, which runs the worker's program (`src/worker`).
//!
//! Started by the mapping engine with the Deno executable as its parameter. Each script has a context of its own, all share
//! one heap: at a limit of time or memory the process ends, says at which call, and is started again.

mod command;

use std::{
    env,
    fs::File,
    io,
    os::{fd::AsFd as _, unix::process::CommandExt as _},
    path::PathBuf,
    process::ExitCode,
};

use anyhow::{Context as _, bail};
use script_protocol::{
    HostMessage, Landlock, PROTOCOL_VERSION, Sandbox, ScriptLimits, WorkerMessage, frame,
    worker::hand_over,
};

#[allow(clippy::print_stderr)]
fn main() -> ExitCode {
    match serve() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            // The host reads this stream: no script has run yet.
            eprintln!("{error:#}");
            ExitCode::FAILURE
        }
    }
}

/// Returns only where the process does not become Deno.
fn serve() -> anyhow::Result<()> {
    let Some(deno) = env::args_os().nth(1).map(PathBuf::from) else {
        bail!("script-deno takes the Deno executable as its parameter");
    };
    let Some(limits) = greeted()? else { return Ok(()) };
    // As Deno: this copy of its executable must not change in between, and symbolic links are no way past the walls.
    let deno = deno
        .canonicalize()
        .with_context(|| format!("there is no Deno that may be run at {}", deno.display()))?;
    let handover = hand_over(&deno, &limits).context("the bounds of the worker cannot be set")?;
    let error = command::worker(&deno, &limits, &handover).exec();
    Err::<(), _>(error).with_context(|| {
        format!("{} is not run: let others read and run it and its folders", deno.display())
    })
}

/// Reads the greeting. A host of another version of the protocol is answered with ours, and gets no worker.
fn greeted() -> anyhow::Result<Option<ScriptLimits>> {
    // Unbuffered: what follows the greeting is for Deno.
    let mut input = File::from(io::stdin().as_fd().try_clone_to_owned()?);
    let Some(body) = frame::read(&mut input)? else { return Ok(None) };
    match HostMessage::decode(&body)? {
        HostMessage::Hello { version: PROTOCOL_VERSION, limits } => Ok(Some(limits)),
        HostMessage::Hello { .. } => {
            let sandbox = Sandbox {
                is_filtered: false,
                landlock: Landlock::None,
                user_id: u32::MAX,
                has_limits: false,
            };
            let version = PROTOCOL_VERSION;
            let welcome = WorkerMessage::Welcome { version, engine: "Deno".into(), sandbox };
            frame::write(&mut io::stdout(), &welcome.encode())?;
            Ok(None)
        }
        _ => bail!("the host did not say hello"),
    }
}
