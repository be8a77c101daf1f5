//! Tells open pages when the link or a local server changes its state.

use std::time::Duration;

use daemon::web::events::EventLog;
use messaging::LinkState;
use tokio::sync::watch;
use tokio_util::sync::CancellationToken;

use connector_state::ConnectorEvent;

/// However fast things change, pages are told so often at most.
const PAUSE: Duration = Duration::from_millis(500);

/// Runs until shutdown. What only counts - messages, ages, the spool - is not told: pages ask for
/// it.
pub(super) async fn tell(
    events: EventLog<ConnectorEvent>,
    mut link: watch::Receiver<LinkState>,
    mut sources: watch::Receiver<u64>,
    shutdown: CancellationToken,
) {
    let standing = |state: &LinkState| (state.phase, state.reason.clone());
    let mut told = standing(&link.borrow_and_update());
    loop {
        tokio::select! {
            () = shutdown.cancelled() => return,
            Ok(()) = link.changed() => {
                let now = standing(&link.borrow_and_update());
                if std::mem::replace(&mut told, now.clone()) == now {
                    continue;
                }
            }
            Ok(()) = sources.changed() => {}
            else => return,
        }
        events.publish([ConnectorEvent::Status]);
        if shutdown.run_until_cancelled(tokio::time::sleep(PAUSE)).await.is_none() {
            return;
        }
    }
}
