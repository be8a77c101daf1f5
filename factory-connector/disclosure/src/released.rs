//! Released values: the form in which a value leaves the gate.

use std::ops::Deref;

use asi_model::DataValue;

/// A value that a [`Gate`](crate::Gate) released. Reports, nodes and live events take nothing else,
/// and no code outside of this crate makes one:
///
/// ```compile_fail,E0423
/// let _ = disclosure::Released(asi_model::DataValue::default());
/// ```
///
/// ```compile_fail,E0277
/// let _: disclosure::Released = asi_model::DataValue::default().into();
/// ```
///
/// Nor can a released value be changed:
///
/// ```compile_fail,E0594
/// fn change(released: &mut disclosure::Released) {
///     released.value = asi_model::Variant::from(17_u64);
/// }
/// ```
///
/// It is read like any other value:
///
/// ```
/// fn read(released: &disclosure::Released) -> asi_model::Variant {
///     released.value.clone()
/// }
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Released(DataValue);

impl Released {
    /// Marks a value as released. To be called by the gate alone, once its policy allows it.
    pub(crate) const fn by_gate(value: DataValue) -> Self {
        Self(value)
    }

    /// Returns the value, to be coarsened again by another policy.
    pub(crate) fn into_value(self) -> DataValue {
        self.0
    }
}

impl Deref for Released {
    type Target = DataValue;

    fn deref(&self) -> &DataValue {
        &self.0
    }
}
