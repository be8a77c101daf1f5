//! Last values of each variable in use, for dry runs.
//!
//! Kept in memory and bounded twice: per variable, and over all of them. With many variables each
//! has fewer. Some outlast a restart, if the engine's owner stores them.

use std::collections::VecDeque;

use asi_model::{DataValue, DateTime, Scalar, Variant};
use serde::{Deserialize, Serialize};

/// Longest array, in elements, and longest text, in bytes, of which more than the newest is kept.
/// The limit on samples would otherwise not bound memory.
const ELEMENTS_MAX: usize = 64;
const TEXT_BYTES_MAX: usize = 1024;
/// Fewest recorded values of each variable, beyond the limit of all if need be.
const SAMPLES_MIN: usize = 2;

/// Limits of the recorded values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", default, deny_unknown_fields)]
pub struct HistoryConfig {
    /// Most values of one variable.
    pub values_per_variable_max: usize,
    /// Most values of all variables together; about 100 bytes each.
    pub values_max: usize,
    /// Most values of all variables together that outlast a restart.
    pub kept_values_max: usize,
}

impl Default for HistoryConfig {
    fn default() -> Self {
        Self { values_per_variable_max: 512, values_max: 500_000, kept_values_max: 20_000 }
    }
}

impl HistoryConfig {
    /// Returns the most values per variable for this number of variables: a power of two, because
    /// buffers grow by doubling.
    pub(super) fn share(&self, variables: usize) -> usize {
        let share =
            (self.values_max / variables.max(1)).min(self.values_per_variable_max).max(SAMPLES_MIN);
        1 << share.ilog2()
    }
}

/// The last values of a variable, oldest first, each with the time it came by the local clock.
#[derive(Debug, Default)]
pub(super) struct History {
    /// Values of before the start, until as many new ones have come. They are for dry runs alone: what a machine
    /// said then is not what it says.
    former: Box<[(DateTime, DataValue)]>,
    values: VecDeque<(DateTime, DataValue)>,
}

impl History {
    /// Returns a history that goes on with the values of before the start.
    pub fn after(former: Vec<(DateTime, DataValue)>) -> Self {
        Self { former: former.into_boxed_slice(), values: VecDeque::new() }
    }

    /// Returns the newest values, oldest first, at most `most`, of those that are not large.
    pub fn kept(&self, most: usize) -> Vec<(DateTime, DataValue)> {
        let small = self.iter().filter(|(_, value)| !is_bulky(&value.value));
        let surplus = small.clone().count().saturating_sub(most);
        small.skip(surplus).cloned().collect()
    }

    /// Returns the newest value since the start.
    pub fn newest(&self) -> Option<&DataValue> {
        self.values.back().map(|(_, value)| value)
    }

    /// Iterates from the oldest to the newest value.
    pub fn iter(&self) -> impl Iterator<Item = &(DateTime, DataValue)> + Clone {
        self.former.iter().chain(&self.values)
    }

    /// Records a value. Only the newest of long texts and arrays is stored.
    pub fn push(&mut self, at: DateTime, value: DataValue, values_max: usize) {
        if is_bulky(&value.value) {
            self.values.clear();
            self.former = Box::default();
        }
        if self.values.len() >= self.former.len() {
            self.former = Box::default();
        }
        while self.values.len() >= values_max.max(1) {
            self.values.pop_front();
        }
        if self.values.len() == self.values.capacity() {
            // Doubled from one on: where variables seldom change, most of them never have four
            // values.
            self.values.reserve_exact(self.values.len().max(1));
        }
        self.values.push_back((at, value));
        if self.values.capacity() > values_max.saturating_mul(2) {
            self.values.shrink_to(values_max);
        }
    }
}

fn is_bulky(value: &Variant) -> bool {
    match value {
        Variant::Null => false,
        Variant::Array(array) => array.elements.len() > ELEMENTS_MAX,
        Variant::Scalar(Scalar::String(text)) => {
            text.as_ref().is_some_and(|text| text.len() > TEXT_BYTES_MAX)
        }
        Variant::Scalar(Scalar::ByteString(bytes)) => {
            bytes.as_ref().is_some_and(|bytes| bytes.len() > TEXT_BYTES_MAX)
        }
        Variant::Scalar(_) => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(second: i64) -> DateTime {
        DateTime::from_unix_micros(second * 1_000_000)
    }

    #[test]
    fn the_last_values_are_kept() {
        let mut history = History::default();
        for number in 0..10_i64 {
            history.push(at(number), DataValue::good(number, at(number)), 4);
        }
        let kept: Vec<_> = history.iter().map(|(at, _)| at.unix_millis() / 1000).collect();
        assert_eq!(kept, [6, 7, 8, 9]);
        let text = "x".repeat(TEXT_BYTES_MAX + 1);
        history.push(at(10), DataValue::good(text.as_str(), at(10)), 4);
        assert_eq!(history.iter().count(), 1, "long texts are not piled up");
    }

    #[test]
    fn values_of_before_the_start_are_tried_on_and_never_the_newest() {
        let value = |number: i64| (at(number), DataValue::good(number, at(number)));
        let mut history = History::after((0..3).map(value).collect());
        assert_eq!((history.newest(), history.iter().count()), (None, 3));
        for number in 3..5 {
            let (at, value) = value(number);
            history.push(at, value, 4);
        }
        assert_eq!(history.newest(), Some(&value(4).1));
        assert_eq!(history.kept(3), [2, 3, 4].map(value));
        for number in 5..8 {
            let (at, value) = value(number);
            history.push(at, value, 4);
        }
        assert_eq!(history.kept(10), [4, 5, 6, 7].map(value), "the former ones have gone");
    }

    #[test]
    fn many_variables_share_what_there_is() {
        let config = HistoryConfig::default();
        assert_eq!([0, 10, 50_000, 10_000_000].map(|count| config.share(count)), [512, 512, 8, 2]);
    }
}
