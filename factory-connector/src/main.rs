//! The factory connector's program.

mod cli;

use std::process::ExitCode;

use clap::Parser;

/// Many small things that live long: the system's allocator leaves more room between them.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> ExitCode {
    daemon::data_directory::restrict_new_files();
    // One TLS provider for the whole process, before anything could ask for the default.
    if rustls::crypto::ring::default_provider().install_default().is_err() {
        return ExitCode::FAILURE;
    }
    cli::run(cli::Arguments::parse())
}
