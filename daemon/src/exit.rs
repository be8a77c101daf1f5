//! Exit of a program after an error: message on standard error, and exit code.

use std::{
    error::Error,
    io::{self, Write as _},
    iter,
    process::ExitCode,
};

use crate::lifecycle::LifecycleError;

/// Prints an error with all its causes and returns the exit code. A closed standard output is no
/// error: programs like `head` close it when they have read enough.
pub fn after(program: &str, error: &(dyn Error + 'static)) -> ExitCode {
    let of_daemon = causes(error).find_map(|cause| cause.downcast_ref::<LifecycleError>());
    if of_daemon.is_none() && is_output_closed(error) {
        return ExitCode::SUCCESS;
    }
    let messages: Vec<String> = causes(error).map(ToString::to_string).collect();
    drop(writeln!(io::stderr(), "{program}: {}", messages.join(": ")));
    of_daemon.map_or(ExitCode::FAILURE, LifecycleError::exit_code)
}

fn is_output_closed(error: &(dyn Error + 'static)) -> bool {
    let is_broken_pipe = |cause: &io::Error| cause.kind() == io::ErrorKind::BrokenPipe;
    causes(error).any(|cause| cause.downcast_ref().is_some_and(is_broken_pipe))
}

fn causes<'e>(error: &'e (dyn Error + 'static)) -> impl Iterator<Item = &'e (dyn Error + 'static)> {
    iter::successors(Some(error), |error| (*error).source())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, thiserror::Error)]
    #[error("writing to standard output")]
    struct Writing(#[source] io::Error);

    #[test]
    fn a_closed_output_is_no_error() {
        assert!(is_output_closed(&Writing(io::ErrorKind::BrokenPipe.into())));
        assert!(!is_output_closed(&Writing(io::ErrorKind::StorageFull.into())));
    }
}
