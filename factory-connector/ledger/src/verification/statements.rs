//! Signed statements beside the entries: anchors, checkpoints, their seal, receipts, and the logs'
//! checkpoints.

use std::collections::{BTreeMap, BTreeSet};

use transparency_log::{Checkpoint, KeyKind, SignedNote, VerifierKey};

use super::{
    StoredSeal, StoredStatement, Verifier,
    chain::ChainCheck,
    log::{LogCheck, StoredLog},
};
use crate::{Anchor, Hash, Head, HeadsCheckpoint, RevocationReceipt, seal::is_signed_seal};

impl Verifier {
    pub(super) fn anchor(&mut self, stored: &StoredStatement) {
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
        let start = Head { number: anchor.number, hash };
        self.chains.insert(stored.name.clone(), ChainCheck::after(start, anchor));
    }

    /// Starts the check of each chain's log. Every chain has one, unless the store is one of a former
    /// version that was not opened since.
    pub(super) fn open_logs(&mut self, logs: Vec<StoredLog>, kept: &[String]) {
        let mut without: BTreeSet<String> =
            self.signed_heads.iter().map(|head| head.recipient.clone()).collect();
        // Without a trusted key any single one is accepted, as for everything that is signed.
        let first = self.signed_heads.first().map(|head| head.public_key.as_slice());
        let key = self.key.or_else(|| first?.try_into().ok());
        let mut kept = self.kept_checkpoints(kept, key.as_ref());
        for stored in logs {
            let recipient = stored.recipient.clone();
            without.remove(&recipient);
            if stored.is_empty() && self.is_former {
                continue;
            }
            let kept = kept.remove(&recipient).unwrap_or_default();
            let chain = self.chains.entry(recipient.clone()).or_default();
            let anchor = chain.anchor.as_ref();
            match LogCheck::new(stored, &self.factory_id, (anchor, kept), key.as_ref()) {
                Ok(check) => chain.log = Some(check),
                Err(fault) => self.fault(&recipient, 0, fault),
            }
        }
        for recipient in without {
            self.fault(&recipient, 0, "the log of the chain was deleted");
        }
        for recipient in kept.into_keys() {
            self.fault(
                &recipient,
                0,
                "a checkpoint that was kept elsewhere is about a log that is missing",
            );
        }
    }

    /// Reads checkpoints that were kept elsewhere, by the recipients of their logs.
    fn kept_checkpoints(
        &mut self,
        notes: &[String],
        key: Option<&Hash>,
    ) -> BTreeMap<String, Vec<Checkpoint>> {
        let mut kept: BTreeMap<String, Vec<Checkpoint>> = BTreeMap::new();
        for note in notes {
            match kept_checkpoint(&self.factory_id, note, key) {
                Some((recipient, checkpoint)) => {
                    kept.entry(recipient).or_default().push(checkpoint);
                }
                None => self.fault(
                    "",
                    0,
                    "a checkpoint that was kept elsewhere is not one of this ledger and its key",
                ),
            }
        }
        kept
    }

    pub(super) fn checkpoint(&mut self, number: u64, stored: &StoredStatement) {
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

    pub(super) fn revocation(&mut self, stored: &StoredStatement) {
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

    /// Compares the number of checkpoints with the signed one.
    pub(super) fn seal(&mut self, stored: Option<&StoredSeal>, count: u64) {
        let Some(stored) = stored else {
            if !self.is_former {
                self.fault("", count, "the signed number of the checkpoints was deleted");
            }
            return;
        };
        let number = u64::try_from(stored.number).unwrap_or(u64::MAX);
        let is_signed =
            is_signed_seal(&self.factory_id, number, &stored.signature, &stored.public_key);
        if !(is_signed && self.is_known(&stored.public_key)) {
            self.fault("", number, "the signed number of the checkpoints was changed");
        }
        if number != count {
            self.fault("", number, "the checkpoints are not as many as were signed");
        }
    }
}

/// Reads a checkpoint of a log of this ledger, with the recipient that the log is about.
fn kept_checkpoint(
    factory_id: &str,
    note: &str,
    key: Option<&Hash>,
) -> Option<(String, Checkpoint)> {
    let note = SignedNote::parse(note).ok()?;
    let checkpoint: Checkpoint = note.text().parse().ok()?;
    let (factory, log) = checkpoint.origin.split_once("/to/")?;
    if factory != factory_id {
        return None;
    }
    let verifier = VerifierKey::new(&checkpoint.origin, KeyKind::Ed25519, key?).ok()?;
    note.verify([&verifier]).ok()?;
    // A later log of the same chain has a number behind the recipient.
    let recipient = log.split('/').next()?.to_owned();
    Some((recipient, checkpoint))
}
