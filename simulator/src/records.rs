//! Records of a machine that outlive its server: conditions and past values.

use std::collections::{HashMap, VecDeque};

use asi_model::{DataValue, DateTime};
use indexmap::IndexMap;
use parking_lot::Mutex;

use crate::MachineCondition;

/// Most past values of a variable.
const VALUES_MAX: usize = 10_000;

#[derive(Default)]
pub(crate) struct MachineRecords {
    /// The newest state of each condition by its name, with the time of its last change.
    conditions: Mutex<IndexMap<String, (MachineCondition, DateTime)>>,
    /// Past values by the key of their variable, oldest first.
    values: Mutex<HashMap<String, VecDeque<DataValue>>>,
}

impl MachineRecords {
    /// Sets the state of a condition.
    pub(crate) fn set_condition(&self, name: &str, condition: MachineCondition, at: DateTime) {
        self.conditions.lock().insert(name.to_owned(), (condition, at));
    }

    /// Returns the conditions that people should know of.
    pub(crate) fn retained(&self) -> Vec<(String, MachineCondition, DateTime)> {
        let conditions = self.conditions.lock();
        let retained = conditions.iter().filter(|(_, (condition, _))| condition.is_retained());
        retained.map(|(name, (condition, at))| (name.clone(), condition.clone(), *at)).collect()
    }

    /// Records a value of a variable whose history is kept.
    pub(crate) fn record(&self, key: &str, value: DataValue) {
        let mut values = self.values.lock();
        let values = values.entry(key.to_owned()).or_default();
        if values.len() >= VALUES_MAX {
            values.pop_front();
        }
        values.push_back(value);
    }

    /// Returns up to `count` values from `start` until before `end`, oldest first, and the time of the next one.
    pub(crate) fn values(
        &self,
        key: &str,
        start: DateTime,
        end: Option<DateTime>,
        count: usize,
    ) -> (Vec<DataValue>, Option<DateTime>) {
        let values = self.values.lock();
        let time = |value: &DataValue| value.source_timestamp.unwrap_or_default();
        let in_range =
            |value: &&DataValue| time(value) >= start && end.is_none_or(|end| time(value) < end);
        let mut found = values.get(key).into_iter().flatten().filter(in_range);
        let page: Vec<_> = found.by_ref().take(count).cloned().collect();
        (page, found.next().map(time))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn past_values_come_in_pages() {
        let records = MachineRecords::default();
        let at = DateTime::from_ticks;
        for ticks in 1..=5 {
            records.record("Counter", DataValue::good(ticks, at(ticks)));
        }
        let times = |(page, next): (Vec<DataValue>, Option<DateTime>)| {
            let times = page.iter().map(|value| value.source_timestamp.map_or(0, DateTime::ticks));
            (times.collect::<Vec<_>>(), next.map(DateTime::ticks))
        };
        assert_eq!(times(records.values("Counter", at(2), None, 2)), (vec![2, 3], Some(4)));
        assert_eq!(times(records.values("Counter", at(4), None, 2)), (vec![4, 5], None));
        assert_eq!(times(records.values("Counter", at(2), Some(at(4)), 9)), (vec![2, 3], None));
        assert_eq!(times(records.values("Other", at(1), None, 9)), (vec![], None));
    }
}
