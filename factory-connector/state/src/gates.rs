//! Gates of fields with what follows from a release.

use asi_model::DateTime;
use disclosure::Gate;

use crate::{ConnectorState, fields::FieldMut};

/// Changes a field's gate; where it releases a value, the writer has something to report.
pub(crate) fn through_gate<T>(
    state: &mut ConnectorState,
    id: i64,
    now: DateTime,
    change: impl FnOnce(&mut Gate) -> T,
) -> Option<T> {
    let mut field: FieldMut<'_> = state.fields.by_id_mut(id)?;
    let writer = field.writer;
    let (result, is_first_release) = field.through_gate(now, change);
    if is_first_release {
        state.writers.mark_unreported(writer);
    }
    Some(result)
}
