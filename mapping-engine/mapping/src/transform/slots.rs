//! The last value of an input, and what its arrival means.

use std::time::Duration;

use asi_model::{DataValue, DateTime, StatusCode, Variant};

use super::flow::Flow;
use crate::{
    document::LateValues,
    quality::{Meta, is_source_away, severity},
};

/// Greatest delay of a late value; beyond it the source's clock was set back.
const LATE_MAX: Duration = Duration::from_secs(10);
/// Late values in a row that are a clock that was set back a little.
const LATE_IN_A_ROW_MAX: u8 = 16;

/// Numbers of values of all inputs that were not taken as they came.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Counters {
    /// Values older than the newest one of the same variable.
    pub late: u64,
    /// Values equal to the one before, its source time included.
    pub repeated: u64,
    /// Values that show that the source's clock was set back.
    pub clock_steps: u64,
}

/// An input as the transform knows it.
#[derive(Debug, Default)]
pub(super) struct Slot {
    /// The last value that came from the source, whatever its status.
    pub value: Option<DataValue>,
    /// Arrival time by the local clock.
    pub received_at: DateTime,
    /// Set while the source cannot be asked.
    away: Option<StatusCode>,
    late_in_a_row: u8,
}

/// Meaning of a value's arrival.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Arrival {
    New,
    Repeated,
    Ignored,
    SourceAway,
}

impl Slot {
    /// Stores a value, unless it is a repeat, late, or reports that the source is away.
    pub fn take(
        &mut self,
        value: DataValue,
        now: DateTime,
        late_values: LateValues,
        counters: &mut Counters,
    ) -> Arrival {
        if is_source_away(value.status) {
            self.away = Some(value.status);
            return Arrival::SourceAway;
        }
        self.away = None;
        if let Some(last) = &self.value {
            // Without a source time two equal values may be two measurements.
            let same_time =
                value.source_timestamp.is_some() && value.source_timestamp == last.source_timestamp;
            if same_time && value.status == last.status && value.value == last.value {
                counters.repeated += 1;
                return Arrival::Repeated;
            }
            if let (Some(new), Some(newest)) = (value.source_timestamp, last.source_timestamp)
                && new < newest
            {
                self.late_in_a_row = self.late_in_a_row.saturating_add(1);
                if newest.since(new) > LATE_MAX || self.late_in_a_row > LATE_IN_A_ROW_MAX {
                    counters.clock_steps += 1;
                } else {
                    counters.late += 1;
                    if late_values == LateValues::Ignore {
                        return Arrival::Ignored;
                    }
                }
            }
        }
        self.late_in_a_row = 0;
        self.received_at = now;
        self.value = Some(value);
        Arrival::New
    }

    /// True before the first value of the input.
    pub fn is_waiting(&self) -> bool {
        self.value.is_none() && self.away.is_none()
    }

    /// The value with the status that holds now; `None` without a usable value.
    pub fn flow(&self) -> Option<Flow> {
        let value = self.value.as_ref().filter(|value| severity(value.status) < 2)?;
        let mut meta = Meta::of(value);
        if self.away.is_some() {
            meta.status = StatusCode::UNCERTAIN_NO_COMMUNICATION_LAST_USABLE_VALUE;
        }
        Some(Flow { value: value.value.clone(), meta })
    }

    /// The value, without a copy.
    pub fn variant(&self) -> Option<&Variant> {
        self.value.as_ref().filter(|value| severity(value.status) < 2).map(|value| &value.value)
    }

    /// Status and times that hold now.
    pub fn meta(&self) -> Option<Meta> {
        let value = self.value.as_ref().filter(|value| severity(value.status) < 2)?;
        let mut meta = Meta::of(value);
        if self.away.is_some() {
            meta.status = StatusCode::UNCERTAIN_NO_COMMUNICATION_LAST_USABLE_VALUE;
        }
        Some(meta)
    }

    /// The source is away and gave nothing since we began.
    pub fn is_away_unseen(&self) -> bool {
        self.away.is_some() && self.value.is_none()
    }

    /// The status that holds now, once anything came. `has_last`: there is a last candidate, from a
    /// former run perhaps, that stands while the source is away.
    pub fn status(&self, has_last: bool) -> Option<StatusCode> {
        let is_usable = self.value.as_ref().map_or(has_last, |value| severity(value.status) < 2);
        match (&self.value, self.away) {
            (_, Some(_)) if is_usable => {
                Some(StatusCode::UNCERTAIN_NO_COMMUNICATION_LAST_USABLE_VALUE)
            }
            (_, Some(away)) => Some(away),
            (value, None) => value.as_ref().map(|value| value.status),
        }
    }

    /// Returns the candidate while the input is Bad: no value, its status and times.
    pub fn bad(&self, has_last: bool) -> Option<DataValue> {
        let status = self.status(has_last).filter(|status| severity(*status) == 2)?;
        let meta = self.value.as_ref().map(Meta::of).unwrap_or_default();
        Some(meta.failed(status))
    }
}
