//! Documents that the twin shows: networks as they were received, and a record for every requested
//! field.

use std::{collections::HashMap, sync::Arc};

use asi_model::{
    DataValue, DateTime, FieldKey, RequestKey, StatusCode, Variant,
    messages::{MappingState, OperationNetworkMessage, ValueSource},
};
use disclosure::Released;

/// The present state of an operation network, with the connector's decisions about it. One document
/// becomes one Activity Status Interface. Applying it again with a higher revision changes only the
/// nodes that differ.
#[derive(Debug, Clone)]
pub struct AsiDocument {
    /// The network as the platform sent it: this factory's operations and stubs of their
    /// neighbours.
    pub message: Arc<OperationNetworkMessage>,
    /// Time at which the connector accepted it.
    pub received_at: DateTime,
    /// The DataSetWriterId of every request that has one.
    pub writers: HashMap<RequestKey, u16>,
    /// The records of the fields. A requested field without one is shown as undecided.
    pub fields: HashMap<FieldKey, FieldRecord>,
}

/// Decision and value of one requested field, from which its variable and properties are computed.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FieldRecord {
    pub mapping_state: MappingState,
    /// Source of the values of a mapped field.
    pub value_source: Option<ValueSource>,
    /// The newest value as it was disclosed; ignored unless the field is mapped.
    pub value: Option<Released>,
    /// Description of the coarsening, in words and numbers.
    pub disclosure: Option<Arc<str>>,
    /// Reason of the decision.
    pub reason: Option<Arc<str>>,
    /// The user who decided.
    pub decided_by: Option<Arc<str>>,
    pub decision_time: Option<DateTime>,
}

impl FieldRecord {
    /// Returns the value that a client reads from the field's variable: the disclosed value if the
    /// field is mapped, otherwise a status with the cause. It is the same value that the partner
    /// gets.
    #[must_use]
    pub fn shown_value(&self) -> DataValue {
        match self.mapping_state {
            MappingState::Pending => {
                DataValue::status_only(StatusCode::BAD_WAITING_FOR_INITIAL_DATA, self.decision_time)
            }
            MappingState::Refused => {
                DataValue::status_only(StatusCode::BAD_NOT_SUPPORTED, self.decision_time)
            }
            MappingState::Mapped => {
                let shown = self.value.as_deref();
                shown.filter(|shown| !is_empty(shown)).cloned().unwrap_or_else(|| {
                    // The node shows what the partner has, which is nothing.
                    let status = StatusCode::BAD_WAITING_FOR_INITIAL_DATA;
                    DataValue::status_only(status, self.decision_time)
                })
            }
        }
    }

    /// Returns whether OPC UA clients may write the field's variable.
    #[must_use]
    pub fn is_writable(&self) -> bool {
        self.mapping_state == MappingState::Mapped
            && self.value_source == Some(ValueSource::External)
    }
}

fn is_empty(value: &DataValue) -> bool {
    value.value == Variant::Null && value.status.is_good()
}

/// Extent of the change by [`TwinHandle::apply`](crate::TwinHandle::apply).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct AppliedDocument {
    /// Added objects and report fields.
    pub nodes_added: usize,
    /// Removed objects and report fields.
    pub nodes_removed: usize,
    /// Objects and report fields with another property or value.
    pub nodes_changed: usize,
}

#[cfg(test)]
mod tests {
    use asi_model::BuiltInType;
    use disclosure::{Gate, GateState};

    use super::*;

    #[test]
    fn only_mapped_fields_show_values() {
        let value = released(DataValue::good(7_u64, DateTime::from_ticks(1)));
        let empty = released(DataValue::good(Variant::Null, DateTime::from_ticks(1)));
        let check = |mapping_state, value: &Option<Released>, expected: StatusCode| {
            let record =
                FieldRecord { mapping_state, value: value.clone(), ..FieldRecord::default() };
            assert_eq!(record.shown_value().status, expected, "{mapping_state:?}");
            assert_eq!(
                record.shown_value().value.is_null(),
                expected.is_bad(),
                "{mapping_state:?}"
            );
        };
        check(MappingState::Pending, &value, StatusCode::BAD_WAITING_FOR_INITIAL_DATA);
        check(MappingState::Refused, &value, StatusCode::BAD_NOT_SUPPORTED);
        check(MappingState::Mapped, &value, StatusCode::GOOD);
        check(MappingState::Mapped, &empty, StatusCode::BAD_WAITING_FOR_INITIAL_DATA);
        check(MappingState::Mapped, &None, StatusCode::BAD_WAITING_FOR_INITIAL_DATA);
    }

    fn released(value: DataValue) -> Option<Released> {
        let at = DateTime::from_ticks(1);
        let mut gate = Gate::new(Arc::default(), BuiltInType::UInt64, GateState::default(), at);
        gate.on(at, value);
        gate.disclosed().cloned()
    }
}
