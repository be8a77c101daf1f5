//! Events for open pages about the states of the link and of local servers.

use std::time::Duration;

use connector_state::ConnectorEvent;
use messaging::LinkState;
use tokio::sync::watch;
use tokio_util::sync::CancellationToken;

use crate::live_events::LiveEvents;

/// Shortest time between two events. A flapping link must not make every page redraw all the time.
const PAUSE: Duration = Duration::from_millis(500);

/// Publishes an event for each change of a state, until shutdown. Counters - messages, ages, the
/// spool - cause none: pages poll them.
pub(super) async fn publish(
    events: LiveEvents,
    mut link: watch::Receiver<LinkState>,
    mut sources: watch::Receiver<u64>,
    shutdown: CancellationToken,
) {
    let phase = |state: &LinkState| (state.phase, state.reason.clone());
    let mut published = phase(&link.borrow_and_update());
    loop {
        tokio::select! {
            () = shutdown.cancelled() => return,
            Ok(()) = link.changed() => {
                let now = phase(&link.borrow_and_update());
                // Only a counter changed.
                if std::mem::replace(&mut published, now.clone()) == now {
                    continue;
                }
            }
            Ok(()) = sources.changed() => {}
            else => return,
        }
        events.publish(vec![ConnectorEvent::Status]);
        if shutdown.run_until_cancelled(tokio::time::sleep(PAUSE)).await.is_none() {
            return;
        }
    }
}
