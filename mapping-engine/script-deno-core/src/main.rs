//! The script worker with V8 inside, by `deno_core`.
//!
//! Speaks the same protocol as `script-quickjs`. Scripts share one isolate and have a context each,
//! so memory is bounded for all together: when it runs out, the isolate is replaced and every
//! script continues from its state.

mod engine;
mod fault;
mod timer;
mod values;

use std::process::ExitCode;

use engine::Deno;

#[allow(clippy::print_stderr)]
fn main() -> ExitCode {
    let confined = script_protocol::worker::confine();
    // Before the rest of the sandbox: the platform may start threads.
    deno_core::JsRuntime::init_platform(None);
    let timer = match timer::Timer::start() {
        Ok(timer) => timer,
        Err(error) => {
            eprintln!("{error}");
            return ExitCode::FAILURE;
        }
    };
    match script_protocol::worker::serve(&confined, |limits| Deno::new(*limits, timer)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}
