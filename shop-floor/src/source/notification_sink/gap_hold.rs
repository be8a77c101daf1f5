//! Values that wait for those that came before them, which are read from the server's history.

use std::collections::VecDeque;

use asi_model::values::{DataValue, DateTime};

/// Most values of one item that wait; the oldest of more are dropped.
const WAITING_MAX: usize = 1000;

/// Values of an item that wait until those of the gap before them are there.
#[derive(Debug)]
pub(super) struct GapHold {
    /// Time of the last value before the gap.
    since: DateTime,
    /// The values of the gap, once they are read.
    past: Option<Vec<DataValue>>,
    is_complete: bool,
    live: VecDeque<DataValue>,
}

/// Gap of an input that was filled from the server's history.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::source) struct FilledGap {
    pub(in crate::source) values: u64,
    /// Time of the last value before the gap.
    pub(in crate::source) since: DateTime,
    /// False where values may be missing: there were more than are read.
    pub(in crate::source) is_complete: bool,
}

impl GapHold {
    pub(super) fn new(since: DateTime) -> Self {
        Self { since, past: None, is_complete: true, live: VecDeque::new() }
    }

    /// Lets a value of now wait.
    pub(super) fn wait(&mut self, value: DataValue) {
        if self.live.len() >= WAITING_MAX {
            self.live.pop_front();
            self.is_complete = false;
        }
        self.live.push_back(value);
    }

    /// Sets the values of the gap, oldest first, unless they are there.
    pub(super) fn fill(&mut self, past: Vec<DataValue>, is_complete: bool) {
        if self.past.is_none() {
            self.past = Some(past);
            self.is_complete &= is_complete;
        }
    }

    /// Returns true once the values of the gap and one after it are there.
    pub(super) fn is_over(&self) -> bool {
        self.past.is_some() && !self.live.is_empty()
    }

    /// Returns all values in their order, and what was filled.
    pub(super) fn release(self) -> (Vec<DataValue>, Option<FilledGap>) {
        let Self { since, past, is_complete, live } = self;
        let first = live.front().and_then(|value| value.source_timestamp);
        let is_between = |value: &DataValue| {
            let at = value.source_timestamp;
            at > Some(since) && first.is_none_or(|first| at < Some(first))
        };
        let mut values: Vec<_> = past.into_iter().flatten().filter(is_between).collect();
        let count = values.len() as u64;
        let filled = (count > 0).then_some(FilledGap { values: count, since, is_complete });
        values.extend(live);
        (values, filled)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(ticks: i64) -> DataValue {
        DataValue::good(ticks, DateTime::from_ticks(ticks))
    }

    fn hold(past: Option<&[i64]>, live: &[i64]) -> GapHold {
        let mut hold = GapHold::new(DateTime::from_ticks(10));
        if let Some(past) = past {
            hold.fill(past.iter().map(|ticks| value(*ticks)).collect(), true);
        }
        live.iter().for_each(|ticks| hold.wait(value(*ticks)));
        hold
    }

    fn times(values: &[DataValue]) -> Vec<i64> {
        values.iter().filter_map(|value| value.source_timestamp.map(DateTime::ticks)).collect()
    }

    #[test]
    fn past_values_come_before_those_of_now_and_none_twice() {
        assert!(!hold(None, &[40]).is_over(), "the past is awaited");
        assert!(!hold(Some(&[20]), &[]).is_over(), "where the gap ends is not known");
        let whole = hold(Some(&[10, 20, 30, 40]), &[40, 50]);
        assert!(whole.is_over());
        let (values, filled) = whole.release();
        assert_eq!(times(&values), [20, 30, 40, 50]);
        let since = DateTime::from_ticks(10);
        assert_eq!(filled, Some(FilledGap { values: 2, since, is_complete: true }));
    }

    #[test]
    fn a_gap_is_filled_once_and_one_without_values_is_not_said_to_be() {
        let mut once = hold(Some(&[20]), &[40]);
        once.fill(Vec::new(), false);
        assert_eq!(times(&once.release().0), [20, 40]);
        let (values, filled) = hold(Some(&[10]), &[11]).release();
        assert_eq!((times(&values), filled), (vec![11], None));
    }

    #[test]
    fn not_more_values_wait_than_are_allowed() {
        let most = i64::try_from(WAITING_MAX).expect("small");
        let live: Vec<i64> = (100..100 + 2 * most).collect();
        let (values, _) = hold(Some(&[]), &live).release();
        assert_eq!(times(&values), (100 + most..100 + 2 * most).collect::<Vec<_>>());
    }
}
