//! One source: its task, its session while there is one, and what callers want from it.

mod audit;
mod browse;
mod connect;
mod connection;
mod entry;
mod facts;
mod feed;
mod life;
mod paths;
mod services;
mod subscriptions;

use std::{sync::Arc, time::Duration};

use asi_model::values::DateTime;
use tokio_util::sync::CancellationToken;

use crate::{SourceConfig, SourceProblem, SourceProblemKind, SourceState, service::Floor};

pub(crate) use browse::{browse, describe, describe_many, list, search};
pub(crate) use connect::discover;
pub(crate) use connection::Connection;
pub(crate) use entry::Entry;
pub(crate) use paths::browse_path;
pub(crate) use services::{call, parse_range, read, write};

use life::{Ended, Memory};

/// Shortest and longest pause before another attempt to reach a server.
const PAUSE_MIN: Duration = Duration::from_millis(100);
const PAUSE_MAX: Duration = Duration::from_secs(2);
/// Longest pause after a refusal that only a person can resolve, so that no account is locked by
/// trying.
const PAUSE_REFUSED_MAX: Duration = Duration::from_secs(30);

/// The present.
pub(crate) fn now() -> DateTime {
    std::time::SystemTime::now().into()
}

/// Keeps a source connected until told to stop.
pub(crate) async fn run(
    floor: Arc<Floor>,
    entry: Arc<Entry>,
    config: SourceConfig,
    stop: CancellationToken,
) {
    let mut memory = Memory::default();
    let mut attempts = 0_u32;
    loop {
        entry.set_state(&floor, SourceState::Connecting, None);
        let attempt = tokio::select! {
            () = stop.cancelled() => break,
            attempt = connect::open(&floor, &config) => attempt,
        };
        let problem = match attempt {
            Ok(link) => match life::live(&floor, &entry, &config, link, &mut memory, &stop).await {
                Ended::Stopped => break,
                Ended::Lost { problem, has_flowed } => {
                    if has_flowed {
                        attempts = 0;
                    }
                    problem
                }
            },
            Err(problem) => problem,
        };
        tracing::warn!(
            source.id = %config.source_id, problem = ?problem.kind, reason = %problem.message,
            "A source is not connected and will be tried again."
        );
        metrics::counter!("shop_floor_connection_problems_total", "kind" => format!("{:?}", problem.kind)).increment(1);
        let pause = pause(attempts, problem.kind, rand::random());
        attempts = attempts.saturating_add(1);
        entry.set_state(&floor, SourceState::Waiting, Some(problem));
        tokio::select! {
            () = stop.cancelled() => break,
            () = tokio::time::sleep(pause) => {}
            () = entry.tried_now() => {}
        }
    }
    entry.set_state(&floor, SourceState::Waiting, None);
}

/// Doubling with the attempts, jittered by up to a quarter (`jitter`: 0 to 255).
fn pause(attempts: u32, kind: SourceProblemKind, jitter: u8) -> Duration {
    use SourceProblemKind as Kind;
    let max = match kind {
        Kind::Unreachable
        | Kind::ConnectionLost
        | Kind::Stalled
        | Kind::ServerFull
        | Kind::Refused => PAUSE_MAX,
        Kind::NoSuitableEndpoint
        | Kind::ServerCertificateUntrusted
        | Kind::ServerCertificateInvalid
        | Kind::ClientCertificateRejected
        | Kind::CredentialsRejected
        | Kind::Configuration => PAUSE_REFUSED_MAX,
    };
    let pause = PAUSE_MIN.saturating_mul(1 << attempts.min(16)).min(max);
    pause - pause.mul_f64(f64::from(jitter) / 1020.0)
}

/// A problem in the words of a person who must act.
fn problem(kind: SourceProblemKind, message: impl Into<String>) -> SourceProblem {
    use SourceProblemKind as Kind;
    let remedy = match kind {
        Kind::Unreachable => {
            "Check that the server runs, the address, and the network between. Tried again on its own."
        }
        Kind::NoSuitableEndpoint => {
            "Choose a security setting and a sign-in that the server offers."
        }
        Kind::ServerCertificateUntrusted => {
            "Compare the thumbprint with the server's own certificate and approve it in the list of certificates."
        }
        Kind::ServerCertificateInvalid => "Renew the server's certificate.",
        Kind::ClientCertificateRejected => {
            "Ask the server's administrator to trust this connector's certificate, then wait a moment."
        }
        Kind::CredentialsRejected => {
            "Correct user name and password, or ask the server's administrator."
        }
        Kind::ServerFull => "Close another client of the server, or raise its limit of sessions.",
        Kind::ConnectionLost => "Nothing to do: it is connected again on its own.",
        Kind::Stalled => {
            "Nothing to do: a new session is made. If it happens often, look at the server."
        }
        Kind::Refused => "Look at the server's log for the reason.",
        Kind::Configuration => "Correct the configuration of the source.",
    };
    SourceProblem { kind, message: message.into(), remedy: remedy.into() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pauses_grow_and_stay_below_their_cap() {
        assert_eq!(pause(0, SourceProblemKind::Unreachable, 0), Duration::from_millis(100));
        assert_eq!(pause(3, SourceProblemKind::Unreachable, 0), Duration::from_millis(800));
        assert_eq!(pause(60, SourceProblemKind::Unreachable, 0), PAUSE_MAX);
        assert_eq!(pause(60, SourceProblemKind::CredentialsRejected, 0), PAUSE_REFUSED_MAX);
        assert_eq!(pause(60, SourceProblemKind::Unreachable, 255), Duration::from_millis(1500));
    }
}
