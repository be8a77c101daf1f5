//! What the connector gives the twin to show: networks as they were received, and a record for
//! every requested field.

use std::{collections::HashMap, sync::Arc};

use asi_model::{
    DataValue, DateTime, FieldKey, RequestKey, StatusCode, Variant,
    messages::{MappingState, OperationNetworkMessage, ValueSource},
};

/// An operation network as it stands now, with everything the connector decided about it. One
/// document becomes one Activity Status Interface; applying it again under a higher revision
/// touches only what differs.
#[derive(Debug, Clone)]
pub struct AsiDocument {
    /// The network as the platform sent it: this factory's operations and stubs of their
    /// neighbours.
    pub message: Arc<OperationNetworkMessage>,
    /// When the connector accepted it.
    pub received_at: DateTime,
    /// The DataSetWriterId of every request that has one.
    pub writers: HashMap<RequestKey, u16>,
    /// Where every field stands. A requested field without a record is shown as undecided.
    pub fields: HashMap<FieldKey, FieldRecord>,
}

/// Where one requested field stands. The field's variable and its properties are computed from
/// this.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FieldRecord {
    /// What was decided.
    pub mapping_state: MappingState,
    /// Where the values of a mapped field come from.
    pub value_source: Option<ValueSource>,
    /// The newest value as it was disclosed; ignored unless the field is mapped.
    pub value: DataValue,
    /// How the value is coarsened, in words and numbers.
    pub disclosure: Option<Arc<str>>,
    /// Why it was decided so.
    pub reason: Option<Arc<str>>,
    /// The user who decided.
    pub decided_by: Option<Arc<str>>,
    /// When it was decided.
    pub decision_time: Option<DateTime>,
}

impl FieldRecord {
    /// What a client reads from the field's variable: the disclosed value where the field is
    /// mapped, else a status that says why there is none. *What the node shows is what the partner
    /// gets.*
    #[must_use]
    pub fn shown_value(&self) -> DataValue {
        match self.mapping_state {
            MappingState::Pending => {
                DataValue::status_only(StatusCode::BAD_WAITING_FOR_INITIAL_DATA, self.decision_time)
            }
            MappingState::Refused => {
                DataValue::status_only(StatusCode::BAD_NOT_SUPPORTED, self.decision_time)
            }
            MappingState::Mapped
                if self.value.value == Variant::Null && self.value.status.is_good() =>
            {
                DataValue::status_only(StatusCode::BAD_WAITING_FOR_INITIAL_DATA, self.decision_time)
            }
            MappingState::Mapped => self.value.clone(),
        }
    }

    /// Whether OPC UA clients may write the field's variable.
    #[must_use]
    pub fn is_writable(&self) -> bool {
        self.mapping_state == MappingState::Mapped
            && self.value_source == Some(ValueSource::External)
    }
}

/// How much an [`crate::TwinHandle::apply`] changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Applied {
    /// Objects and report fields that came.
    pub nodes_added: usize,
    /// Objects and report fields that went.
    pub nodes_removed: usize,
    /// Objects and report fields of which a property or a value differs.
    pub nodes_changed: usize,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_mapped_fields_show_values() {
        let value = DataValue::good(7_u64, DateTime::from_ticks(1));
        let check = |mapping_state, value: &DataValue, expected: StatusCode| {
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
        check(
            MappingState::Mapped,
            &DataValue::default(),
            StatusCode::BAD_WAITING_FOR_INITIAL_DATA,
        );
    }
}
