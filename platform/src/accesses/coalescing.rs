//! Decision which reads are entries of their own, and which are counted.

use std::collections::{BTreeSet, HashMap, hash_map::Entry};

use access_log::AccessKind;
use asi_model::{FactoryId, RequestKey};

use super::{Reader, Reading};

/// Most accesses that are counted at once; reads beyond are entries of their own.
const OPEN_MAX: usize = 20_000;

/// Counts reads of what is on record already.
#[derive(Debug, Default)]
pub struct Coalescer {
    open: HashMap<Key, OpenAccess>,
}

type Key = (Reader, AccessKind, FactoryId, RequestKey);

#[derive(Debug)]
struct OpenAccess {
    /// Fields that an entry names since the access was opened.
    recorded: BTreeSet<String>,
    /// Reads that no entry has yet.
    counted: Option<Reading>,
    /// True where something was read since the last entries were taken.
    is_in_use: bool,
}

impl Coalescer {
    /// Counts a read; returns false where it has to be an entry before the values are handed out.
    pub fn count(&mut self, reading: &Reading) -> bool {
        if !self.is_open(reading) {
            return false;
        }
        let Some(open) = self.open.get_mut(&key(reading)) else { return false };
        match &mut open.counted {
            Some(counted) => counted.add(reading),
            None => open.counted = Some(reading.clone()),
        }
        true
    }

    /// Returns true where entries name all these fields already; the access then stays open for the
    /// next minute.
    pub fn is_open(&mut self, reading: &Reading) -> bool {
        let Some(open) = self.open.get_mut(&key(reading)) else { return false };
        let is_named = reading.contents.fields.is_subset(&open.recorded);
        open.is_in_use |= is_named;
        is_named
    }

    /// Joins readings of the same values, and divides them into those that have to be entries and
    /// those to be counted.
    pub fn divide(&mut self, readings: Vec<Reading>) -> (Vec<Reading>, Vec<Reading>) {
        let mut joined: HashMap<Key, Reading> = HashMap::new();
        for reading in readings {
            match joined.entry(key(&reading)) {
                Entry::Occupied(mut known) => known.get_mut().add(&reading),
                Entry::Vacant(place) => drop(place.insert(reading)),
            }
        }
        joined.into_values().partition(|reading| !self.is_open(reading))
    }

    /// Notes that a read is an entry now.
    pub fn recorded(&mut self, reading: &Reading) {
        let key = key(reading);
        if self.open.len() >= OPEN_MAX && !self.open.contains_key(&key) {
            return;
        }
        let open = self.open.entry(key).or_insert_with(|| OpenAccess {
            recorded: BTreeSet::new(),
            counted: None,
            is_in_use: true,
        });
        open.recorded.extend(reading.contents.fields.iter().cloned());
        open.is_in_use = true;
    }

    /// Takes what was counted, and closes what was not read since the last time.
    pub fn take(&mut self) -> Vec<Reading> {
        let mut taken = Vec::new();
        self.open.retain(|_, open| {
            taken.extend(open.counted.take());
            std::mem::take(&mut open.is_in_use)
        });
        taken
    }

    /// Puts counts back that could not be recorded.
    pub fn put_back(&mut self, readings: Vec<Reading>) {
        for reading in readings {
            let open = self.open.entry(key(&reading)).or_insert_with(|| OpenAccess {
                recorded: reading.contents.fields.clone(),
                counted: None,
                is_in_use: true,
            });
            match &mut open.counted {
                Some(counted) => counted.add(&reading),
                None => open.counted = Some(reading),
            }
        }
    }
}

fn key(reading: &Reading) -> Key {
    let contents = &reading.contents;
    let (factory, request) = (contents.factory_id.clone(), contents.request.clone());
    (reading.reader.clone(), reading.kind, factory, request)
}

#[cfg(test)]
mod tests {
    use access_log::AgentKind;
    use asi_model::DateTime;

    use super::*;
    use crate::accesses::Contents;

    fn id<T: std::str::FromStr<Err: std::fmt::Debug>>(text: &str) -> T {
        text.parse().expect("valid")
    }

    fn reading(name: &str, field: &str, seconds: i64) -> Reading {
        let request = RequestKey {
            operation_network_id: id("net"),
            operation_id: id("op"),
            dynamic_data_request_id: id("req"),
        };
        let at = DateTime::from_unix_micros(seconds * 1_000_000);
        Reading {
            reader: Reader {
                organisation_id: id("acme"),
                kind: AgentKind::User,
                name: name.to_owned(),
                role: None,
            },
            kind: AccessKind::Looked,
            contents: Contents::gather([(&id("F"), &request, field, Some(at))]).remove(0),
            since: at,
        }
    }

    /// Reads; returns true where it was an entry.
    fn read(coalescer: &mut Coalescer, reading: &Reading) -> bool {
        let is_entry = !coalescer.count(reading);
        if is_entry {
            coalescer.recorded(reading);
        }
        is_entry
    }

    #[test]
    fn the_first_read_is_an_entry_and_further_ones_are_counted() {
        let mut coalescer = Coalescer::default();
        assert!(read(&mut coalescer, &reading("ann", "a", 1)));
        for second in 2..=10 {
            assert!(!read(&mut coalescer, &reading("ann", "a", second)));
        }
        assert!(read(&mut coalescer, &reading("bob", "a", 3)), "another person");
        assert!(read(&mut coalescer, &reading("ann", "b", 4)), "another field");
        let taken = coalescer.take();
        assert_eq!(taken.len(), 1);
        assert_eq!((taken[0].contents.value_count, taken[0].since), (9, reading("", "", 2).since));
        let span = taken[0].contents.span.expect("times");
        assert_eq!(span, (reading("", "", 2).since, reading("", "", 10).since));
    }

    #[test]
    fn a_dashboard_of_an_hour_is_an_entry_a_minute() {
        let mut coalescer = Coalescer::default();
        let mut entries = 0;
        for second in 0..3_600 {
            entries += usize::from(read(&mut coalescer, &reading("ann", "a", second)));
            if second % 60 == 30 {
                entries += coalescer.take().len();
            }
        }
        assert_eq!(entries, 61);
    }

    #[test]
    fn an_access_without_reads_for_a_minute_ends() {
        let mut coalescer = Coalescer::default();
        assert!(read(&mut coalescer, &reading("ann", "a", 1)));
        assert_eq!(coalescer.take(), []);
        assert!(!read(&mut coalescer, &reading("ann", "a", 30)));
        assert_eq!(coalescer.take().len(), 1);
        assert_eq!(coalescer.take(), []);
        assert!(coalescer.open.is_empty());
        assert!(read(&mut coalescer, &reading("ann", "a", 200)));
    }

    #[test]
    fn counts_that_could_not_be_recorded_are_not_lost() {
        let mut coalescer = Coalescer::default();
        let ann = reading("ann", "a", 1);
        read(&mut coalescer, &ann);
        read(&mut coalescer, &ann);
        let taken = coalescer.take();
        read(&mut coalescer, &ann);
        coalescer.put_back(taken);
        assert_eq!(coalescer.take()[0].contents.value_count, 2);
    }

    #[test]
    fn what_is_counted_at_once_is_bounded() {
        let mut coalescer = Coalescer::default();
        for number in 0..OPEN_MAX + 5 {
            assert!(read(&mut coalescer, &reading(&number.to_string(), "a", 1)));
        }
        assert_eq!(coalescer.open.len(), OPEN_MAX);
        assert!(read(&mut coalescer, &reading(&(OPEN_MAX + 1).to_string(), "a", 2)));
    }
}
