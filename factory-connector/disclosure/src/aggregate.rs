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
        if let Some(open) = self.open.as_mut().filter(|open| open.from > now) {
            open.from = now;
            open.weighed_until = now;
        }
    }

    /// Closes the open window if it is over. Returns its end and its aggregate. Opens the next window
    /// if its aggregate will differ though no candidate arrives.
    pub fn close(
        &mut self,
        aggregate: WindowAggregate,
        now: DateTime,
        field_type: BuiltInType,
    ) -> Option<(DateTime, DataValue)> {
        let end = self.ends_at(aggregate).filter(|end| *end <= now)?;
        let mut open = self.open.take()?;
        open.weigh(self.held.as_ref(), end);
        let result = open.result(aggregate.function, self.held.as_ref(), field_type);
        let mut idle = OpenWindow::new(end, self.held.as_ref(), field_type);
        // What the next window yields if no candidate comes: where that differs, it has to end by
        // itself.
        let mut silent = idle.clone();
        silent.weigh(self.held.as_ref(), end.after(aggregate.window()));
        let next = silent.result(aggregate.function, self.held.as_ref(), field_type);
        if result.is_some() && next.is_some_and(|next| !is_same(&next, result.as_ref())) {
            idle.weighed_until = end;
            self.open = Some(Box::new(idle));
        }
        result.map(|value| (end, value))
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
        let Some(scalar) = usable else { return };
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
mod tests {
    use super::*;

    fn at(ms: i64) -> DateTime {
        DateTime::from_unix_micros(1_800_000_000_000_000 + ms * 1_000)
    }

    /// Aggregates values at milliseconds over windows of a second. Returns the releases until 3.5 s,
    /// with their seconds.
    fn run(function: AggregateFunction, values: &[(i64, f64)]) -> Vec<(i64, f64)> {
        let aggregate = WindowAggregate { function, window_ms: 1000 };
        let mut aggregation = Aggregation::default();
        let mut left = Vec::new();
        let mut close = |aggregation: &mut Aggregation, now| {
            while let Some((end, value)) = aggregation.close(aggregate, now, BuiltInType::Double) {
                left.push((
                    (end.unix_millis() - at(0).unix_millis()) / 1000,
                    value.value.as_f64().expect("a number"),
                ));
            }
        };
        for (ms, value) in values {
            close(&mut aggregation, at(*ms));
            aggregation.take(
                aggregate,
                at(*ms),
                DataValue::good(*value, at(*ms)),
                BuiltInType::Double,
            );
        }
        close(&mut aggregation, at(3500));
        left
    }

    #[test]
    fn each_window_has_one_value() {
        use AggregateFunction as F;
        for (function, values, expected) in [
            (F::Last, &[(0, 1.0), (400, 5.0), (900, 2.0)][..], &[(1, 2.0)][..]),
            (F::Maximum, &[(0, 1.0), (400, 5.0), (900, 2.0)], &[(1, 5.0), (2, 2.0)]),
            (F::Minimum, &[(0, 3.0), (400, 1.0), (900, 2.0)], &[(1, 1.0), (2, 2.0)]),
            // 2 in the first quarter of the window, then 6: the mean is weighted with their times.
            (F::Mean, &[(0, 2.0), (750, 6.0)], &[(1, 3.0), (2, 6.0)]),
            // A window without a candidate has the sum zero, released once.
            (F::Sum, &[(0, 2.0), (500, 3.0), (600, 5.0)], &[(1, 10.0), (2, 0.0)]),
            // The value that is current when the window begins belongs to it.
            (F::Maximum, &[(0, 9.0), (2500, 1.0)], &[(1, 9.0), (3, 9.0)]),
            (F::Mean, &[(0, 4.0), (2500, 8.0)], &[(1, 4.0), (3, 6.0)]),
        ] {
            assert_eq!(run(function, values), expected, "{function:?} of {values:?}");
        }
    }

    #[test]
    fn a_sum_that_overflows_has_no_value() {
        let aggregate = WindowAggregate { function: AggregateFunction::Sum, window_ms: 1000 };
        let mut aggregation = Aggregation::default();
        for ms in [0, 1] {
            aggregation.take(aggregate, at(ms), DataValue::good(200_u8, at(ms)), BuiltInType::Byte);
        }
        let (_, value) = aggregation.close(aggregate, at(1000), BuiltInType::Byte).expect("closed");
        assert_eq!(value.status, StatusCode::BAD_OUT_OF_RANGE);
    }

    #[test]
    fn bad_values_do_not_count_but_their_status_shows() {
        let aggregate = WindowAggregate { function: AggregateFunction::Mean, window_ms: 1000 };
        let mut aggregation = Aggregation::default();
        let lost = DataValue::status_only(StatusCode::BAD_NO_DATA, Some(at(500)));
        aggregation.take(aggregate, at(0), DataValue::good(7_i32, at(0)), BuiltInType::Int32);
        aggregation.take(aggregate, at(500), lost, BuiltInType::Int32);
        let (_, value) =
            aggregation.close(aggregate, at(1000), BuiltInType::Int32).expect("closed");
        assert_eq!((value.value, value.status), (7_i32.into(), StatusCode::UNCERTAIN_SUB_NORMAL));
        let (_, value) =
            aggregation.close(aggregate, at(2000), BuiltInType::Int32).expect("closed");
        assert_eq!(value.status, StatusCode::BAD_NO_DATA);
    }
}
