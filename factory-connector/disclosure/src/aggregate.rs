//! Aggregation: one value per window of time instead of every change within it.
//!
//! Windows are multiples of their length since 1970. A value counts for as long as it is current; the
//! one that is current when a window begins belongs to it as well. The source time of an aggregate is
//! the beginning of its window, so that no time within the window is disclosed.

use std::time::Duration;

use asi_model::{BuiltInType, DataValue, DateTime, Scalar, StatusCode, Variant};
use serde::{Deserialize, Serialize};

use super::Decimal;

/// Function that aggregates a window's values.
#[derive(
    Debug,
    Clone,
    Copy,
    PartialEq,
    Eq,
    PartialOrd,
    Ord,
    Hash,
    Serialize,
    Deserialize,
    utoipa::ToSchema,
)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum AggregateFunction {
    /// The value that is current at the window's end; for any type of field.
    Last,
    /// The greatest value.
    Maximum,
    /// The least value.
    Minimum,
    /// The sum of the candidates within the window; zero when there is none.
    Sum,
    /// The mean over time: each value is weighted with the time for which it is current.
    Mean,
}

impl AggregateFunction {
    /// Returns a description, as part of a sentence.
    #[must_use]
    pub const fn describe(self) -> &'static str {
        match self {
            Self::Last => "the last value",
            Self::Maximum => "the maximum",
            Self::Minimum => "the minimum",
            Self::Sum => "the sum",
            Self::Mean => "the mean over time",
        }
    }
}

/// An aggregate over windows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct WindowAggregate {
    pub function: AggregateFunction,
    /// Length of a window in milliseconds.
    pub window_ms: u64,
}

impl WindowAggregate {
    /// Returns the length of a window; never zero.
    #[must_use]
    pub fn window(self) -> Duration {
        Duration::from_millis(self.window_ms.max(1))
    }
}

/// State of the aggregation: the current value, and the open window.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Aggregation {
    /// Value that holds until the next candidate; a mean weights it by this time.
    pub held: Option<DataValue>,
    /// The window whose end will release a value.
    pub open: Option<Box<OpenWindow>>,
    /// Time from which on values are aggregated: a window that began before it has no aggregate,
    /// for it would be one of a part of the window. None where every window counts.
    pub covered_from: Option<DateTime>,
}

/// A window that has not ended.
#[derive(Debug, Clone, PartialEq)]
pub struct OpenWindow {
    /// Its first instant.
    pub from: DateTime,
    /// Time up to which the current value was weighted.
    pub weighed_until: DateTime,
    /// Sum of value times nanoseconds.
    pub weighted: f64,
    /// Sum of the weights, in nanoseconds.
    pub weight: f64,
    /// Sum of the candidates, exact for integers.
    pub sum: Sum,
    /// The least value.
    pub minimum: Option<Scalar>,
    /// The greatest value.
    pub maximum: Option<Scalar>,
    /// True when a value in it was not Good.
    pub has_doubtful: bool,
}

/// A sum in the arithmetic of its field.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Sum {
    /// Sum of integers; `None` after an overflow.
    Exact(Option<i128>),
    /// Sum of floating-point numbers.
    Float(f64),
}

impl Aggregation {
    /// Begins without values: of the windows from then on those count that are covered whole.
    #[must_use]
    pub fn begin(now: DateTime) -> Self {
        Self { covered_from: Some(now), ..Self::default() }
    }

    /// Returns the end of the open window.
    pub fn ends_at(&self, aggregate: WindowAggregate) -> Option<DateTime> {
        self.open.as_ref().map(|open| open.from.after(aggregate.window()))
    }

    /// Adds a candidate at `now`; the window before it has been closed.
    pub fn take(
        &mut self,
        aggregate: WindowAggregate,
        now: DateTime,
        value: DataValue,
        field_type: BuiltInType,
    ) {
        let from = now.floor_to(aggregate.window());
        let open = self
            .open
            .get_or_insert_with(|| Box::new(OpenWindow::new(from, self.held.as_ref(), field_type)));
        open.weigh(self.held.as_ref(), now);
        open.count(&value);
        open.add(&value);
        self.held = Some(value);
    }

    /// Stops the current value from counting from `now` on: the following time is withheld.
    pub fn pause(&mut self, now: DateTime) {
        if let Some(open) = &mut self.open {
            open.weigh(self.held.as_ref(), now);
        }
        self.held = None;
    }

    /// Corrects the state after the clock was set back: the open window counts as the present one.
    pub fn set_clock_back(&mut self, now: DateTime) {
        self.covered_from = self.covered_from.map(|from| from.min(now));
        if let Some(open) = self.open.as_mut().filter(|open| open.from > now) {
            open.from = now;
            open.weighed_until = now;
        }
    }

    /// Closes the open window if it is over. Returns its end and its aggregate. Opens the next window
    /// if its aggregate will differ though no candidate arrives. Passes over windows without an
    /// aggregate.
    pub fn close(
        &mut self,
        aggregate: WindowAggregate,
        now: DateTime,
        field_type: BuiltInType,
    ) -> Option<(DateTime, DataValue)> {
        loop {
            let end = self.ends_at(aggregate).filter(|end| *end <= now)?;
            if let Some(value) = self.close_window(aggregate, end, field_type) {
                return Some((end, value));
            }
        }
    }

    fn close_window(
        &mut self,
        aggregate: WindowAggregate,
        end: DateTime,
        field_type: BuiltInType,
    ) -> Option<DataValue> {
        let mut open = self.open.take()?;
        open.weigh(self.held.as_ref(), end);
        let is_whole = self.covered_from.is_none_or(|from| from <= open.from);
        let result =
            open.result(aggregate.function, self.held.as_ref(), field_type).filter(|_| is_whole);
        let mut idle = OpenWindow::new(end, self.held.as_ref(), field_type);
        // What the next window yields if no candidate comes: where that differs, it has to end by
        // itself.
        let mut silent = idle.clone();
        silent.weigh(self.held.as_ref(), end.after(aggregate.window()));
        let next = silent.result(aggregate.function, self.held.as_ref(), field_type);
        if next.is_some_and(|next| !is_same(&next, result.as_ref())) {
            idle.weighed_until = end;
            self.open = Some(Box::new(idle));
        }
        result
    }
}

fn is_same(next: &DataValue, last: Option<&DataValue>) -> bool {
    // NaN is unequal to itself, so one window would follow the other for ever.
    let is_no_number = |value: &DataValue| value.value.as_f64().is_some_and(f64::is_nan);
    last.is_some_and(|last| {
        last.status == next.status
            && (last.value == next.value || (is_no_number(last) && is_no_number(next)))
    })
}

/// Returns the scalar of a value that can be aggregated.
fn usable(value: &DataValue) -> Option<&Scalar> {
    let is_finite = |scalar: &&Scalar| scalar.as_f64().is_none_or(f64::is_finite);
    value.value.as_scalar().filter(|_| !value.status.is_bad()).filter(is_finite)
}

impl OpenWindow {
    fn new(from: DateTime, held: Option<&DataValue>, field_type: BuiltInType) -> Self {
        let sum = if field_type.is_integer() { Sum::Exact(Some(0)) } else { Sum::Float(0.0) };
        let mut window = Self {
            from,
            weighed_until: from,
            weighted: 0.0,
            weight: 0.0,
            sum,
            minimum: None,
            maximum: None,
            has_doubtful: false,
        };
        if let Some(held) = held {
            window.count(held);
        }
        window
    }

    /// Adds the weight of the current value until `now`.
    #[allow(clippy::cast_precision_loss)]
    fn weigh(&mut self, held: Option<&DataValue>, now: DateTime) {
        let duration = now.since(self.weighed_until).as_nanos() as f64;
        self.weighed_until = self.weighed_until.max(now);
        if let Some(number) = held.and_then(usable).and_then(Scalar::as_f64) {
            self.weighted += number * duration;
            self.weight += duration;
        }
    }

    /// Updates status, minimum and maximum with a value.
    fn count(&mut self, value: &DataValue) {
        let usable = usable(value);
        self.has_doubtful |= usable.is_none() || !value.status.is_good();
        // Others have no order, and their extremes no meaning.
        let Some(scalar) = usable.filter(|scalar| scalar.as_f64().is_some()) else { return };
        if self.minimum.as_ref().is_none_or(|least| is_less(scalar, least)) {
            self.minimum = Some(scalar.clone());
        }
        if self.maximum.as_ref().is_none_or(|most| is_less(most, scalar)) {
            self.maximum = Some(scalar.clone());
        }
    }

    fn add(&mut self, value: &DataValue) {
        let Some(scalar) = usable(value) else { return };
        match &mut self.sum {
            Sum::Exact(sum) => {
                *sum = sum.zip(scalar.as_i128()).and_then(|(sum, value)| sum.checked_add(value))
            }
            Sum::Float(sum) => *sum += scalar.as_f64().unwrap_or(0.0),
        }
    }

    fn result(
        &self,
        function: AggregateFunction,
        held: Option<&DataValue>,
        target: BuiltInType,
    ) -> Option<DataValue> {
        let from = Some(self.from);
        let of = |value: Variant| {
            let status =
                if self.has_doubtful { StatusCode::UNCERTAIN_SUB_NORMAL } else { StatusCode::GOOD };
            DataValue { value, status, source_timestamp: from, ..DataValue::default() }
        };
        let number = match function {
            AggregateFunction::Last => {
                let held = held?;
                let (value, status) = (held.value.clone(), held.status);
                return Some(DataValue {
                    value,
                    status,
                    source_timestamp: from,
                    ..DataValue::default()
                });
            }
            AggregateFunction::Maximum => self.maximum.clone(),
            AggregateFunction::Minimum => self.minimum.clone(),
            AggregateFunction::Mean => {
                (self.weight > 0.0).then(|| as_type(self.weighted / self.weight, target)).flatten()
            }
            AggregateFunction::Sum => match self.sum {
                Sum::Exact(sum) => match sum.and_then(|sum| Scalar::from_i128(sum, target)) {
                    Some(sum) => Some(sum),
                    None => {
                        return Some(DataValue::status_only(StatusCode::BAD_OUT_OF_RANGE, from));
                    }
                },
                Sum::Float(sum) => as_type(sum, target),
            },
        };
        match number {
            Some(number) => Some(of(Variant::Scalar(number))),
            // Only Bad values: the newest one has the cause.
            None => held.map(|held| DataValue::status_only(held.status, from)),
        }
    }
}

/// Converts a number to the field's type; integers are rounded to the nearest.
#[allow(clippy::cast_possible_truncation)]
fn as_type(number: f64, target: BuiltInType) -> Option<Scalar> {
    match target {
        BuiltInType::Double => Some(Scalar::Double(number)),
        BuiltInType::Float => Some(Scalar::Float(number as f32)),
        _ => {
            let whole = Decimal::from_f64(number.round())?.to_integer()?;
            Scalar::from_i128(whole, target)
        }
    }
}

fn is_less(left: &Scalar, right: &Scalar) -> bool {
    match (left.as_i128(), right.as_i128()) {
        (Some(left), Some(right)) => left < right,
        _ => left.as_f64().zip(right.as_f64()).is_some_and(|(left, right)| left < right),
    }
}

#[cfg(test)]
mod tests;
