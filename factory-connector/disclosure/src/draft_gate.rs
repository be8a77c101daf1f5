//! Draft gates: what a policy that is not in force would release.

use std::sync::Arc;

use asi_model::{BuiltInType, DataValue, DateTime, FieldName};

use crate::{DisclosurePolicy, Gate, GateOutcome, GateState};

/// Gate under a policy that is not in force, for a preview. It does what a [`Gate`] does, but its
/// results are no [`Released`](crate::Released) values, so that none of them can leave:
///
/// ```compile_fail,E0308
/// fn leave(draft: &disclosure::DraftGate) -> Option<&disclosure::Released> {
///     draft.shown()
/// }
/// ```
///
/// ```
/// fn show(draft: &disclosure::DraftGate) -> Option<&asi_model::DataValue> {
///     draft.shown()
/// }
/// ```
#[derive(Debug)]
pub struct DraftGate(Gate);

impl DraftGate {
    /// Makes a gate that has let nothing out yet.
    #[must_use]
    pub fn new(policy: Arc<DisclosurePolicy>, field_type: BuiltInType, now: DateTime) -> Self {
        Self(Gate::new(policy, field_type, GateState::default(), now))
    }

    /// Handles a candidate, as [`Gate::on`] does.
    pub fn on(&mut self, now: DateTime, candidate: DataValue) -> GateOutcome {
        self.0.on(now, candidate)
    }

    /// Notes the state of another field, as [`Gate::on_state`] does.
    pub fn on_state(&mut self, now: DateTime, other: &FieldName, is_withheld: Option<bool>) {
        self.0.on_state(now, other, is_withheld);
    }

    /// Takes note of the time, as [`Gate::on_time`] does.
    pub fn on_time(&mut self, now: DateTime) {
        self.0.on_time(now);
    }

    /// Returns the time at which a value would leave next.
    #[must_use]
    pub fn due(&self) -> Option<DateTime> {
        self.0.due()
    }

    /// Returns the gate, for a report that cannot leave.
    pub(crate) const fn gate(&self) -> &Gate {
        &self.0
    }

    /// Returns the value that partners would get.
    #[must_use]
    pub fn shown(&self) -> Option<&DataValue> {
        self.0.disclosed().map(|released| &**released)
    }
}
