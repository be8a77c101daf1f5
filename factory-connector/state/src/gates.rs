//! Gates of fields with what follows from a release.

use asi_model::DateTime;
use disclosure::Gate;

use crate::ConnectorState;

/// Changes a field's gate; where it releases a value, the writer has something to report.
pub(crate) fn through_gate<T>(
    state: &mut ConnectorState,
    id: i64,
    now: DateTime,
    change: impl FnOnce(&mut Gate) -> T,
) -> Option<T> {
    state.fields.through_gate(&mut state.writers, id, now, change)
}
