//! Which sequence numbers of a writer are held within an epoch.
//!
//! An epoch counts from zero. Numbers arrive in any order - after an outage the newest first, the
//! backlog behind it - and may repeat; some never come, which the connector announces. So what is
//! held is "all up to the highest, but for the missing ranges".

use std::collections::VecDeque;

use asi_model::messages::WriterReceipt;

/// The numbers held (or announced as a gap): all up to `through` but for the missing ranges.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct SequenceSet {
    through: Option<u32>,
    /// First and last of each missing range; ordered, apart, and below `through`.
    missing: VecDeque<(u32, u32)>,
}

/// Most missing numbers that one receipt lists per writer; a receipt with more would outgrow a
/// message.
const LISTED_MAX: usize = 1000;

impl SequenceSet {
    /// Nothing is held.
    #[must_use]
    pub const fn new() -> Self {
        Self { through: None, missing: VecDeque::new() }
    }

    /// From the store.
    #[must_use]
    pub fn from_stored(through: Option<u32>, missing: Vec<(u32, u32)>) -> Self {
        Self { through, missing: missing.into() }
    }

    /// The highest number held.
    #[must_use]
    pub const fn through(&self) -> Option<u32> {
        self.through
    }

    /// First and last of each missing range.
    #[must_use]
    pub const fn missing(&self) -> &VecDeque<(u32, u32)> {
        &self.missing
    }

    /// The missing numbers, lowest first. There may be very many: take as many as needed.
    pub fn missing_numbers(&self) -> impl Iterator<Item = u32> {
        self.missing.iter().flat_map(|(first, last)| *first..=*last)
    }

    /// How many numbers below the highest are missing.
    #[must_use]
    pub fn missing_count(&self) -> u64 {
        self.missing.iter().map(|(first, last)| u64::from(last - first) + 1).sum()
    }

    /// Whether a number is held.
    #[must_use]
    pub fn contains(&self, number: u32) -> bool {
        self.through.is_some_and(|through| number <= through) && self.range_of(number).is_err()
    }

    /// Adds a number. Says whether it is new.
    pub fn add(&mut self, number: u32) -> bool {
        self.add_range(number, number) > 0
    }

    /// Adds all numbers from `first` to `last`; how many of them are new.
    pub fn add_range(&mut self, first: u32, last: u32) -> u64 {
        if first > last {
            return 0;
        }
        let mut new = 0;
        let next = self.through.map_or(0, |through| u64::from(through) + 1);
        if u64::from(last) >= next {
            let next = u32::try_from(next).unwrap_or(u32::MAX);
            if first > next {
                self.missing.push_back((next, first - 1));
            }
            new += u64::from(last - first.max(next)) + 1;
            self.through = Some(last);
        }
        let mut kept = VecDeque::with_capacity(self.missing.len());
        for (from, to) in self.missing.drain(..) {
            if to < first || from > last {
                kept.push_back((from, to));
                continue;
            }
            new += u64::from(to.min(last) - from.max(first)) + 1;
            if from < first {
                kept.push_back((from, first - 1));
            }
            if to > last {
                kept.push_back((last + 1, to));
            }
        }
        self.missing = kept;
        new
    }

    /// What to tell the connector; nothing where nothing is held. Where more numbers are missing
    /// than a receipt lists, it tells only as far as the list reaches: a receipt never claims what
    /// is not held.
    #[must_use]
    pub fn receipt(&self, data_set_writer_id: u16, epoch: u32) -> Option<WriterReceipt> {
        let through = self.through?;
        let missing_list: Vec<u32> = self.missing_numbers().take(LISTED_MAX).collect();
        let through_sequence = match self.missing_numbers().nth(LISTED_MAX) {
            Some(unlisted) => unlisted.saturating_sub(1),
            None => through,
        };
        Some(WriterReceipt { data_set_writer_id, epoch, through_sequence, missing_list })
    }

    /// The missing range that contains the number.
    fn range_of(&self, number: u32) -> Result<usize, usize> {
        self.missing.binary_search_by(|(first, last)| {
            if number < *first {
                std::cmp::Ordering::Greater
            } else if number > *last {
                std::cmp::Ordering::Less
            } else {
                std::cmp::Ordering::Equal
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use proptest::prelude::*;

    use super::*;

    fn of(numbers: &[u32]) -> SequenceSet {
        let mut set = SequenceSet::new();
        for number in numbers {
            set.add(*number);
        }
        set
    }

    #[test]
    fn the_newest_first_and_the_backlog_behind_it() {
        let mut set = SequenceSet::new();
        assert!(set.add(5));
        assert_eq!(set.missing(), &[(0, 4)]);
        assert!(set.add(2));
        assert_eq!(set.missing(), &[(0, 1), (3, 4)]);
        assert!(!set.add(2) && !set.add(5));
        assert_eq!(set.add_range(0, 4), 4);
        assert_eq!((set.through(), set.missing_count()), (Some(5), 0));
    }

    #[test]
    fn gaps_may_lie_above_everything_held() {
        let mut set = of(&[0, 1]);
        assert_eq!(set.add_range(5, 9), 5);
        assert_eq!((set.through(), set.missing()), (Some(9), &VecDeque::from([(2, 4)])));
    }

    #[test]
    fn receipts_list_what_is_missing_and_never_claim_too_much() {
        assert_eq!(SequenceSet::new().receipt(1, 2), None);
        let receipt = of(&[0, 3]).receipt(1, 2).expect("something is held");
        assert_eq!((receipt.through_sequence, receipt.missing_list), (3, vec![1, 2]));
        let receipt = of(&[0, 5000]).receipt(1, 2).expect("something is held");
        assert_eq!(receipt.missing_list.len(), LISTED_MAX);
        assert_eq!(receipt.through_sequence, 1000, "1001 is missing and not listed");
    }

    #[test]
    fn the_whole_range_of_numbers_is_covered() {
        let mut set = of(&[u32::MAX]);
        assert_eq!(set.missing_count(), u64::from(u32::MAX));
        assert_eq!(set.add_range(0, u32::MAX), u64::from(u32::MAX));
        assert!(!set.add(u32::MAX) && !set.add(0));
    }

    proptest! {
        #[test]
        fn it_behaves_as_a_set(steps in proptest::collection::vec((0_u32..60, 0_u32..6), 0..60)) {
            let (mut set, mut model) = (SequenceSet::new(), BTreeSet::new());
            for (first, length) in steps {
                let new = (first..=first + length).filter(|number| model.insert(*number)).count();
                prop_assert_eq!(set.add_range(first, first + length), new as u64);
            }
            prop_assert_eq!(set.through(), model.last().copied());
            for number in 0..70 {
                prop_assert_eq!(set.contains(number), model.contains(&number));
            }
            if let Some(receipt) = set.receipt(1, 1) {
                for number in 0..=receipt.through_sequence {
                    prop_assert_eq!(receipt.missing_list.contains(&number), !model.contains(&number));
                }
            }
            let stored = SequenceSet::from_stored(set.through(), set.missing().iter().copied().collect());
            prop_assert_eq!(stored, set);
        }
    }
}
