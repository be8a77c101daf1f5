//! Secrets of a story, and who may see which of them by which way, at each moment.
//!
//! A secret is a number that stands in nothing else. What was released to a member stays in its
//! history; what it is shown at present ends with the consent.

use std::collections::{BTreeMap, BTreeSet};

use super::walk::ReadAnswer;

/// The first digits of every secret.
const MARK: &str = "918273";
const FIRST: u64 = 918_273_000_001;

/// Way to learn of a secret.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Door {
    /// Reports that were released to the reader.
    History,
    /// The network as the reader sees it now, with values, reasons and purposes.
    Present,
    /// Signed receipts of revocations.
    Receipts,
    /// Live events, from the beginning of the story on.
    Live,
    /// The queue of the reader's tool.
    Queue,
}

impl Door {
    /// Returns the door that a reading operation is; none where it shows no secret to anybody.
    fn of(operation: &str) -> Option<Self> {
        match operation {
            "/reports" => Some(Self::History),
            "/operation-networks/{operationNetworkId}" => Some(Self::Present),
            "/operation-networks/{operationNetworkId}/revocations" => Some(Self::Receipts),
            _ => None,
        }
    }
}

/// Subject of what is shown at present: the value or the reason of a field, or a purpose.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Subject {
    /// The newest value of the request with this number.
    Value(usize),
    /// The reason of the decision about the request with this number.
    Reason(usize),
    /// The purpose of the requests.
    Purpose,
}

/// All secrets so far, and their readers.
#[derive(Default)]
pub struct Oracle {
    issued: BTreeSet<u64>,
    /// Secrets that a reader keeps, by the door.
    lasting: BTreeMap<(&'static str, Door), BTreeSet<u64>>,
    present: BTreeMap<Subject, (u64, Vec<&'static str>)>,
}

impl Oracle {
    /// Makes a secret that nobody may see yet.
    pub fn issue(&mut self) -> u64 {
        let secret = FIRST + 7 * self.issued.len() as u64;
        self.issued.insert(secret);
        secret
    }

    /// Lets readers see a secret for ever.
    pub fn give(&mut self, door: Door, secret: u64, readers: &[&'static str]) {
        for reader in readers {
            self.lasting.entry((reader, door)).or_default().insert(secret);
        }
    }

    /// Shows readers a secret in place of the former one about the subject.
    pub fn show(&mut self, subject: Subject, secret: u64, readers: &[&'static str]) {
        self.present.insert(subject, (secret, readers.to_vec()));
    }

    /// Ends what is shown about a subject.
    pub fn hide(&mut self, subject: Subject) {
        self.present.remove(&subject);
    }

    /// Returns the secrets that a reader may see, and has to find.
    pub fn allowed(&self, reader: &'static str, door: Door) -> BTreeSet<u64> {
        if door != Door::Present {
            return self.lasting.get(&(reader, door)).cloned().unwrap_or_default();
        }
        let shown = self.present.values().filter(|(_, readers)| readers.contains(&reader));
        shown.map(|(secret, _)| *secret).collect()
    }

    /// Returns the secrets in a text.
    pub fn found(&self, text: &str) -> BTreeSet<u64> {
        let digits = FIRST.to_string().len();
        text.match_indices(MARK)
            .filter_map(|(at, _)| text.get(at..at + digits)?.parse().ok())
            .filter(|number| self.issued.contains(number))
            .collect()
    }

    /// Compares a reader's walk with what it may see.
    pub fn judge(&self, stage: &str, reader: &'static str, answers: &[ReadAnswer]) {
        let mut seen: BTreeMap<Door, BTreeSet<u64>> = BTreeMap::new();
        for ReadAnswer { reading, headers, body, .. } in answers {
            let door = Door::of(&reading.operation);
            let allowed = door.map(|door| self.allowed(reader, door)).unwrap_or_default();
            let found = self.found(&format!("{headers}{body}"));
            let surplus: Vec<_> = found.difference(&allowed).collect();
            let path = &reading.path;
            assert!(surplus.is_empty(), "{stage}: {reader} reads {surplus:?} at {path}: {body}");
            if let Some(door) = door {
                seen.entry(door).or_default().extend(found);
            }
        }
        for door in [Door::History, Door::Present, Door::Receipts] {
            let allowed = self.allowed(reader, door);
            assert_eq!(seen[&door], allowed, "{stage}: {reader} by {door:?}");
        }
    }
}
