//! What a transform has said last, so that it says nothing twice.

use asi_model::{DataValue, StatusCode};

/// The last candidate.
#[derive(Debug)]
pub(super) enum Shown {
    /// There was none.
    Nothing,
    /// The last value that was not Bad, with this status.
    Last(StatusCode),
    Bad(Box<DataValue>),
}

impl Shown {
    /// What a former run yielded last.
    pub fn of(last: Option<&DataValue>) -> Self {
        match last {
            None => Self::Nothing,
            Some(value) if value.value.is_null() => Self::Bad(Box::new(value.clone())),
            Some(value) => Self::Last(value.status),
        }
    }

    pub fn status(&self) -> Option<StatusCode> {
        match self {
            Self::Nothing => None,
            Self::Last(status) => Some(*status),
            Self::Bad(value) => Some(value.status),
        }
    }

    pub fn set_bad(&mut self, value: &DataValue) {
        match self {
            Self::Bad(kept) => (**kept).clone_from(value),
            other => *other = Self::Bad(Box::new(value.clone())),
        }
    }
}
