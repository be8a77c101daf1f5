//! DataValues with status and time.

use asi_model::DateTime;
use opcua_stack::{
    opcua::types::{DataValue, StatusCode, Variant},
    values::time_to_stack,
};

/// Returns a good value with the time since which it applies.
pub(super) fn fixed(value: Variant, since: DateTime) -> DataValue {
    DataValue {
        value: Some(value),
        status: Some(StatusCode::Good),
        source_timestamp: Some(time_to_stack(since)),
        ..DataValue::default()
    }
}

/// Returns a status without a value.
pub(super) fn status_only(status: StatusCode) -> DataValue {
    DataValue { status: Some(status), ..DataValue::default() }
}
