//! Arbitration of signatures in the transaction that applies messages: what is not of a factory's key
//! is rejected, and the key of a first signature pinned.

use std::collections::HashMap;

use asi_model::FactoryId;
use messaging::LogicalAddress;

use super::{
    decode::{Content, Incoming},
    unit::IngestUnit,
};
use crate::{
    signing::{SigningState, Standing, UNSIGNED, WRONG_SIGNATURE},
    store::StoreError,
};

/// Judges messages within one unit of ingest, and pins the keys of first signatures.
#[derive(Default)]
pub(super) struct SignatureArbiter {
    known: HashMap<FactoryId, SigningState>,
}

impl SignatureArbiter {
    /// Returns true for a message that may take effect. Any other one becomes a dead letter and
    /// leaves no further trace: neither its sender nor its numbers count as heard of, so that the
    /// message as it was sent still can come.
    pub(super) async fn admit(
        &mut self,
        unit: &mut IngestUnit<'_>,
        address: &LogicalAddress,
        incoming: &Incoming,
    ) -> Result<bool, StoreError> {
        let LogicalAddress::FactoryIngress(factory) = address else { return Ok(true) };
        if let Content::Dead(letter) = &incoming.content
            && [UNSIGNED, WRONG_SIGNATURE].contains(&letter.code)
        {
            count(factory);
            unit.add_dead_letter(letter).await?;
            return Ok(false);
        }
        // Again, since a message before it in this unit, or an administrator, may have changed it.
        if !self.known.contains_key(factory) {
            let known = unit.work.signing_keys().of_factory(factory).await?;
            self.known.insert(factory.clone(), known);
        }
        let Some(known) = self.known.get_mut(factory) else { return Ok(true) };
        match (known.judge(incoming.signer.as_ref()), incoming.signer) {
            (Ok(Standing::FirstSigned), Some(key)) => {
                unit.work.signing_keys().pin(factory, &key, unit.now).await?;
                known.pin(key);
                tracing::info!(factory.id = %factory, key = %key, "A factory signs its messages from now on.");
                Ok(true)
            }
            (Ok(_), _) => Ok(true),
            (Err(refusal), _) => {
                count(factory);
                let reason = refusal.reason(factory);
                unit.reject(address, incoming, refusal.code(), reason).await?;
                Ok(false)
            }
        }
    }
}

fn count(factory: &FactoryId) {
    metrics::counter!("verbund_forged_messages_total", "factory" => factory.to_string())
        .increment(1);
}
