//! One value per window of time, in place of every change within it.
//!
//! Windows are multiples of their length since 1970. A value counts as long as it held: the one
//! that held when a window began belongs to it as well. What comes out carries the window's
//! beginning as its source time, so that no time within the window leaves.

use std::time::Duration;

use asi_model::{BuiltInType, DataValue, DateTime, Scalar, StatusCode, Variant};
use serde::{Deserialize, Serialize};

use super::Decimal;

/// What is made of a window's values.
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
    /// The value that held at the window's end; for any type of field.
    Last,
    /// The greatest.
    Maximum,
    /// The least.
    Minimum,
    /// The sum of the values that came within the window; zero where none came.
    Sum,
    /// The mean over time: each value weighs as long as it held.
    Mean,
}

impl AggregateFunction {
    /// In words, as part of a sentence.
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
    /// What is made of a window's values.
    pub function: AggregateFunction,
    /// Length of a window in milliseconds.
    pub window_ms: u64,
}

impl WindowAggregate {
    /// The length of a window; never zero.
    #[must_use]
    pub fn window(self) -> Duration {
        Duration::from_millis(self.window_ms.max(1))
    }
}

/// What a gate remembers of the windows: the value that holds, and the window that is open.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Aggregation {
    /// The newest value.
    pub held: Option<DataValue>,
    /// The window whose end will publish something.
    pub open: Option<Box<OpenWindow>>,
}

/// A window that has not ended.
#[derive(Debug, Clone, PartialEq)]
pub struct OpenWindow {
    /// Its first instant.
    pub from: DateTime,
    /// From when the held value has not been weighed yet.
    pub weighed_until: DateTime,
    /// Sum of value times nanoseconds.
    pub weighted: f64,
    /// Nanoseconds that were weighed.
    pub weight: f64,
    /// The sum of what came, exact for integers.
    pub sum: Sum,
    /// The least.
    pub minimum: Option<Scalar>,
    /// The greatest.
    pub maximum: Option<Scalar>,
    /// A value in it was not Good.
    pub has_doubtful: bool,
}

/// A sum in the arithmetic of its field.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Sum {
    /// Of integers; `None` after an overflow.
    Exact(Option<i128>),
    /// Of fractions.
    Float(f64),
}

impl Aggregation {
    /// When the open window ends.
    pub fn ends_at(&self, aggregate: WindowAggregate) -> Option<DateTime> {
        self.open.as_ref().map(|open| open.from.after(aggregate.window()))
    }

    /// A value came at `now`; the window before has been closed.
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

    /// From `now` on the held value counts no more: what follows is withheld.
    pub fn pause(&mut self, now: DateTime) {
        if let Some(open) = &mut self.open {
            open.weigh(self.held.as_ref(), now);
        }
        self.held = None;
    }

    /// The clock was set back: what was gathered counts for the window that is open now.
    pub fn set_clock_back(&mut self, now: DateTime) {
        if let Some(open) = self.open.as_mut().filter(|open| open.from > now) {
            open.from = now;
            open.weighed_until = now;
        }
    }

    /// Ends the open window if it is over: its aggregate, and when it ended. A window that would
    /// say something else than this one though nothing comes is opened at once.
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
        let mut silent = idle.clone();
        silent.weigh(self.held.as_ref(), end.after(aggregate.window()));
        let next = silent.result(aggregate.function, self.held.as_ref(), field_type);
        if result.is_some() && next.is_some_and(|next| !says_the_same(&next, result.as_ref())) {
            idle.weighed_until = end;
            self.open = Some(Box::new(idle));
        }
        result.map(|value| (end, value))
    }
}

fn says_the_same(next: &DataValue, last: Option<&DataValue>) -> bool {
    let is_no_number = |value: &DataValue| value.value.as_f64().is_some_and(f64::is_nan);
    last.is_some_and(|last| {
        last.status == next.status
            && (last.value == next.value || (is_no_number(last) && is_no_number(next)))
    })
}

/// The scalar of a value that can be reckoned with.
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

    /// Lets the held value weigh until `now`.
    #[allow(clippy::cast_precision_loss)]
    fn weigh(&mut self, held: Option<&DataValue>, now: DateTime) {
        let duration = now.since(self.weighed_until).as_nanos() as f64;
        self.weighed_until = self.weighed_until.max(now);
        if let Some(number) = held.and_then(usable).and_then(Scalar::as_f64) {
            self.weighted += number * duration;
            self.weight += duration;
        }
    }

    /// Notes a value's status and whether it is the greatest or least so far.
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
        wanted: BuiltInType,
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
                (self.weight > 0.0).then(|| as_type(self.weighted / self.weight, wanted)).flatten()
            }
            AggregateFunction::Sum => match self.sum {
                Sum::Exact(sum) => match sum.and_then(|sum| Scalar::from_i128(sum, wanted)) {
                    Some(sum) => Some(sum),
                    None => {
                        return Some(DataValue::status_only(StatusCode::BAD_OUT_OF_RANGE, from));
                    }
                },
                Sum::Float(sum) => as_type(sum, wanted),
            },
        };
        match number {
            Some(number) => Some(of(Variant::Scalar(number))),
            // Nothing but Bad values: the newest says what is wrong.
            None => held.map(|held| DataValue::status_only(held.status, from)),
        }
    }
}

/// A number in the field's type, integers rounded to the nearest.
#[allow(clippy::cast_possible_truncation)]
fn as_type(number: f64, wanted: BuiltInType) -> Option<Scalar> {
    match wanted {
        BuiltInType::Double => Some(Scalar::Double(number)),
        BuiltInType::Float => Some(Scalar::Float(number as f32)),
        _ => {
            let whole = Decimal::from_f64(number.round())?.to_integer()?;
            Scalar::from_i128(whole, wanted)
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

    /// Values at milliseconds into windows of a second; what leaves by 3.5 s, with the second in
    /// which it leaves.
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
    fn windows_say_one_value_each() {
        use AggregateFunction as F;
        for (function, values, expected) in [
            (F::Last, &[(0, 1.0), (400, 5.0), (900, 2.0)][..], &[(1, 2.0)][..]),
            (F::Maximum, &[(0, 1.0), (400, 5.0), (900, 2.0)], &[(1, 5.0), (2, 2.0)]),
            (F::Minimum, &[(0, 3.0), (400, 1.0), (900, 2.0)], &[(1, 1.0), (2, 2.0)]),
            // A second of 2 in the first window's quarter, then 6: the mean weighs how long each
            // held.
            (F::Mean, &[(0, 2.0), (750, 6.0)], &[(1, 3.0), (2, 6.0)]),
            // A window in which nothing came sums to zero, and says so once.
            (F::Sum, &[(0, 2.0), (500, 3.0), (600, 5.0)], &[(1, 10.0), (2, 0.0)]),
            // The value that held when the window began belongs to it.
            (F::Maximum, &[(0, 9.0), (2500, 1.0)], &[(1, 9.0), (3, 9.0)]),
            (F::Mean, &[(0, 4.0), (2500, 8.0)], &[(1, 4.0), (3, 6.0)]),
        ] {
            assert_eq!(run(function, values), expected, "{function:?} of {values:?}");
        }
    }

    #[test]
    fn a_sum_that_does_not_fit_is_said_to_be_none() {
        let aggregate = WindowAggregate { function: AggregateFunction::Sum, window_ms: 1000 };
        let mut aggregation = Aggregation::default();
        for ms in [0, 1] {
            aggregation.take(aggregate, at(ms), DataValue::good(200_u8, at(ms)), BuiltInType::Byte);
        }
        let (_, value) = aggregation.close(aggregate, at(1000), BuiltInType::Byte).expect("closed");
        assert_eq!(value.status, StatusCode::BAD_OUT_OF_RANGE);
    }

    #[test]
    fn bad_values_do_not_count_but_show() {
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
