//! Aggregates over the last values or the last span of time.
//!
//! Samples are ordered by the source's time. What leaves a window of time is judged by the source's
//! clock when a value comes, and by ours counted from the arrival of the newest sample when none
//! comes, so that a source whose clock is off by hours has the same window as any other.

use std::time::Duration;

use asi_model::{DateTime, Variant};

use super::{
    flow::{Applied, Flow},
    operand::number,
    plan::Span,
};
use crate::{
    document::Aggregate,
    number::Number,
    quality::{Meta, worst},
    state::{Sample, WindowState},
};

/// Most samples a window keeps.
pub(super) const SAMPLES_MAX: usize = 4096;

impl Aggregate {
    /// A variable that does not change still has its value: only what is counted or summed empties.
    const fn keeps_newest(self) -> bool {
        !matches!(self, Self::Count | Self::Sum)
    }
}

/// Adds a value and yields the aggregate.
pub(super) fn push(
    aggregate: Aggregate,
    span: Span,
    window: &mut WindowState,
    flow: Flow,
    now: DateTime,
) -> Applied {
    let Flow { value, meta } = flow;
    // `count` counts whatever comes.
    let value = match number(&value) {
        Ok(number) => number,
        Err(_) if aggregate == Aggregate::Count => Number::ZERO,
        Err(fault) => return Applied::Fail(fault, meta),
    };
    let sample = Sample { at: meta.source_timestamp.unwrap_or(now), value, status: meta.status };
    let position = window
        .samples
        .iter()
        .rposition(|other| other.at <= sample.at)
        .map_or(0, |before| before + 1);
    // Only the newest sample sets the time of the window; a late one says nothing about the
    // present.
    if position == window.samples.len() {
        window.received_at = now;
    }
    window.samples.insert(position, sample);
    let keep = match span {
        Span::Samples(count) => count.min(SAMPLES_MAX),
        Span::Time(_) => SAMPLES_MAX,
    };
    while window.samples.len() > keep {
        window.samples.pop_front();
    }
    if let (Span::Time(duration), Some(newest)) =
        (span, window.samples.back().map(|sample| sample.at))
    {
        drop_older(aggregate, window, newest, duration);
    }
    yielded(aggregate, window, meta)
}

/// Returns the time at which the oldest sample leaves, by the local clock.
pub(super) fn due(aggregate: Aggregate, span: Span, window: &WindowState) -> Option<DateTime> {
    let Span::Time(duration) = span else { return None };
    let (oldest, newest) = (window.samples.front()?, window.samples.back()?);
    if aggregate.keeps_newest() && window.samples.len() == 1 {
        return None;
    }
    // The oldest is younger than the duration against the newest, so this lies after the newest's
    // arrival.
    let age_at_arrival = newest.at.since(oldest.at);
    Some(window.received_at.after(duration.saturating_sub(age_at_arrival)))
}

/// Time passed without a value.
pub(super) fn expire(
    aggregate: Aggregate,
    span: Span,
    window: &mut WindowState,
    now: DateTime,
) -> Applied {
    let (Span::Time(duration), Some(newest)) = (span, window.samples.back().copied()) else {
        return Applied::Hold;
    };
    // By the clock of the source, which may be wrong: of the local one only the time that passed is
    // used.
    let source_now = newest.at.after(now.since(window.received_at));
    drop_older(aggregate, window, source_now, duration);
    let meta = Meta { status: newest.status, source_timestamp: Some(newest.at), ..Meta::default() };
    yielded(aggregate, window, meta)
}

fn drop_older(
    aggregate: Aggregate,
    window: &mut WindowState,
    newest: DateTime,
    duration: Duration,
) {
    let least = usize::from(aggregate.keeps_newest());
    while window.samples.len() > least
        && window.samples.front().is_some_and(|oldest| newest.since(oldest.at) >= duration)
    {
        window.samples.pop_front();
    }
}

fn yielded(aggregate: Aggregate, window: &WindowState, mut meta: Meta) -> Applied {
    meta.status =
        window.samples.iter().fold(meta.status, |status, sample| worst(status, sample.status));
    if let Some(newest) = window.samples.back()
        && meta.source_timestamp.is_some_and(|at| at < newest.at)
    {
        meta.source_timestamp = Some(newest.at);
    }
    match compute(aggregate, window) {
        Some(value) => Applied::Pass(Flow { value, meta }),
        None => Applied::Hold,
    }
}

fn compute(aggregate: Aggregate, window: &WindowState) -> Option<Variant> {
    let values = window.samples.iter().map(|sample| sample.value);
    let best = |a: Number, b: Number, takes_b: bool| if takes_b { b } else { a };
    let number = match aggregate {
        Aggregate::Minimum => values.reduce(|a, b| best(a, b, b < a))?,
        Aggregate::Maximum => values.reduce(|a, b| best(a, b, b > a))?,
        Aggregate::Last => window.samples.back()?.value,
        Aggregate::Count => Number::Integer(i128::try_from(window.samples.len()).ok()?),
        Aggregate::Sum => sum(values),
        #[allow(clippy::cast_precision_loss)]
        Aggregate::Mean if window.samples.is_empty() => return None,
        #[allow(clippy::cast_precision_loss)]
        Aggregate::Mean => Number::Real(sum(values).as_f64() / window.samples.len() as f64),
    };
    Some(number.to_scalar().into())
}

/// 4096 integers of 64 bits stay within 128; should a chain have made larger ones, the sum goes on
/// as double.
fn sum(values: impl Iterator<Item = Number>) -> Number {
    values.fold(Number::ZERO, |sum, value| {
        sum.plus(value).unwrap_or(Number::Real(sum.as_f64() + value.as_f64()))
    })
}
