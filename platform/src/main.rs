//! The platform's program: serve it, check its configuration, add what it needs.

mod cli;

use std::process::ExitCode;

use clap::Parser;

fn main() -> ExitCode {
    daemon::data_directory::restrict_new_files();
    // One TLS provider for the whole process, before anything could ask for the default.
    if rustls::crypto::ring::default_provider().install_default().is_err() {
        return ExitCode::FAILURE;
    }
    cli::run(cli::Arguments::parse())
}
