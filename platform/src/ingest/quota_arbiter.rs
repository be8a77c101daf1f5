//! Quotas of a factory in what the platform keeps of its messages, and of who asks in answers that wait. What exceeds
//! one becomes a dead letter of that sender, and others do not feel it.

use std::collections::{BTreeSet, HashMap};

use asi_model::{FactoryId, messages::FactoryMessage};
use messaging::LogicalAddress;

use super::{
    decode::{Content, Incoming},
    unit::IngestUnit,
};
use crate::store::{ANSWERS_WAITING_MAX, Holder, Kept, StoreError};

/// Share of a factory in missing ranges and announced gaps.
pub(super) const GAPS: &str = "gaps";
/// Share of a factory or tool in answers that wait for it.
pub(super) const ANSWERS: &str = "answers";
/// Code of dead letters whose factory has used a quota up.
pub(super) const QUOTA_EXCEEDED: &str = "QUOTA_EXCEEDED";
/// Most writers of a factory, each epoch counted by itself.
const WRITERS_MAX: u64 = 10_000;

/// Bounds of one kind of rows.
#[derive(Debug, Clone, Copy)]
struct Quota {
    /// Value of the metric's label `share`.
    share: &'static str,
    /// The rows in words, for people.
    what: &'static str,
    rows_max: u64,
    bytes_max: u64,
}

const META_DATA: Quota = Quota {
    share: "meta_data",
    what: "writers with metadata",
    rows_max: 10_000,
    // The description of a structure takes some eight times its JSON in memory.
    bytes_max: 16 * 1024 * 1024,
};
/// Ranges, each of which is read with the reports of its request. A release of 500 more may exceed it.
const PAST_RELEASES: Quota = Quota {
    share: "past_releases",
    what: "ranges of the past that were released",
    rows_max: 10_000,
    bytes_max: u64::MAX,
};
const OFFERS: Quota = Quota {
    share: "offers",
    what: "offers of assets",
    rows_max: 2_000,
    bytes_max: 16 * 1024 * 1024,
};
const REVOCATIONS: Quota = Quota {
    share: "revocations",
    what: "receipts of revocations",
    rows_max: 10_000,
    bytes_max: 64 * 1024 * 1024,
};
/// Logs: one for each recipient, and one more each time that a factory replaces it.
const LEDGER_LOGS: Quota = Quota {
    share: "ledger_logs",
    what: "logs of its ledger",
    rows_max: 2_000,
    bytes_max: 16 * 1024 * 1024,
};
const COMMENTS: Quota = Quota {
    share: "comments",
    what: "comments on a network",
    rows_max: 2_000,
    bytes_max: 16 * 1024 * 1024,
};

/// Holds messages of one unit of ingest against the quotas of their factories.
#[derive(Default)]
pub(super) struct QuotaArbiter {
    /// Writers of each factory, those of this unit included.
    writers: HashMap<FactoryId, u64>,
}

impl QuotaArbiter {
    /// Returns true for a message that fits into the quotas of its factory. Any other one becomes a dead
    /// letter that names the quota and its limit.
    pub(super) async fn admit(
        &mut self,
        unit: &mut IngestUnit<'_>,
        address: &LogicalAddress,
        incoming: &Incoming,
    ) -> Result<bool, StoreError> {
        let mut refusal = answers_refused(unit, incoming).await?;
        if let LogicalAddress::FactoryIngress(factory) = address {
            if refusal.is_none() {
                refusal = self.writers_refused(unit, factory, incoming).await?;
            }
            if refusal.is_none() {
                refusal = rows_refused(unit, factory, incoming).await?;
            }
        }
        let Some((share, reason)) = refusal else { return Ok(true) };
        unit.effects.refused(share, Holder::of(address));
        unit.reject(address, incoming, QUOTA_EXCEEDED, reason).await?;
        Ok(false)
    }

    /// Returns share and reason where a message would make more writers than a factory may have.
    async fn writers_refused(
        &mut self,
        unit: &mut IngestUnit<'_>,
        factory: &FactoryId,
        incoming: &Incoming,
    ) -> Result<Option<(&'static str, String)>, StoreError> {
        let mut new = 0;
        for (writer, epoch) in writers_of(&incoming.content) {
            new += u64::from(!unit.knows_writer(factory, writer, epoch).await?);
        }
        if new == 0 {
            return Ok(None);
        }
        if !self.writers.contains_key(factory) {
            let count = unit.work.writers().count(factory).await?;
            self.writers.insert(factory.clone(), count);
        }
        let count = self.writers.entry(factory.clone()).or_default();
        if *count + new > WRITERS_MAX {
            let reason = format!(
                "{factory} has {WRITERS_MAX} data set writers and epochs, the most allowed."
            );
            return Ok(Some(("writers", reason)));
        }
        *count += new;
        Ok(None)
    }
}

/// Returns share and reason where a message asks for an answer, and its sender reads none.
async fn answers_refused(
    unit: &mut IngestUnit<'_>,
    incoming: &Incoming,
) -> Result<Option<(&'static str, String)>, StoreError> {
    let reader = match &incoming.content {
        Content::DataRequest(request) => LogicalAddress::ToolReports(request.tool_id.clone()),
        Content::Factory(message) => match &**message {
            FactoryMessage::LedgerCheckpoint(checkpoint) => {
                LogicalAddress::FactoryRequests(checkpoint.factory_id.clone())
            }
            _ => return Ok(None),
        },
        _ => return Ok(None),
    };
    if unit.work.outgoing().takes_answers(&reader).await? {
        return Ok(None);
    }
    let reason = format!(
        "{ANSWERS_WAITING_MAX} answers wait at {reader}, the most allowed: read them first."
    );
    Ok(Some((ANSWERS, reason)))
}

/// Returns share and reason where a message would add to rows of which a factory has the most allowed.
async fn rows_refused(
    unit: &mut IngestUnit<'_>,
    factory: &FactoryId,
    incoming: &Incoming,
) -> Result<Option<(&'static str, String)>, StoreError> {
    let mut kept = unit.work.quotas();
    let (quota, kept) = match &incoming.content {
        Content::MetaData(writer, _) => (META_DATA, kept.meta_data(factory, *writer).await?),
        Content::Factory(message) => match &**message {
            FactoryMessage::AssetOffer(offer) => {
                (OFFERS, kept.offers(factory, &offer.asset_id).await?)
            }
            FactoryMessage::PastRelease(_) => (PAST_RELEASES, kept.past_releases(factory).await?),
            FactoryMessage::Revocation(_) => (REVOCATIONS, kept.revocations(factory).await?),
            FactoryMessage::LedgerCheckpoint(checkpoint) => {
                let except = (&checkpoint.recipient_id, checkpoint.epoch);
                (LEDGER_LOGS, kept.ledger_logs(factory, except).await?)
            }
            FactoryMessage::Comment(comment) => {
                let network = &comment.operation_network_id;
                (COMMENTS, kept.comments_of_factory(network, factory).await?)
            }
            _ => return Ok(None),
        },
        _ => return Ok(None),
    };
    let bytes = u64::try_from(incoming.body.len()).unwrap_or(u64::MAX);
    Ok(quota.refusal(kept, bytes).map(|reason| (quota.share, format!("{factory} has {reason}."))))
}

impl Quota {
    /// Returns what there is too much of, where one more row of so many bytes does not fit.
    fn refusal(self, kept: Kept, bytes: u64) -> Option<String> {
        let Self { what, rows_max, bytes_max, .. } = self;
        if kept.rows >= rows_max {
            return Some(format!("{rows_max} {what}, the most allowed"));
        }
        let is_full = kept.bytes.saturating_add(bytes) > bytes_max;
        is_full.then(|| format!("{what} of {} bytes; {bytes_max} are allowed", kept.bytes))
    }
}

/// Returns the writers that a message needs, each with its epoch.
fn writers_of(content: &Content) -> BTreeSet<(u16, u32)> {
    match content {
        Content::Reports { reports, keep_alives, .. } => {
            let of_reports = reports.iter().map(|one| (one.data_set_writer_id, one.epoch));
            of_reports.chain(keep_alives.iter().copied()).collect()
        }
        Content::Factory(message) => match &**message {
            FactoryMessage::Gap(gap) => BTreeSet::from([(gap.data_set_writer_id, gap.epoch)]),
            FactoryMessage::ReceiptRequest(request) => {
                let asked = request.writer_list.iter();
                asked.map(|writer| (writer.data_set_writer_id, writer.epoch)).collect()
            }
            _ => BTreeSet::new(),
        },
        _ => BTreeSet::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_and_bytes_are_bounded() {
        let quota = Quota { share: "s", what: "things", rows_max: 2, bytes_max: 10 };
        let refusal = |rows, bytes, more| quota.refusal(Kept { rows, bytes }, more);
        assert_eq!(refusal(1, 4, 6), None);
        assert_eq!(refusal(2, 4, 6).as_deref(), Some("2 things, the most allowed"));
        assert_eq!(refusal(1, 5, 6).as_deref(), Some("things of 5 bytes; 10 are allowed"));
    }
}
