//! The last candidate of a transform, so that no candidate is yielded twice.

use asi_model::{DataValue, StatusCode};

use crate::quality::worst;

/// The last candidate and, behind a Bad one, the last usable value.
#[derive(Debug)]
pub(super) struct LastCandidate {
    /// The last value that was not Bad, with the status that the functions gave it beyond that of
    /// the inputs.
    usable: Option<(DataValue, StatusCode)>,
    shown: Shown,
}

#[derive(Debug)]
enum Shown {
    Nothing,
    /// The usable value, with this status.
    Usable(StatusCode),
    Bad(Box<DataValue>),
}

impl LastCandidate {
    /// Continues after the last candidate of a former run.
    pub fn restored(last: Option<DataValue>) -> Self {
        let shown = match &last {
            None => Shown::Nothing,
            Some(value) if value.value.is_null() => Shown::Bad(Box::new(value.clone())),
            Some(value) => Shown::Usable(value.status),
        };
        let usable =
            last.filter(|value| !value.value.is_null()).map(|value| (value, StatusCode::GOOD));
        Self { usable, shown }
    }

    /// Returns true where there is a usable value, that of a former run included.
    pub const fn is_usable(&self) -> bool {
        self.usable.is_some()
    }

    /// Returns the last candidate, that of a former run included.
    pub fn value(&self) -> Option<DataValue> {
        match &self.shown {
            Shown::Nothing => None,
            Shown::Usable(status) => {
                self.usable.as_ref().map(|(last, _)| DataValue { status: *status, ..last.clone() })
            }
            Shown::Bad(value) => Some((**value).clone()),
        }
    }

    /// Returns the status of the last candidate.
    pub fn status(&self) -> Option<StatusCode> {
        match &self.shown {
            Shown::Nothing => None,
            Shown::Usable(status) => Some(*status),
            Shown::Bad(value) => Some(value.status),
        }
    }

    /// Records a value; `own` is the part of its status that does not come from the inputs.
    pub fn set_usable(&mut self, value: &DataValue, own: StatusCode) {
        self.shown = Shown::Usable(value.status);
        self.usable = Some((value.clone(), own));
    }

    /// Records a candidate without value.
    pub fn set_bad(&mut self, value: &DataValue) {
        match &mut self.shown {
            Shown::Bad(shown) => (**shown).clone_from(value),
            other => *other = Shown::Bad(Box::new(value.clone())),
        }
    }

    /// Returns the usable value with the status that the inputs give it now, where that differs from
    /// the last candidate's, and records it.
    pub fn refresh(&mut self, inputs: StatusCode) -> Option<DataValue> {
        let (last, own) = self.usable.as_ref()?;
        let status = worst(inputs, *own);
        if self.status() == Some(status) {
            return None;
        }
        self.shown = Shown::Usable(status);
        Some(DataValue { status, ..last.clone() })
    }
}
