//! Values with the form in which they came.

use crate::values::{DataValue, Scalar, Variant};

/// A value and the form in which it came.
#[derive(Debug, Clone, PartialEq)]
pub enum DecodedValue {
    /// With its type, without times.
    Variant(Variant),
    /// With its quality and times.
    DataValue(DataValue),
    /// Without its type.
    Bare(Variant),
}

impl DecodedValue {
    /// The value with its quality. A Bad status code in place of a value, and a data
    /// value inside a variant, are what OPC 10000-14 §6.2.4.2 makes of values that are not Good;
    /// they become a value's quality again.
    #[must_use]
    pub fn into_data_value(self) -> DataValue {
        match self {
            Self::DataValue(value) => value,
            Self::Variant(Variant::Scalar(Scalar::DataValue(value))) => *value,
            Self::Variant(Variant::Scalar(Scalar::StatusCode(status))) if status.is_bad() => {
                DataValue::status_only(status, None)
            }
            Self::Variant(value) | Self::Bare(value) => DataValue { value, ..DataValue::default() },
        }
    }
}
