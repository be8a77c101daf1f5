//! Schedule of keep-alives: each writer's period is the update interval of its request.

use crate::ConnectorState;

/// Sets the period of a writer's keep-alives from its request.
pub(crate) fn schedule_keep_alive(state: &mut ConnectorState, id: u16) {
    let Some(writer) = state.writers.get(id) else { return };
    let period =
        state.networks.request(writer.request()).and_then(|(_, request)| request.update_interval());
    state.writers.set_keep_alive(id, period);
}
