//! Arbitration of access in the transaction that applies messages: what comes from a factory or tool
//! whose credentials were revoked is rejected, whatever broker let it through.

use std::collections::HashMap;

use asi_model::DateTime;
use messaging::LogicalAddress;

use super::{dead_letter::holder, decode::Incoming, unit::IngestUnit};
use crate::store::StoreError;

/// Code of dead letters whose sender has no access any more.
const ACCESS_REVOKED: &str = "ACCESS_REVOKED";

/// Judges messages within one unit of ingest.
#[derive(Default)]
pub(super) struct AccessArbiter {
    known: HashMap<LogicalAddress, Option<DateTime>>,
}

impl AccessArbiter {
    /// Returns true for a message of a sender that has access. Any other one becomes a dead letter and leaves
    /// no further trace: a connector that enrols again sends what was not receipted once more.
    pub(super) async fn admit(
        &mut self,
        unit: &mut IngestUnit<'_>,
        address: &LogicalAddress,
        incoming: &Incoming,
    ) -> Result<bool, StoreError> {
        if !self.known.contains_key(address) {
            let revoked_at = unit.work.revoked_access().of(address).await?;
            self.known.insert(address.clone(), revoked_at);
        }
        let Some(revoked_at) = self.known.get(address).copied().flatten() else { return Ok(true) };
        let who = holder(&address.to_string());
        let reason = format!(
            "The credentials of {who} were revoked at {revoked_at}, and it did not enrol again."
        );
        unit.reject(address, incoming, ACCESS_REVOKED, reason).await?;
        Ok(false)
    }
}
