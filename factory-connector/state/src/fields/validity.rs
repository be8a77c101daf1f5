//! The time span in which a request asks for values.

use asi_model::{DateTime, network::DynamicDataRequest};

/// A time span, from its first instant up to the first instant after it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Validity {
    /// First instant; unbounded without it.
    pub from: Option<DateTime>,
    /// First instant after the span; unbounded without it.
    pub until: Option<DateTime>,
}

impl Validity {
    /// Returns true while values are asked for.
    #[must_use]
    pub fn contains(&self, at: DateTime) -> bool {
        self.from.is_none_or(|from| from <= at) && !self.has_ended(at)
    }

    /// Returns true once values are not asked for any more.
    #[must_use]
    pub fn has_ended(&self, at: DateTime) -> bool {
        self.until.is_some_and(|until| until <= at)
    }
}

impl From<&DynamicDataRequest> for Validity {
    fn from(request: &DynamicDataRequest) -> Self {
        Self { from: request.valid_from, until: request.valid_until }
    }
}
