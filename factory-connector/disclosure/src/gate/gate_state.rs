//! State of a gate, which is stored over restarts.

use std::collections::{BTreeMap, VecDeque};

use asi_model::{DataValue, DateTime, FieldName};

use crate::{DisclosurePolicy, Released, aggregate::Aggregation};

/// State of a gate that is stored over restarts. Its members are the gate's own: what waits in it
/// leaves without being coarsened again.
///
/// ```compile_fail,E0451
/// let _ = disclosure::GateState { disclosed: None, ..Default::default() };
/// ```
///
/// ```compile_fail,E0616
/// fn wait(state: &mut disclosure::GateState, value: asi_model::DataValue) {
///     state.waiting.push_back((asi_model::DateTime::MIN, value));
/// }
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct GateState {
    /// Time of the last release, for the minimum interval.
    pub(crate) last_released_at: Option<DateTime>,
    /// The value released last.
    pub(crate) disclosed: Option<Released>,
    /// Coarsened values that wait, with their times of arrival, oldest first.
    pub(crate) waiting: VecDeque<(DateTime, DataValue)>,
    /// Times of releases, for the rate limits, oldest first.
    pub(crate) released: VecDeque<DateTime>,
    /// The window of an aggregate.
    pub(crate) aggregation: Aggregation,
    /// True when the field's own value is in a withheld state.
    pub(crate) is_in_withheld_state: bool,
    /// Other fields; true for those in a withheld state, absent when that is not known.
    pub(crate) withheld_by: BTreeMap<FieldName, bool>,
    /// End of the last state that withheld, where releases have slots.
    pub(crate) opened_at: Option<DateTime>,
}

impl GateState {
    /// Coarsens the status codes of a state that may be from a time when all were disclosed.
    pub(super) fn coarsen_statuses(&mut self, policy: &DisclosurePolicy) {
        let coarsen = |mut value: DataValue| {
            value.status = policy.status_codes.coarsen(value.status);
            value
        };
        for (_, value) in &mut self.waiting {
            *value = coarsen(std::mem::take(value));
        }
        let disclosed = self.disclosed.take();
        self.disclosed = disclosed.map(|old| Released::by_gate(coarsen(old.into_value())));
    }
}
