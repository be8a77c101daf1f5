//! Readiness and metric of the conflict between the ledger and its witness.

use daemon::web::health::Readiness;
use tokio::sync::watch;
use tokio_util::sync::CancellationToken;

/// Condition of readiness.
const CONDITION: &str = "ledger";
const REASON: &str = "the platform holds another history of the ledger, so nothing is disclosed: restore \
                      the newest store, or begin a new log on the page of the ledger";

/// Keeps `/readyz` and the metric in line with the conflict, until shutdown.
pub(super) async fn run(
    mut conflicts: watch::Receiver<bool>,
    readiness: Readiness,
    shutdown: CancellationToken,
) {
    loop {
        let is_in_conflict = *conflicts.borrow_and_update();
        metrics::gauge!("verbund_ledger_conflict").set(f64::from(u8::from(is_in_conflict)));
        if is_in_conflict {
            readiness.waiting(CONDITION, REASON);
        } else {
            readiness.ready(CONDITION);
        }
        if !matches!(shutdown.run_until_cancelled(conflicts.changed()).await, Some(Ok(()))) {
            return;
        }
    }
}
