//! Verification: finds any change, deletion or reordering.
//!
//! Entries and reports are looked at one by one, which may happen on several threads
//! ([`StoredEntry::check`]); the [`Verifier`] then takes the entries in their order and compares
//! them with what is signed: anchors at the beginning of pruned chains, heads at their ends, daily
//! checkpoints over all of them, and receipts of ended consents.

mod row;
#[cfg(test)]
mod tests;

use std::collections::{BTreeMap, BTreeSet, HashMap};

use serde::Serialize;

use row::Values;
pub use row::{CheckedEntry, ReportDigest, StoredEntry, StoredReport};

use super::{
    Anchor, Checkpoint, Event, Hash, Head, RevocationReceipt, head::is_signed_head, key::is_signed,
};

/// Most faults that are listed; more are counted only.
const FAULTS_MAX: usize = 100;

/// Something that is not as it was written.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct LedgerFault {
    /// Whose chain; empty where no single chain is concerned.
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
    /// Entries that retention has removed, by the signed anchors in their place.
    pub entries_pruned: u64,
    /// Checkpoints verified.
    pub checkpoints: u64,
    /// Receipts of ended consents verified.
    pub revocations: u64,
    /// The key that everything signed was signed with, hexadecimal: compare it with the one you
    /// noted.
    pub public_key: Option<String>,
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

/// A signed text as stored.
#[derive(Debug, Clone, Default)]
pub struct StoredStatement {
    /// The columns beside it that repeat what it says: a name or number, and a time in
    /// microseconds.
    pub name: String,
    /// When, as the column says.
    pub recorded_at: i64,
    /// The signed text.
    pub content: Vec<u8>,
    /// The signature.
    pub signature: Vec<u8>,
    /// The public key.
    pub public_key: Vec<u8>,
}

/// A chain's signed end as stored.
#[derive(Debug, Clone, Default)]
pub struct StoredHead {
    /// Whose chain.
    pub recipient: String,
    /// The number of its last entry.
    pub number: i64,
    /// The hash of its last entry.
    pub hash: Vec<u8>,
    /// The signature.
    pub signature: Vec<u8>,
    /// The public key.
    pub public_key: Vec<u8>,
}

/// A consent as its own table has it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StoredConsent {
    /// `PENDING`, `MAPPED` or `REFUSED`.
    pub mapping_state: String,
    /// Where values come from.
    pub value_source: Option<String>,
    /// The policy as JSON.
    pub policy: String,
    /// Who.
    pub decided_by: Option<String>,
    /// When, in microseconds.
    pub decided_at: i64,
}

/// Everything beside the entries.
#[derive(Debug, Default)]
pub struct Surroundings {
    /// Whose ledger.
    pub factory_id: String,
    /// The key that must have signed everything; any single key without it.
    pub trusted_key: Option<Hash>,
    /// What stands in the place of pruned entries.
    pub anchors: Vec<StoredStatement>,
    /// The daily checkpoints, in order.
    pub checkpoints: Vec<StoredStatement>,
    /// Receipts of ended consents.
    pub revocations: Vec<StoredStatement>,
    /// The signed ends.
    pub heads: Vec<StoredHead>,
    /// The consents by field and number.
    pub consents: HashMap<(String, u32), StoredConsent>,
}

/// Takes the entries of all chains, each chain in its order.
pub struct Verifier {
    heads: BTreeMap<String, Head>,
    starts: BTreeMap<String, Head>,
    /// Hashes that checkpoints refer to.
    wanted: BTreeMap<(String, u64), String>,
    factory_id: String,
    key: Option<Hash>,
    signed_heads: Vec<StoredHead>,
    consents: HashMap<(String, u32), StoredConsent>,
    /// Receipts by id, with those that no entry has spoken of yet.
    revocations: BTreeSet<String>,
    unmentioned: BTreeSet<String>,
    outcome: Verification,
}

impl Verifier {
    /// A verification against what is signed.
    #[must_use]
    pub fn new(surroundings: Surroundings) -> Self {
        let mut verifier = Self {
            heads: BTreeMap::new(),
            starts: BTreeMap::new(),
            wanted: BTreeMap::new(),
            factory_id: surroundings.factory_id,
            key: surroundings.trusted_key,
            signed_heads: surroundings.heads,
            consents: surroundings.consents,
            revocations: BTreeSet::new(),
            unmentioned: BTreeSet::new(),
            outcome: Verification::default(),
        };
        for anchor in &surroundings.anchors {
            verifier.anchor(anchor);
        }
        for (place, checkpoint) in (1..).zip(&surroundings.checkpoints) {
            verifier.checkpoint(place, checkpoint);
        }
        for revocation in &surroundings.revocations {
            verifier.revocation(revocation);
        }
        verifier
    }

    /// The hash that a chain's first stored entry follows.
    #[must_use]
    pub fn start_of(&self, recipient: &[u8]) -> Hash {
        std::str::from_utf8(recipient)
            .ok()
            .and_then(|name| self.starts.get(name))
            .map(|head| head.hash)
            .unwrap_or_default()
    }

    /// Takes the next entries of a chain.
    pub fn take(&mut self, recipient: &[u8], entries: impl IntoIterator<Item = CheckedEntry>) {
        let recipient = String::from_utf8_lossy(recipient).into_owned();
        let known = self.heads.get(&recipient).or_else(|| self.starts.get(&recipient));
        let mut last = known.map_or(0, |head| head.number);
        for entry in entries {
            let head = self.take_one(&recipient, last, entry);
            last = head.number;
            match self.heads.get_mut(&recipient) {
                Some(known) => *known = head,
                None => drop(self.heads.insert(recipient.clone(), head)),
            }
        }
    }

    fn take_one(&mut self, recipient: &str, last: u64, entry: CheckedEntry) -> Head {
        let CheckedEntry { number, hash, faults, values, consent, revocation } = entry;
        self.outcome.entries += 1;
        match values {
            Values::None => {}
            Values::Compared => self.outcome.values_compared += 1,
            Values::Emptied => self.outcome.values_emptied += 1,
        }
        for fault in faults {
            self.fault(recipient, number, fault);
        }
        if number != last + 1 {
            self.fault(recipient, last + 1, "entries are missing from here on");
        }
        if let Some((event, at)) = consent
            && !self.is_given(&event, at)
        {
            self.fault(
                recipient,
                number,
                "the consent beside the ledger is not the one that was given",
            );
        }
        if let Some(id) = revocation {
            self.unmentioned.remove(&id);
            if !self.revocations.contains(&id) {
                self.fault(recipient, number, "the receipt of this revocation was deleted");
            }
        }
        if !self.wanted.is_empty()
            && let Some(wanted) = self.wanted.remove(&(recipient.to_owned(), number))
            && wanted != hex::encode(hash)
        {
            self.fault(recipient, number, "a signed checkpoint states another hash for this entry");
        }
        Head { number, hash }
    }

    /// Ends the verification: compares the chains' ends with what was signed of them.
    #[must_use]
    pub fn finish(mut self) -> Verification {
        for stored in std::mem::take(&mut self.signed_heads) {
            let number = u64::try_from(stored.number).unwrap_or_default();
            let is_signed = is_signed_head(
                &self.factory_id,
                &stored.recipient,
                number,
                &stored.hash,
                &stored.signature,
                &stored.public_key,
            );
            if !(is_signed && self.is_known(&stored.public_key)) {
                self.fault(&stored.recipient, number, "the signature of the chain's end is wrong");
            }
            let end = self
                .heads
                .remove(&stored.recipient)
                .or_else(|| self.starts.get(&stored.recipient).copied());
            let end = end.unwrap_or_default();
            if end.number < number {
                self.fault(&stored.recipient, end.number + 1, "entries are missing at the end");
            } else if end.number > number || end.hash[..] != stored.hash[..] {
                self.fault(
                    &stored.recipient,
                    end.number,
                    "the chain's end is not the one that was signed",
                );
            }
        }
        for (recipient, head) in std::mem::take(&mut self.heads) {
            self.fault(&recipient, head.number, "the signed end of the chain was deleted");
        }
        for (recipient, number) in std::mem::take(&mut self.wanted).into_keys() {
            let is_pruned = self.starts.get(&recipient).is_some_and(|start| number <= start.number);
            if !is_pruned {
                self.fault(
                    &recipient,
                    number,
                    "a signed checkpoint states this entry, but it is missing",
                );
            }
        }
        // Entries about old receipts may have been pruned.
        if self.starts.is_empty() {
            for id in std::mem::take(&mut self.unmentioned) {
                self.fault("", 0, &format!("no entry speaks of the revocation {id}"));
            }
        }
        self.outcome.public_key = self.key.map(hex::encode);
        self.outcome
    }

    /// Whether a consent's own table has it as the entry has.
    fn is_given(&self, event: &Event, at: i64) -> bool {
        let Event::Consent { field, version, .. } = event else { return false };
        let stored = self.consents.get(&(field.to_string(), *version));
        stored.is_some_and(|stored| stored.decided_at == at && is_consent(event, stored))
    }

    fn anchor(&mut self, stored: &StoredStatement) {
        let anchor = std::str::from_utf8(&stored.content)
            .ok()
            .and_then(|text| serde_json::from_str::<Anchor>(text).ok());
        let hash =
            anchor.as_ref().and_then(|anchor| hex::decode(&anchor.hash).ok()?.try_into().ok());
        let (Some(anchor), Some(hash)) = (anchor, hash) else {
            return self.fault(
                &stored.name,
                0,
                "the anchor in the place of pruned entries cannot be read",
            );
        };
        let fits = anchor.recipient.as_str() == stored.name
            && anchor.recorded_at.unix_micros() == stored.recorded_at
            && anchor.factory_id.as_str() == self.factory_id;
        if !(fits && self.is_stated(stored)) {
            self.fault(
                &stored.name,
                anchor.number,
                "the anchor in the place of pruned entries was changed",
            );
        }
        self.outcome.entries_pruned += anchor.number;
        self.starts.insert(stored.name.clone(), Head { number: anchor.number, hash });
    }

    fn checkpoint(&mut self, place: u64, stored: &StoredStatement) {
        self.outcome.checkpoints += 1;
        let text = std::str::from_utf8(&stored.content).ok();
        let Some(checkpoint) = text.and_then(|text| serde_json::from_str::<Checkpoint>(text).ok())
        else {
            return self.fault("", place, "the checkpoint cannot be read");
        };
        let fits = checkpoint.number == place
            && stored.name == place.to_string()
            && checkpoint.recorded_at.unix_micros() == stored.recorded_at
            && checkpoint.factory_id.as_str() == self.factory_id;
        if !(fits && self.is_stated(stored)) {
            return self.fault(
                "",
                place,
                "the checkpoint is out of place or its signature is wrong",
            );
        }
        for head in checkpoint.heads.into_iter().filter(|head| head.number > 0) {
            self.wanted.insert((head.recipient.to_string(), head.number), head.hash);
        }
    }

    fn revocation(&mut self, stored: &StoredStatement) {
        self.outcome.revocations += 1;
        let text = std::str::from_utf8(&stored.content).ok();
        let receipt = text.and_then(|text| serde_json::from_str::<RevocationReceipt>(text).ok());
        let fits = receipt.as_ref().is_some_and(|receipt| {
            receipt.revocation_id == stored.name
                && receipt.revoked_at.unix_micros() == stored.recorded_at
        });
        if !(fits && self.is_stated(stored)) {
            self.fault(
                "",
                0,
                &format!("the receipt of the revocation {} was changed", stored.name),
            );
        }
        self.revocations.insert(stored.name.clone());
        if receipt.is_some_and(|receipt| {
            receipt.writers.iter().any(|writer| !writer.recipient_list.is_empty())
        }) {
            self.unmentioned.insert(stored.name.clone());
        }
    }

    fn is_stated(&mut self, stored: &StoredStatement) -> bool {
        std::str::from_utf8(&stored.content)
            .is_ok_and(|text| is_signed(text, &stored.signature, &stored.public_key))
            && self.is_known(&stored.public_key)
    }

    /// One key signs everything: the trusted one, or else the first that is met.
    fn is_known(&mut self, public_key: &[u8]) -> bool {
        let Ok(key) = Hash::try_from(public_key) else { return false };
        *self.key.get_or_insert(key) == key
    }

    fn fault(&mut self, recipient: &str, number: u64, message: &str) {
        self.outcome.fault_count += 1;
        if self.outcome.fault_list.len() < FAULTS_MAX {
            let fault = LedgerFault {
                recipient: recipient.to_owned(),
                number,
                message: message.to_owned(),
            };
            self.outcome.fault_list.push(fault);
        }
    }
}

fn is_consent(event: &Event, stored: &StoredConsent) -> bool {
    let Event::Consent { mapping_state, value_source, policy, decided_by, .. } = event else {
        return false;
    };
    let name = |value: serde_json::Value| value.as_str().map(str::to_owned);
    let stored_policy = serde_json::from_str::<disclosure::DisclosurePolicy>(&stored.policy).ok();
    serde_json::to_value(mapping_state).ok().and_then(name).as_deref()
        == Some(&stored.mapping_state)
        && value_source.map(serde_json::to_value).and_then(Result::ok).and_then(name)
            == stored.value_source
        && stored_policy.as_ref() == Some(policy)
        && *decided_by == stored.decided_by
}
