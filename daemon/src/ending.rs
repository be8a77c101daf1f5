//! How a program ends: what it prints about what went wrong, and its exit code.

use std::{
    error::Error,
    io::{self, Write as _},
    iter,
    process::ExitCode,
};

use crate::lifecycle::LifecycleError;

/// Prints an error with all its causes and says with which code the program ends. Who reads the
/// output may stop when it has seen enough, as `head` does: that is no error.
pub fn after(program: &str, error: &(dyn Error + 'static)) -> ExitCode {
    let of_daemon = causes(error).find_map(|cause| cause.downcast_ref::<LifecycleError>());
    if of_daemon.is_none() && is_reader_gone(error) {
        return ExitCode::SUCCESS;
    }
    let said: Vec<String> = causes(error).map(ToString::to_string).collect();
    drop(writeln!(io::stderr(), "{program}: {}", said.join(": ")));
    of_daemon.map_or(ExitCode::FAILURE, LifecycleError::exit_code)
}

fn is_reader_gone(error: &(dyn Error + 'static)) -> bool {
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
    fn a_reader_that_has_seen_enough_is_no_error() {
        assert!(is_reader_gone(&Writing(io::ErrorKind::BrokenPipe.into())));
        assert!(!is_reader_gone(&Writing(io::ErrorKind::StorageFull.into())));
    }
}
