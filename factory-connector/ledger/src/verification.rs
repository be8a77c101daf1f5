//! Verification of the ledger: finds any change, deletion or reordering.
//!
//! Entries and reports are first checked separately, on several threads if the caller wants
//! ([`StoredEntry::check`]). The [`Verifier`] then takes the entries in their order and compares
//! them with the signed records: anchors at the beginning of pruned chains, heads at their ends,
//! daily checkpoints over all of them, and receipts of ended consents.

mod log;
mod result;
mod row;
mod stored;
#[cfg(test)]
mod tests;

use std::collections::{BTreeMap, BTreeSet, HashMap};

use log::LogCheck;
pub use log::StoredLog;
pub use result::{LedgerFault, Verification};
use row::Values;
pub use row::{CheckedEntry, ReportDigest, StoredEntry, StoredReport};
pub use stored::{StoredConsent, StoredHead, StoredStatement, Surroundings};

use super::{
    Anchor, Event, Hash, Head, HeadsCheckpoint, RevocationReceipt, head::is_signed_head,
    key::is_signed,
};

/// Most faults that are listed; further ones are only counted.
const FAULTS_MAX: usize = 100;

/// Verifies the entries of all chains, each chain in its order.
pub struct Verifier {
    heads: BTreeMap<String, Head>,
    starts: BTreeMap<String, Head>,
    anchors: BTreeMap<String, Anchor>,
    logs: BTreeMap<String, LogCheck>,
    /// Hashes stated in checkpoints, by organisation and number.
    stated: BTreeMap<(String, u64), String>,
    factory_id: String,
    key: Option<Hash>,
    signed_heads: Vec<StoredHead>,
    consents: HashMap<(String, u32), StoredConsent>,
    /// Ids of all receipts, and of those that no entry has mentioned yet.
    revocations: BTreeSet<String>,
    unmentioned: BTreeSet<String>,
    outcome: Verification,
}

impl Verifier {
    /// Starts a verification against signed records.
    #[must_use]
    pub fn new(surroundings: Surroundings) -> Self {
        let mut verifier = Self {
            heads: BTreeMap::new(),
            starts: BTreeMap::new(),
            anchors: BTreeMap::new(),
            logs: BTreeMap::new(),
            stated: BTreeMap::new(),
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
        for (number, checkpoint) in (1..).zip(&surroundings.checkpoints) {
            verifier.checkpoint(number, checkpoint);
        }
        for revocation in &surroundings.revocations {
            verifier.revocation(revocation);
        }
        verifier.open_logs(surroundings.logs);
        verifier
    }

    /// Returns the hash that a chain's first stored entry follows.
    #[must_use]
    pub fn start_of(&self, recipient: &[u8]) -> Hash {
        std::str::from_utf8(recipient)
            .ok()
            .and_then(|name| self.starts.get(name))
            .map(|head| head.hash)
            .unwrap_or_default()
    }

    /// Verifies the next entries of a chain.
    pub fn take(&mut self, recipient: &[u8], entries: impl IntoIterator<Item = CheckedEntry>) {
        let recipient = String::from_utf8_lossy(recipient).into_owned();
        let known = self.heads.get(&recipient).or_else(|| self.starts.get(&recipient));
        let mut last = known.map_or(0, |head| head.number);
        for entry in entries {
            if let Some(Err(fault)) = self.logs.get_mut(&recipient).map(|log| log.take(entry.leaf))
            {
                self.fault(&recipient, entry.number, fault);
            }
            let head = self.take_one(&recipient, last, entry);
            last = head.number;
            match self.heads.get_mut(&recipient) {
                Some(known) => *known = head,
                None => drop(self.heads.insert(recipient.clone(), head)),
            }
        }
    }

    fn take_one(&mut self, recipient: &str, last: u64, entry: CheckedEntry) -> Head {
        let CheckedEntry { number, hash, leaf: _, faults, values, consent, revocation } = entry;
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
        if !self.stated.is_empty()
            && let Some(stated) = self.stated.remove(&(recipient.to_owned(), number))
            && stated != hex::encode(hash)
        {
            self.fault(recipient, number, "a signed checkpoint states another hash for this entry");
        }
        Head { number, hash }
    }

    /// Ends the verification: compares the chains' heads with the signed ones.
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
        for (recipient, log) in std::mem::take(&mut self.logs) {
            if let Err(fault) = log.finish() {
                self.fault(&recipient, 0, fault);
            }
        }
        for (recipient, head) in std::mem::take(&mut self.heads) {
            self.fault(&recipient, head.number, "the signed end of the chain was deleted");
        }
        for (recipient, number) in std::mem::take(&mut self.stated).into_keys() {
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

    /// Returns whether the consent in its own table equals that of the entry.
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
        if !(fits && self.is_signed(stored)) {
            self.fault(
                &stored.name,
                anchor.number,
                "the anchor in the place of pruned entries was changed",
            );
        }
        self.outcome.entries_pruned += anchor.number;
        self.starts.insert(stored.name.clone(), Head { number: anchor.number, hash });
        self.anchors.insert(stored.name.clone(), anchor);
    }

    /// Starts the check of each chain's log. Every chain has one, unless it is one of a former version
    /// that was not opened since.
    fn open_logs(&mut self, logs: Vec<StoredLog>) {
        let mut without: BTreeSet<String> =
            self.signed_heads.iter().map(|head| head.recipient.clone()).collect();
        // Without a trusted key any single one is accepted, as for everything that is signed.
        let first = self.signed_heads.first().map(|head| head.public_key.as_slice());
        let key = self.key.or_else(|| first?.try_into().ok());
        for stored in logs {
            let recipient = stored.recipient.clone();
            without.remove(&recipient);
            if stored.is_empty() {
                continue;
            }
            let anchor = self.anchors.get(&recipient);
            match LogCheck::new(stored, &self.factory_id, anchor, key.as_ref()) {
                Ok(check) => drop(self.logs.insert(recipient, check)),
                Err(fault) => self.fault(&recipient, 0, fault),
            }
        }
        for recipient in without {
            self.fault(&recipient, 0, "the log of the chain was deleted");
        }
    }

    fn checkpoint(&mut self, number: u64, stored: &StoredStatement) {
        self.outcome.checkpoints += 1;
        let text = std::str::from_utf8(&stored.content).ok();
        let Some(checkpoint) =
            text.and_then(|text| serde_json::from_str::<HeadsCheckpoint>(text).ok())
        else {
            return self.fault("", number, "the checkpoint cannot be read");
        };
        let fits = checkpoint.number == number
            && stored.name == number.to_string()
            && checkpoint.recorded_at.unix_micros() == stored.recorded_at
            && checkpoint.factory_id.as_str() == self.factory_id;
        if !(fits && self.is_signed(stored)) {
            return self.fault(
                "",
                number,
                "the checkpoint is out of place or its signature is wrong",
            );
        }
        for head in checkpoint.heads.into_iter().filter(|head| head.number > 0) {
            self.stated.insert((head.recipient.to_string(), head.number), head.hash);
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
        if !(fits && self.is_signed(stored)) {
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

    fn is_signed(&mut self, stored: &StoredStatement) -> bool {
        std::str::from_utf8(&stored.content)
            .is_ok_and(|text| is_signed(text, &stored.signature, &stored.public_key))
            && self.is_known(&stored.public_key)
    }

    /// Returns whether a key is the trusted one, or else the first one that was found.
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
