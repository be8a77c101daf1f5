//! Verification of the ledger: finds any change, deletion or reordering.
//!
//! Entries and reports are first checked separately, on several threads if the caller wants
//! ([`StoredEntry::check`]). The [`Verifier`] then takes the entries in their order and compares
//! them with the signed records: anchors at the beginning of pruned chains, heads at their ends,
//! daily checkpoints over all of them, and receipts of ended consents. Checkpoints of logs that were
//! kept elsewhere prove that nothing was set back or signed again.

mod chain;
mod log;
mod recipients;
mod result;
mod row;
mod statements;
mod stored;
#[cfg(test)]
mod tests;

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

use chain::ChainCheck;
use log::LogCheck;
pub use log::StoredLog;
use recipients::AwaitedRecipients;
pub use result::{LedgerFault, Verification};
pub use row::{CheckedEntry, ReportDigest, StoredEntry, StoredReport};
pub use stored::{StoredConsent, StoredHead, StoredSeal, StoredStatement, Surroundings};

use disclosure::DecisionBasis;

use super::{
    Event, Hash, Head, basis_for_recipients, head::is_signed_head, key::is_signed,
    values::CheckedValues,
};

/// Most faults that are listed; further ones are only counted.
const FAULTS_MAX: usize = 100;

/// Verifies the entries of all chains, each chain in its order.
pub struct Verifier {
    chains: BTreeMap<String, ChainCheck>,
    awaited: AwaitedRecipients,
    /// Hashes stated in checkpoints, by organisation and number.
    stated: BTreeMap<(String, u64), String>,
    factory_id: String,
    key: Option<Hash>,
    signed_heads: Vec<StoredHead>,
    consents: HashMap<(String, u32), StoredConsent>,
    previews: HashSet<String>,
    /// Ids of all receipts, and of those that no entry has mentioned yet.
    revocations: BTreeSet<String>,
    unmentioned: BTreeSet<String>,
    /// The store is one of a former version that was not opened since: what later versions sign
    /// besides is not there yet.
    is_former: bool,
    outcome: Verification,
}

impl Verifier {
    /// Starts a verification against signed records.
    #[must_use]
    pub fn new(surroundings: Surroundings) -> Self {
        let is_former =
            surroundings.seal.is_none() && surroundings.logs.iter().all(StoredLog::is_empty);
        let mut verifier = Self {
            chains: BTreeMap::new(),
            awaited: AwaitedRecipients::default(),
            stated: BTreeMap::new(),
            factory_id: surroundings.factory_id,
            key: surroundings.trusted_key,
            signed_heads: surroundings.heads,
            consents: surroundings.consents,
            previews: surroundings.previews,
            revocations: BTreeSet::new(),
            unmentioned: BTreeSet::new(),
            is_former,
            outcome: Verification::default(),
        };
        for anchor in &surroundings.anchors {
            verifier.anchor(anchor);
        }
        for (number, checkpoint) in (1..).zip(&surroundings.checkpoints) {
            verifier.checkpoint(number, checkpoint);
        }
        verifier.seal(surroundings.seal.as_ref(), surroundings.checkpoints.len() as u64);
        for revocation in &surroundings.revocations {
            verifier.revocation(revocation);
        }
        verifier.open_logs(surroundings.logs, &surroundings.kept_checkpoints);
        verifier
    }

    /// Returns the hash that a chain's first stored entry follows.
    #[must_use]
    pub fn start_of(&self, recipient: &[u8]) -> Hash {
        std::str::from_utf8(recipient)
            .ok()
            .and_then(|name| self.chains.get(name)?.start)
            .map(|head| head.hash)
            .unwrap_or_default()
    }

    /// Verifies the next entries of a chain.
    pub fn take(&mut self, recipient: &[u8], entries: impl IntoIterator<Item = CheckedEntry>) {
        let recipient = String::from_utf8_lossy(recipient).into_owned();
        let mut chain = self.chains.remove(&recipient).unwrap_or_default();
        for mut entry in entries {
            let number = entry.number;
            if let Some(Err(fault)) = chain.log.as_mut().map(|log| log.take(entry.leaf)) {
                self.fault(&recipient, number, fault);
            }
            let event = std::mem::take(&mut entry.event);
            if let Err(fault) = chain.history.take(number, entry.recorded_at, event) {
                self.fault(&recipient, number, fault);
            }
            if let Some(shared) = entry.shared.take() {
                self.awaited.take(shared, &recipient, entry.recorded_at);
            }
            chain.head = Some(self.take_one(&recipient, chain.end().number, entry));
        }
        self.chains.insert(recipient, chain);
    }

    fn take_one(&mut self, recipient: &str, last: u64, entry: CheckedEntry) -> Head {
        let CheckedEntry { number, hash, faults, values, consent, revocation, .. } = entry;
        self.outcome.entries += 1;
        match values {
            CheckedValues::None => {}
            CheckedValues::Compared => self.outcome.values_compared += 1,
            CheckedValues::Emptied => self.outcome.values_emptied += 1,
        }
        for fault in faults {
            self.fault(recipient, number, fault);
        }
        if number != last + 1 {
            self.fault(recipient, last + 1, "entries are missing from here on");
        }
        if let Some((event, at)) = consent {
            for fault in self.consent_faults(&event, at) {
                self.fault(recipient, number, fault);
            }
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
        self.compare_heads();
        let chains = std::mem::take(&mut self.chains);
        self.compare_recipients(&chains);
        for (recipient, number) in std::mem::take(&mut self.stated).into_keys() {
            let start = chains.get(&recipient).and_then(|chain| chain.start);
            if start.is_none_or(|start| number > start.number) {
                self.fault(
                    &recipient,
                    number,
                    "a signed checkpoint states this entry, but it is missing",
                );
            }
        }
        // Entries about old receipts may have been pruned.
        if chains.values().all(|chain| chain.start.is_none()) {
            for id in std::mem::take(&mut self.unmentioned) {
                self.fault("", 0, &format!("no entry speaks of the revocation {id}"));
            }
        }
        // What a former version could not have written proves that its traces were made.
        if self.is_former && chains.values().any(|chain| chain.history.is_stated()) {
            self.is_former = false;
            self.fault("", 0, "what is signed beside the entries was deleted");
        }
        let mut former = BTreeSet::new();
        for (recipient, chain) in chains {
            if let Some(Err(fault)) = chain.log.map(LogCheck::finish) {
                self.fault(&recipient, 0, fault);
            }
            former.extend(chain.history.former_at());
            // A former version did not state what it emptied.
            let faults = if self.is_former { Vec::new() } else { chain.history.finish(None) };
            for (number, fault) in faults {
                self.fault(&recipient, number, fault);
            }
        }
        if former.len() > 1 {
            self.fault("", 0, "what a former version emptied is stated at several times");
        }
        self.outcome.public_key = self.key.map(hex::encode);
        self.outcome
    }

    fn compare_heads(&mut self) {
        let mut unsigned: BTreeSet<String> = self
            .chains
            .iter()
            .filter(|(_, chain)| chain.head.is_some())
            .map(|(recipient, _)| recipient.clone())
            .collect();
        for stored in std::mem::take(&mut self.signed_heads) {
            unsigned.remove(&stored.recipient);
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
            let end = self.chains.get(&stored.recipient).map(ChainCheck::end).unwrap_or_default();
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
        for recipient in unsigned {
            self.fault(&recipient, 0, "the signed end of the chain was deleted");
        }
    }

    /// Compares the recipients beside the reports with the chains that have entries about them.
    fn compare_recipients(&mut self, chains: &BTreeMap<String, ChainCheck>) {
        let pruned = chains.iter().filter_map(|(recipient, chain)| {
            let anchor = chain.anchor.as_ref()?;
            Some((recipient.as_str(), anchor.last_entry_at.unix_micros()))
        });
        let pruned: BTreeMap<&str, i64> = pruned.collect();
        for recipient in std::mem::take(&mut self.awaited).finish(&pruned) {
            self.fault(
                recipient.as_str(),
                0,
                "an organisation stands beside a report of which its chain has no entry",
            );
        }
    }

    /// Compares the consent in its own table, and the preview that it was given on, with the entry.
    fn consent_faults(&self, event: &Event, at: i64) -> Vec<&'static str> {
        let Event::Consent { field, version, basis, .. } = event else { return Vec::new() };
        let mut faults = Vec::new();
        let stored = self.consents.get(&(field.to_string(), *version));
        if !stored.is_some_and(|stored| stored.decided_at == at && is_consent(event, stored)) {
            faults.push("the consent beside the ledger is not the one that was given");
        }
        let preview = basis.as_ref().and_then(|basis| basis.preview.as_ref());
        if preview.is_some_and(|preview| !self.previews.contains(preview)) {
            faults
                .push("the preview beside the ledger is not the one that the consent is based on");
        }
        faults
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
    let Event::Consent { mapping_state, value_source, policy, decided_by, basis, .. } = event
    else {
        return false;
    };
    let name = |value: serde_json::Value| value.as_str().map(str::to_owned);
    let stored_policy = serde_json::from_str::<disclosure::DisclosurePolicy>(&stored.policy).ok();
    let stored_basis = stored.basis.as_deref().map(serde_json::from_str::<DecisionBasis>);
    serde_json::to_value(mapping_state).ok().and_then(name).as_deref()
        == Some(&stored.mapping_state)
        && value_source.map(serde_json::to_value).and_then(Result::ok).and_then(name)
            == stored.value_source
        && stored_policy.as_ref() == Some(policy)
        && *decided_by == stored.decided_by
        && stored_basis.transpose().is_ok_and(|stored| {
            let stored = stored.filter(|basis| !basis.is_empty());
            stored.as_ref().map(basis_for_recipients) == *basis
        })
}
