//! The script worker with QuickJS-ng: a process that runs scripts and nothing else.
//!
//! Started by the mapping engine, which speaks the script protocol on its standard streams. Each
//! script has a runtime and a context of its own: memory limits of the engine hold per runtime, and
//! a script that exhausts its own must not starve another.

mod engine;
mod fault;
mod guard;
mod script;
mod values;

use std::process::ExitCode;

use engine::QuickJs;

#[allow(clippy::print_stderr)]
fn main() -> ExitCode {
    let confined = script_protocol::worker::confine();
    match script_protocol::worker::serve(&confined, QuickJs::new) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            // The host reads this stream and logs it.
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}
