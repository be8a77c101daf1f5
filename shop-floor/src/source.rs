//! Task of one source: connects, runs the session, and backs off after its loss.

mod activity;
mod audit;
mod browse;
mod browse_paths;
mod connect;
mod connection;
mod events;
mod inquiry;
mod memory;
mod notification_sink;
mod record;
mod request_size;
mod server_info;
mod services;
mod session;
mod subscriptions;

use std::{sync::Arc, time::Duration};

use tokio_util::sync::CancellationToken;

use crate::{SourceConfig, SourceProblemKind, SourceState, context::SourceContext};

pub(crate) use browse::{browse, describe, describe_many, list_variables, search};
pub(crate) use browse_paths::browse_path;
pub(crate) use connection::Connection;
pub(crate) use inquiry::{discover, test_source};
pub(crate) use record::SourceRecord;
pub(crate) use services::{call, read, write};

use memory::SourceMemory;
use session::SessionEnd;

/// Shortest and longest backoff before the next attempt to connect. Short: machines restart often,
/// and values are lost until the subscription is back.
const BACKOFF_MIN: Duration = Duration::from_millis(100);
const BACKOFF_MAX: Duration = Duration::from_secs(2);
/// Longest backoff after a refusal that only a person can resolve. Long, because frequent attempts
/// with wrong credentials make servers lock the account.
const BACKOFF_REFUSED_MAX: Duration = Duration::from_secs(30);

/// Keeps a source connected until `stop` is cancelled.
pub(crate) async fn run(
    context: Arc<SourceContext>,
    record: Arc<SourceRecord>,
    config: SourceConfig,
    stop: CancellationToken,
) {
    let mut memory = SourceMemory::default();
    let mut attempts = 0_u32;
    loop {
        record.set_state(&context, SourceState::Connecting, None);
        let attempt = tokio::select! {
            () = stop.cancelled() => break,
            attempt = connect::open_session(&context, &config) => attempt,
        };
        let end = match attempt {
            Ok(opened) => {
                session::run_session(&context, &record, &config, opened, &mut memory, &stop).await
            }
            Err(problem) => SessionEnd::Lost { problem, has_flowed: false },
        };
        let problem = match end {
            SessionEnd::Stopped => break,
            SessionEnd::Lost { problem, has_flowed } => {
                if has_flowed {
                    attempts = 0;
                }
                problem
            }
        };
        tracing::warn!(
            source.id = %config.source_id, problem = ?problem.kind, reason = %problem.message,
            "A source is not connected and will be tried again."
        );
        metrics::counter!(
            "shop_floor_connection_problems_total", "kind" => format!("{:?}", problem.kind)
        )
        .increment(1);
        let pause = backoff(attempts, problem.kind, rand::random());
        attempts = attempts.saturating_add(1);
        record.set_state(&context, SourceState::Waiting, Some(problem));
        tokio::select! {
            () = stop.cancelled() => break,
            () = tokio::time::sleep(pause) => {}
            () = record.retry_requested() => {}
        }
    }
    record.set_state(&context, SourceState::Waiting, None);
}

/// Returns a backoff that doubles with the attempts, shortened by up to a quarter (`jitter`: 0 to
/// 255).
fn backoff(attempts: u32, kind: SourceProblemKind, jitter: u8) -> Duration {
    use SourceProblemKind as Kind;
    let max = match kind {
        Kind::Unreachable
        | Kind::HostNameUnknown
        | Kind::NothingListens
        | Kind::ConnectionLost
        | Kind::Stalled
        | Kind::ServerFull
        | Kind::Refused => BACKOFF_MAX,
        Kind::EndpointsHidden
        | Kind::NoSuitableEndpoint
        | Kind::SecurityOutdated
        | Kind::ServerCertificateUntrusted
        | Kind::ServerCertificateInvalid
        | Kind::ServerKeyTooShort
        | Kind::ClientCertificateRejected
        | Kind::ClientCertificateOutOfTime
        | Kind::CredentialsRejected
        | Kind::Configuration => BACKOFF_REFUSED_MAX,
    };
    let backoff = BACKOFF_MIN.saturating_mul(1 << attempts.min(16)).min(max);
    backoff - backoff.mul_f64(f64::from(jitter) / 1020.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn backoff_doubles_up_to_the_maximum_of_the_problem() {
        use SourceProblemKind::{CredentialsRejected, Unreachable};
        for (attempts, kind, jitter, expected) in [
            (0, Unreachable, 0, BACKOFF_MIN),
            (3, Unreachable, 0, Duration::from_millis(800)),
            (60, Unreachable, 0, BACKOFF_MAX),
            (60, CredentialsRejected, 0, BACKOFF_REFUSED_MAX),
            (60, Unreachable, 255, Duration::from_millis(1500)),
        ] {
            assert_eq!(backoff(attempts, kind, jitter), expected, "{attempts} {kind:?} {jitter}");
        }
    }
}
