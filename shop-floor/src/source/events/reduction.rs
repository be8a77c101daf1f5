//! Reduction of an input's events to its value: a state machine without I/O.

use std::sync::Arc;

use asi_model::values::{DataValue, DateTime, Scalar, StatusCode, Variant};

use super::{
    EventFields, QUEUE_OVERFLOW, REFRESH_END, REFRESH_REQUIRED, REFRESH_START,
    conditions::{self, Conditions},
};
use crate::{EventSelection, MonitorRequest};

/// Events in a row that are older than the one before, after which the server's clock was set back.
const OLDER_IN_A_ROW_MAX: u8 = 16;

/// Reaction to an event.
#[derive(Debug, PartialEq)]
pub(in crate::source) enum Reaction {
    /// The input has this value.
    Value(DataValue),
    /// Event that says nothing of the input.
    Nothing,
    /// The server says that it is to be asked for all conditions.
    RefreshNeeded,
    /// The server's queue lost events.
    Overflow,
    /// The event has other fields than were selected.
    Unreadable,
}

/// State of an input that takes events.
#[derive(Debug)]
pub(in crate::source) struct EventReduction {
    request: Arc<MonitorRequest>,
    conditions: Conditions,
    /// Time of the last event, and the number of older ones since.
    last: (Option<DateTime>, u8),
    /// Value and quality of the conditions as last said.
    said: Option<(Variant, StatusCode)>,
}

impl EventReduction {
    /// Returns the state before the first event; `None` for a request for a variable.
    pub(in crate::source) fn new(request: &Arc<MonitorRequest>) -> Option<Self> {
        request.options.events.as_ref()?;
        let conditions = Conditions::default();
        Some(Self { request: Arc::clone(request), conditions, last: (None, 0), said: None })
    }

    fn selection(&self) -> &EventSelection {
        self.request.options.events.as_ref().expect("`new` makes none without")
    }

    /// Returns true where the value follows from the conditions that are active.
    pub(in crate::source) fn is_of_conditions(&self) -> bool {
        self.selection().value.is_of_conditions()
    }

    /// Takes the fields of an event, in the order of the select clauses.
    pub(in crate::source) fn take(&mut self, fields: Vec<Variant>) -> Reaction {
        let is_of_conditions = self.is_of_conditions();
        let others = if is_of_conditions { conditions::FIELDS } else { 1 };
        let Some(fields) = EventFields::read(fields, others) else { return Reaction::Unreadable };
        if fields.event_type == Some(QUEUE_OVERFLOW) {
            // Among the lost events may be the end of a condition.
            self.conditions.doubt();
            return Reaction::Overflow;
        }
        if is_of_conditions {
            return self.take_condition(fields);
        }
        // A refresh that another input needs shows conditions of the past again.
        let is_mark = [REFRESH_START, REFRESH_END, REFRESH_REQUIRED]
            .iter()
            .any(|mark| fields.event_type.as_ref() == Some(mark));
        if is_mark || self.is_of_the_past(fields.time) {
            Reaction::Nothing
        } else {
            take_field(fields)
        }
    }

    fn is_of_the_past(&mut self, time: Option<DateTime>) -> bool {
        let (last, older) = self.last;
        let is_older = time < last && older < OLDER_IN_A_ROW_MAX;
        self.last = if is_older { (last, older + 1) } else { (time, 0) };
        is_older
    }

    fn take_condition(&mut self, fields: EventFields) -> Reaction {
        let time = fields.time;
        let is_end = fields.event_type.as_ref() == Some(&REFRESH_END);
        match &fields.event_type {
            Some(id) if *id == REFRESH_START => self.conditions.begin_refresh(),
            _ if is_end => self.conditions.end_refresh(),
            Some(id) if *id == REFRESH_REQUIRED => {
                self.conditions.doubt();
                return Reaction::RefreshNeeded;
            }
            _ => {
                let severity_min = self.selection().severity_min.unwrap_or(0);
                self.conditions.take(fields, severity_min);
            }
        }
        if self.conditions.is_unsettled() {
            return Reaction::Nothing;
        }
        let (before, value) = (self.said.take(), self.value(time));
        // Another input may have needed the refresh.
        if is_end && before == self.said { Reaction::Nothing } else { Reaction::Value(value) }
    }

    /// Goes on without the conditions that were active before, which the server does not name. Returns the value, unless the
    /// server has named them.
    pub(in crate::source) fn give_up_refresh(&mut self, now: DateTime) -> Option<DataValue> {
        let is_open = self.conditions.give_up_refresh();
        is_open.then(|| self.value(Some(now)))
    }

    /// Returns true while the server is still to name conditions.
    pub(in crate::source) fn awaits_conditions(&self) -> bool {
        self.is_of_conditions() && self.conditions.is_unsettled()
    }

    fn value(&mut self, time: Option<DateTime>) -> DataValue {
        let value = self.conditions.value(&self.selection().value);
        let status = self.conditions.status();
        self.said = Some((value.clone(), status));
        DataValue { value, status, source_timestamp: time, ..DataValue::default() }
    }
}

fn take_field(fields: EventFields) -> Reaction {
    let (time, mut others) = (fields.time, fields.others);
    let value = match others.next().unwrap_or_default() {
        // An event of a type without the field, which says nothing of it.
        Variant::Null => return Reaction::Nothing,
        // A field may be a status in the place of its value (OPC 10000-4 §7.25.3).
        Variant::Scalar(Scalar::StatusCode(status)) if status.is_bad() => {
            DataValue::status_only(status, time)
        }
        value => DataValue {
            value,
            status: StatusCode::GOOD,
            source_timestamp: time,
            ..DataValue::default()
        },
    };
    Reaction::Value(value)
}

#[cfg(test)]
mod tests;
