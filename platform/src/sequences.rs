//! Set of received sequence numbers of one data set writer within an epoch. Pure.
//!
//! An epoch counts from zero. Numbers arrive in any order (after an outage the newest first, the
//! backlog behind it) and may repeat; some never come, which the connector announces as a gap. So
//! the set is stored as "all up to the highest, except the missing ranges". A sender that leaves a hole
//! behind each number would make that long without end, so beyond a bound the oldest ranges become one
//! coarse range with what lies between them: it counts as missing, though some of it is held. So no
//! receipt ever claims an absent number, and what is sent again is found in the store.

use asi_model::messages::WriterReceipt;

/// Numbers received or announced as a gap: all up to `through` except the missing ranges.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct SequenceSet {
    through: Option<u32>,
    /// First and last of each missing range; ordered, apart, and not above `through`.
    missing: Vec<(u32, u32)>,
    /// Highest number of the coarse range that there was; absent where all ranges are exact.
    coarse_through: Option<u32>,
}

/// Most missing ranges of a set. A connector that lost its link a hundred times in an epoch leaves some
/// hundred.
pub const RANGES_MAX: usize = 1_000;

/// Missing numbers that one receipt lists per writer at most; a receipt with more would exceed the
/// largest message.
const LISTED_MAX: usize = 1000;

impl SequenceSet {
    /// Returns the empty set.
    #[must_use]
    pub const fn new() -> Self {
        Self { through: None, missing: Vec::new(), coarse_through: None }
    }

    /// Returns the set that [`through`](Self::through), [`missing`](Self::missing) and
    /// [`coarse_through`](Self::coarse_through) gave.
    #[must_use]
    pub const fn from_stored(
        through: Option<u32>,
        missing: Vec<(u32, u32)>,
        coarse_through: Option<u32>,
    ) -> Self {
        Self { through, missing, coarse_through }
    }

    /// Returns the number up to which ranges were merged; absent where all of them are exact.
    #[must_use]
    pub const fn coarse_through(&self) -> Option<u32> {
        self.coarse_through
    }

    /// Returns true where the number counts as missing and may be held all the same.
    #[must_use]
    pub fn is_uncertain(&self, number: u32) -> bool {
        self.coarse_through.is_some_and(|coarse| number <= coarse) && !self.contains(number)
    }

    /// Returns the highest number; none when the set is empty.
    #[must_use]
    pub const fn through(&self) -> Option<u32> {
        self.through
    }

    /// Returns the part of the set between two numbers that are in it; no number below is missing.
    #[must_use]
    pub fn between(&self, first: u32, through: u32) -> Self {
        let missing = self.missing.iter().copied();
        let inside = missing.filter(|(from, _)| (first..through).contains(from));
        let coarse = self.coarse_through.filter(|coarse| *coarse >= first);
        let coarse_through = coarse.map(|coarse| coarse.min(through));
        Self { through: Some(through), missing: inside.collect(), coarse_through }
    }

    /// Returns the part of the set up to a number, without a word about what is missing.
    #[must_use]
    pub const fn complete(through: u32) -> Self {
        Self { through: Some(through), missing: Vec::new(), coarse_through: None }
    }

    /// Returns first and last of each missing range, ascending.
    #[must_use]
    pub fn missing(&self) -> &[(u32, u32)] {
        &self.missing
    }

    /// Iterates over the missing numbers, ascending. There may be four billion: take a bounded part.
    pub fn missing_numbers(&self) -> impl Iterator<Item = u32> {
        self.missing.iter().flat_map(|(first, last)| *first..=*last)
    }

    /// Counts the missing numbers below the highest.
    #[must_use]
    pub fn missing_count(&self) -> u64 {
        self.missing.iter().map(|(first, last)| u64::from(last - first) + 1).sum()
    }

    /// Returns true if the number is in the set.
    #[must_use]
    pub fn contains(&self, number: u32) -> bool {
        self.through.is_some_and(|through| number <= through) && self.range_of(number).is_err()
    }

    /// Adds a number; returns true if it is new.
    pub fn add(&mut self, number: u32) -> bool {
        self.add_range(number, number) > 0
    }

    /// Adds all numbers from `first` to `last`; returns how many of them are new. Of uncertain numbers,
    /// the caller knows better.
    pub fn add_range(&mut self, first: u32, last: u32) -> u64 {
        if first > last {
            return 0;
        }
        let mut new = 0;
        let next = self.through.map_or(0, |through| u64::from(through) + 1);
        if u64::from(last) >= next {
            let next = u32::try_from(next).unwrap_or(u32::MAX);
            if first > next {
                self.missing.push((next, first - 1));
            }
            new += u64::from(last - first.max(next)) + 1;
            self.through = Some(last);
        }
        // The ranges that these numbers touch stand beside each other.
        let begin = self.missing.partition_point(|(_, to)| *to < first);
        let end = self.missing.partition_point(|(from, _)| *from <= last);
        if let [(from, mut to), ..] = self.missing[begin..end] {
            for (from, last_of_range) in &self.missing[begin..end] {
                new += u64::from(last.min(*last_of_range) - first.max(*from)) + 1;
                to = *last_of_range;
            }
            let before = (from < first).then(|| (from, first - 1));
            let behind = (to > last).then(|| (last + 1, to));
            self.missing.splice(begin..end, before.into_iter().chain(behind));
        }
        self.merge_oldest();
        new
    }

    /// Notes that the numbers up to this one were given: those that did not arrive are missing.
    pub fn expect_through(&mut self, number: u32) {
        let next = self.through.map_or(0, |through| u64::from(through) + 1);
        if u64::from(number) < next {
            return;
        }
        self.missing.push((u32::try_from(next).unwrap_or(u32::MAX), number));
        self.through = Some(number);
        self.merge_oldest();
    }

    /// Merges old ranges with what lies between them, down to the bound. What is coarse grows upwards: so
    /// a number that arrives below it stays in the set.
    fn merge_oldest(&mut self) {
        while self.missing.len() > RANGES_MAX {
            let coarse = self.coarse_through.unwrap_or(0);
            let begun = self.missing.partition_point(|(from, _)| *from <= coarse);
            let lower = begun.saturating_sub(1).min(self.missing.len() - 2);
            let (_, last) = self.missing.remove(lower + 1);
            self.missing[lower].1 = last;
            self.coarse_through = self.coarse_through.max(Some(last));
        }
    }

    /// Returns the ranges from `first` to `last` that are not in the set, ascending.
    #[must_use]
    pub fn absent(&self, first: u32, last: u32) -> Vec<(u32, u32)> {
        let beyond = match self.through {
            None => Some((first, last)),
            Some(through) if through < last => Some((first.max(through + 1), last)),
            Some(_) => None,
        };
        let missing = self.missing.iter().map(|(from, to)| (first.max(*from), last.min(*to)));
        missing.chain(beyond).filter(|(from, to)| from <= to).collect()
    }

    /// Returns the receipt for the connector; none when the set is empty. If more numbers are missing
    /// than a receipt lists, it ends where the list ends: a receipt never claims an absent number.
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

    /// Finds the missing range that contains the number, or the position to insert one at.
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

    #[test]
    fn a_part_has_no_word_about_what_is_outside() {
        let set = of(&[2, 3, 6, 9]);
        let part = set.between(3, 6);
        assert_eq!((part.through(), part.missing_numbers().collect()), (Some(6), vec![4, 5]));
        assert_eq!(set.between(0, 2).missing_numbers().collect::<Vec<_>>(), [0, 1]);
        assert_eq!(SequenceSet::complete(6).missing_count(), 0);
    }

    fn of(numbers: &[u32]) -> SequenceSet {
        let mut set = SequenceSet::new();
        for number in numbers {
            set.add(*number);
        }
        set
    }

    #[test]
    fn a_backlog_fills_the_ranges_below_the_newest() {
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
    fn gaps_may_extend_beyond_the_highest_number() {
        let mut set = of(&[0, 1]);
        assert_eq!(set.add_range(5, 9), 5);
        assert_eq!((set.through(), set.missing()), (Some(9), &[(2, 4)][..]));
    }

    #[test]
    fn receipts_list_what_is_missing_and_never_claim_too_much() {
        assert_eq!(SequenceSet::new().receipt(1, 2), None);
        let receipt = of(&[0, 3]).receipt(1, 2).expect("not empty");
        assert_eq!((receipt.through_sequence, receipt.missing_list), (3, vec![1, 2]));
        let receipt = of(&[0, 5000]).receipt(1, 2).expect("not empty");
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

    #[test]
    fn a_sender_that_leaves_holes_costs_a_bounded_number_of_ranges() {
        let mut set = SequenceSet::new();
        // Every other number: a hole behind each.
        for number in 0..20_000 {
            assert!(set.add(2 * number + 1));
        }
        assert_eq!(set.missing().len(), RANGES_MAX);
        for number in 0..20_000 {
            assert!(!set.contains(2 * number), "{number} is absent, and nothing claims it");
        }
        let coarse = set.coarse_through().expect("the oldest were merged");
        assert!(set.contains(coarse + 1) && !set.contains(coarse));
        assert_eq!((set.is_uncertain(1), set.is_uncertain(coarse + 2)), (true, false));
        let receipt = set.receipt(1, 1).expect("not empty");
        assert_eq!(receipt.missing_list.len(), LISTED_MAX);
        assert_eq!(
            set.add_range(0, coarse),
            u64::from(coarse) + 1,
            "a gap closes the coarse range"
        );
        assert_eq!(set.missing().len(), RANGES_MAX - 1);
        assert!(!set.is_uncertain(1));
    }

    #[test]
    fn numbers_that_were_given_and_did_not_arrive_are_missing() {
        let mut set = of(&[0, 1]);
        set.expect_through(1);
        assert_eq!((set.through(), set.missing_count()), (Some(1), 0), "nothing new");
        set.expect_through(4);
        let receipt = set.receipt(1, 2).expect("not empty");
        assert_eq!((receipt.through_sequence, receipt.missing_list), (4, vec![2, 3, 4]));
        assert!(set.add(4) && !set.contains(3) && set.add(5));
        assert_eq!((set.through(), set.missing()), (Some(5), &[(2, 3)][..]));
        let mut set = SequenceSet::new();
        set.expect_through(u32::MAX);
        assert_eq!((set.missing_count(), set.add_range(0, u32::MAX)), (1 << 32, 1 << 32));
    }

    proptest! {
        #[test]
        fn it_behaves_as_a_set(steps in proptest::collection::vec((0_u32..60, 0_u32..6), 0..60)) {
            let (mut set, mut model) = (SequenceSet::new(), BTreeSet::new());
            for (first, length) in steps {
                let new = (first..=first + length).filter(|number| model.insert(*number)).count();
                let absent = set.absent(first, first + length);
                let absent: u64 = absent.iter().map(|(from, to)| u64::from(to - from) + 1).sum();
                prop_assert_eq!(absent, new as u64);
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
            let stored = SequenceSet::from_stored(set.through(), set.missing().to_vec(), set.coarse_through());
            prop_assert_eq!(stored, set);
        }
    }
}
