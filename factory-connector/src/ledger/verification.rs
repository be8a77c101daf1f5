//! Verification: finds any change, deletion or reordering.

use std::collections::BTreeMap;

use asi_model::OrganisationId;
use serde::Serialize;

use super::{Checkpoint, Entry, Event, Hash, Head, chain_hash, checkpoint::is_signed, values_root};

/// Most faults that are listed; more are counted only.
const FAULTS_MAX: usize = 100;

/// Something that is not as it was written.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct LedgerFault {
    /// Whose chain; empty where a checkpoint itself is wrong.
    pub recipient: String,
    /// The entry or checkpoint.
    pub number: u64,
    /// What is wrong with it.
    pub message: String,
}

/// The outcome of a verification.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct Verification {
    /// Entries verified.
    pub entries: u64,
    /// Of these, how many could be compared with the values they commit to.
    pub values_compared: u64,
    /// Values that retention has emptied.
    pub values_emptied: u64,
    /// Checkpoints verified.
    pub checkpoints: u64,
    /// How many faults there are.
    pub fault_count: u64,
    /// The first hundred of them.
    pub fault_list: Vec<LedgerFault>,
}

impl Verification {
    /// Nothing is wrong.
    #[must_use]
    pub const fn is_intact(&self) -> bool {
        self.fault_count == 0
    }
}

/// Takes the entries of all chains, each chain in its order, then the checkpoints.
#[derive(Default)]
pub struct Verifier {
    heads: BTreeMap<String, Head>,
    /// Hashes that checkpoints refer to.
    wanted: BTreeMap<(String, u64), String>,
    outcome: Verification,
}

/// A stored entry.
pub struct StoredEntry<'a> {
    /// Whose chain.
    pub recipient: &'a str,
    /// Its place.
    pub number: u64,
    /// The hashed text.
    pub content: &'a str,
    /// The stored hash.
    pub hash: &'a [u8],
    /// For a QUEUED entry: the report's text and salt, unless emptied; `None` where there is no such report.
    pub report: Option<(Option<&'a str>, Option<&'a [u8]>)>,
}

impl Verifier {
    /// A verification that will also compare the chains with signed checkpoints: their text, signature and public key
    /// as stored, in order.
    pub fn new<'a>(checkpoints: impl IntoIterator<Item = (&'a str, &'a [u8], &'a [u8])>) -> Self {
        let mut verifier = Self::default();
        for (place, (text, signature, public_key)) in (1..).zip(checkpoints) {
            verifier.outcome.checkpoints += 1;
            match serde_json::from_str::<Checkpoint>(text) {
                Ok(checkpoint) if is_signed(text, signature, public_key) && checkpoint.number == place => {
                    for head in checkpoint.heads.into_iter().filter(|head| head.number > 0) {
                        verifier.wanted.insert((head.recipient.to_string(), head.number), head.hash);
                    }
                }
                Ok(_) => verifier.fault("", place, "the checkpoint is out of place or its signature is wrong"),
                Err(_) => verifier.fault("", place, "the checkpoint cannot be read"),
            }
        }
        verifier
    }

    /// Verifies the next entry.
    pub fn entry(&mut self, stored: &StoredEntry<'_>) {
        self.outcome.entries += 1;
        let head = self.heads.get(stored.recipient).copied().unwrap_or_default();
        if stored.number != head.number + 1 {
            self.fault(stored.recipient, head.number + 1, "entries are missing from here on");
        }
        let hash = chain_hash(&head.hash, stored.content);
        if hash != stored.hash {
            self.fault(stored.recipient, stored.number, "the entry or one before it was changed");
        }
        match serde_json::from_str::<Entry>(stored.content) {
            Ok(entry) if entry.recipient.as_str() == stored.recipient && entry.number == stored.number => {
                if let Event::Queued { values, .. } = entry.event {
                    self.values(stored, &values);
                }
            }
            Ok(_) => self.fault(stored.recipient, stored.number, "the entry stands in another's place"),
            Err(_) => self.fault(stored.recipient, stored.number, "the entry cannot be read"),
        }
        // Go on from what is stored, so that one change yields one fault and not as many as entries follow.
        let stored_hash: Hash = stored.hash.try_into().unwrap_or(hash);
        if let Some(wanted) = self.wanted.remove(&(stored.recipient.to_owned(), stored.number))
            && wanted != hex::encode(stored_hash)
        {
            self.fault(stored.recipient, stored.number, "a signed checkpoint states another hash for this entry");
        }
        self.heads.insert(stored.recipient.to_owned(), Head { number: stored.number, hash: stored_hash });
    }

    /// Ends the verification with the heads that the store believes in.
    #[must_use]
    pub fn finish(mut self, believed: impl IntoIterator<Item = (OrganisationId, u64)>) -> Verification {
        for (recipient, number) in believed {
            let found = self.heads.get(recipient.as_str()).map_or(0, |head| head.number);
            if found < number {
                self.fault(recipient.as_str(), found + 1, "entries are missing at the end");
            }
        }
        for (recipient, number) in std::mem::take(&mut self.wanted).into_keys() {
            self.fault(&recipient, number, "a signed checkpoint states this entry, but it is missing");
        }
        self.outcome
    }

    fn values(&mut self, stored: &StoredEntry<'_>, committed: &str) {
        match stored.report {
            Some((Some(report), Some(salt))) => {
                self.outcome.values_compared += 1;
                let root = values_root(report, salt).map(hex::encode);
                if root.ok().as_deref() != Some(committed) {
                    self.fault(stored.recipient, stored.number, "the values are not those that were reported");
                }
            }
            Some((None, None)) => self.outcome.values_emptied += 1,
            Some(_) => self.fault(stored.recipient, stored.number, "the values were removed in part"),
            None => self.fault(stored.recipient, stored.number, "the report with the values was deleted"),
        }
    }

    fn fault(&mut self, recipient: &str, number: u64, message: &str) {
        self.outcome.fault_count += 1;
        if self.outcome.fault_list.len() < FAULTS_MAX {
            let fault = LedgerFault { recipient: recipient.to_owned(), number, message: message.to_owned() };
            self.outcome.fault_list.push(fault);
        }
    }
}

#[cfg(test)]
mod tests {
    use asi_model::DateTime;

    use super::*;
    use crate::ledger::{Heads, LinkedEntry, SequenceRange};

    const REPORT: &str = r#"{"SequenceNumber":1,"Payload":{"a":1}}"#;
    const SALT: [u8; 16] = [3; 16];

    fn entries(count: u32) -> (Vec<LinkedEntry>, Heads) {
        let mut heads = Heads::default();
        let acme = "acme".parse().expect("an id");
        let values = hex::encode(values_root(REPORT, &SALT).expect("a report"));
        let entry = |sequence| {
            let range =
                SequenceRange { data_set_writer_id: 1, epoch: 1, first_sequence: sequence, last_sequence: sequence };
            let event = if sequence % 2 == 0 {
                Event::Queued { range, values: values.clone(), consents: BTreeMap::new() }
            } else {
                Event::Sent(range)
            };
            heads.append(&acme, DateTime::from_unix_micros(i64::from(sequence)), event)
        };
        let entries = (0..count).map(entry).collect();
        (entries, heads)
    }

    fn verify(entries: &[LinkedEntry], report: &str, heads: &Heads) -> Verification {
        let mut verifier = Verifier::default();
        for entry in entries {
            verifier.entry(&StoredEntry {
                recipient: entry.recipient.as_str(),
                number: entry.number,
                content: &entry.content,
                hash: &entry.hash,
                report: Some((Some(report), Some(&SALT))),
            });
        }
        verifier.finish(heads.iter().map(|(recipient, head)| (recipient.clone(), head.number)))
    }

    #[test]
    fn an_intact_ledger_is_intact() {
        let (entries, heads) = entries(20);
        let outcome = verify(&entries, REPORT, &heads);
        assert!(outcome.is_intact(), "{outcome:?}");
        assert_eq!((outcome.entries, outcome.values_compared), (20, 10));
    }

    #[test]
    fn every_single_bit_of_an_entry_is_guarded() {
        let (intact, heads) = entries(3);
        for bit in 0..intact[1].content.len() * 8 {
            let mut entries = intact.clone();
            let mut bytes = entries[1].content.clone().into_bytes();
            bytes[bit / 8] ^= 1 << (bit % 8);
            let Ok(content) = String::from_utf8(bytes) else { continue };
            entries[1].content = content;
            assert!(!verify(&entries, REPORT, &heads).is_intact(), "bit {bit}");
        }
        for bit in 0..256 {
            let mut entries = intact.clone();
            entries[1].hash[bit / 8] ^= 1 << (bit % 8);
            assert!(!verify(&entries, REPORT, &heads).is_intact(), "bit {bit} of the hash");
        }
    }

    #[test]
    fn deletion_reordering_and_other_values_are_found() {
        let (intact, heads) = entries(5);
        for place in 0..intact.len() {
            let mut entries = intact.clone();
            entries.remove(place);
            assert!(!verify(&entries, REPORT, &heads).is_intact(), "without {place}");
        }
        let mut entries = intact.clone();
        entries.swap(1, 2);
        assert!(!verify(&entries, REPORT, &heads).is_intact());
        let other = REPORT.replace("\"a\":1", "\"a\":2");
        assert!(!verify(&intact, &other, &heads).is_intact());
    }

    #[test]
    fn a_rewritten_chain_contradicts_its_checkpoint() {
        let folder = tempfile::tempdir().expect("a folder");
        let key = crate::ledger::LedgerKey::open(&folder.path().join("key")).expect("a key");
        let (intact, heads) = entries(4);
        let text = Checkpoint::new("F".parse().expect("an id"), 1, DateTime::MIN, &heads).canonical();
        let (signature, public) = (key.sign(&text), key.public());
        let check = |entries: &[LinkedEntry], text: &str| {
            let mut verifier = Verifier::new([(text, &signature[..], &public[..])]);
            for entry in entries {
                verifier.entry(&StoredEntry {
                    recipient: entry.recipient.as_str(),
                    number: entry.number,
                    content: &entry.content,
                    hash: &entry.hash,
                    report: Some((None, None)),
                });
            }
            verifier.finish([]).is_intact()
        };
        assert!(check(&intact, &text));
        assert!(!check(&intact[..3], &text), "a chain cut short and its heads rewritten");
        assert!(!check(&intact, &text.replace("\"number\":4", "\"number\":3")));
    }
}
