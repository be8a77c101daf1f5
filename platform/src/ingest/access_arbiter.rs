//! Arbitration of access in the transaction that applies messages: what comes from a factory or tool
//! whose credentials were revoked is rejected, whatever broker let it through.

use std::collections::HashMap;

use asi_model::DateTime;
use messaging::LogicalAddress;

use super::{dead_letter::holder, decode::Incoming, unit::IngestUnit};
use crate::store::{Holder, StoreError};

/// Code of dead letters whose sender has no access any more.
const ACCESS_REVOKED: &str = "ACCESS_REVOKED";

/// Access of a sender.
#[derive(Debug, Clone, Copy)]
enum SenderAccess {
    Granted,
    RevokedAt(DateTime),
    /// The sender has left.
    Left,
}

/// Judges messages within one unit of ingest.
#[derive(Default)]
pub(super) struct AccessArbiter {
    known: HashMap<LogicalAddress, SenderAccess>,
}

impl AccessArbiter {
    /// Returns true for a message of a sender that has access. One of a sender without becomes a dead letter and
    /// leaves no further trace: a connector that enrols again sends what was not receipted once more. One of a
    /// sender that has left leaves none at all.
    pub(super) async fn admit(
        &mut self,
        unit: &mut IngestUnit<'_>,
        address: &LogicalAddress,
        incoming: &Incoming,
    ) -> Result<bool, StoreError> {
        match self.access(unit, address).await? {
            SenderAccess::Granted => Ok(true),
            SenderAccess::Left => {
                tracing::warn!(%address, "A message of a factory or tool that has left was dropped.");
                Ok(false)
            }
            SenderAccess::RevokedAt(revoked_at) => {
                let who = holder(&address.to_string());
                let reason = format!(
                    "The credentials of {who} were revoked at {revoked_at}, and it did not enrol again."
                );
                unit.reject(address, incoming, ACCESS_REVOKED, reason).await?;
                Ok(false)
            }
        }
    }

    async fn access(
        &mut self,
        unit: &mut IngestUnit<'_>,
        address: &LogicalAddress,
    ) -> Result<SenderAccess, StoreError> {
        if let Some(known) = self.known.get(address) {
            return Ok(*known);
        }
        let has_left = match Holder::of(address) {
            Some(sender) => unit.work.removals().has_left(&sender).await?,
            None => false,
        };
        let access = match unit.work.revoked_access().of(address).await? {
            _ if has_left => SenderAccess::Left,
            Some(revoked_at) => SenderAccess::RevokedAt(revoked_at),
            None => SenderAccess::Granted,
        };
        self.known.insert(address.clone(), access);
        Ok(access)
    }
}
