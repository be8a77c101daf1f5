//! Values on their way through a chain.

use asi_model::{DataValue, Variant};

use crate::{fault::Fault, quality::Meta};

/// A value on its way through the chain.
#[derive(Debug, Clone, PartialEq)]
pub struct Flow {
    pub value: Variant,
    pub meta: Meta,
}

impl Flow {
    /// Returns value, status and times as one.
    pub fn into_value(self) -> DataValue {
        self.meta.with(self.value)
    }
}

/// Result of one function on one value.
#[derive(Debug)]
pub(super) enum Applied {
    /// The chain continues with this value.
    Pass(Flow),
    /// The chain ends here until the next value.
    Hold,
    /// The chain ends with a candidate without value.
    Fail(Fault, Meta),
    /// A script must be called with this value.
    Call(Flow),
}
