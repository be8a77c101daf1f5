//! Set of sequence numbers, which mostly follow one another.

/// Ranges of numbers in ascending order that do not touch.
#[derive(Debug, Default)]
pub(super) struct Ranges(Vec<(u32, u32)>);

impl Ranges {
    /// Inserts a number; false where it was in the set.
    pub(super) fn insert(&mut self, number: u32) -> bool {
        let next = self.0.partition_point(|(_, last)| *last < number);
        if self.0.get(next).is_some_and(|(first, _)| *first <= number) {
            return false;
        }
        let follows = next > 0 && self.0[next - 1].1.checked_add(1) == Some(number);
        let precedes = self.0.get(next).is_some_and(|(first, _)| number + 1 == *first);
        match (follows, precedes) {
            (true, true) => self.0[next - 1].1 = self.0.remove(next).1,
            (true, false) => self.0[next - 1].1 = number,
            (false, true) => self.0[next].0 = number,
            (false, false) => self.0.insert(next, (number, number)),
        }
        true
    }

    /// Counts the numbers of the set from `first` to `last`.
    pub(super) fn count(&self, first: u32, last: u32) -> u64 {
        let begin = self.0.partition_point(|range| range.1 < first);
        let touching = self.0[begin..].iter().take_while(|range| range.0 <= last);
        touching.map(|range| u64::from(range.1.min(last) - range.0.max(first)) + 1).sum()
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn a_set_of_ranges_is_the_set_of_its_numbers() {
        let (mut ranges, mut numbers) = (Ranges::default(), BTreeSet::new());
        let mut random = 7_u32;
        for _ in 0..400 {
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let number = random >> 24;
            assert_eq!(ranges.insert(number), numbers.insert(number), "{number}");
            let (first, last) = (number.saturating_sub(9), number + 20);
            let count = numbers.range(first..=last).count() as u64;
            assert_eq!(ranges.count(first, last), count, "{first} to {last}");
        }
        assert!(ranges.insert(u32::MAX) && !ranges.insert(u32::MAX));
        assert!(ranges.0.windows(2).all(|pair| pair[0].1 + 1 < pair[1].0), "{ranges:?}");
    }
}
