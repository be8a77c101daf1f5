//! Releases of the past: a factory shows reports that had left for others to one more recipient.
//!
//! Nothing else widens who may read a report. The release has to come from the factory whose
//! reports these are, name a request that it was asked and a recipient in effect, and it opens the
//! named reports alone. Those that are still on their way are for the recipient once they arrive.

use asi_model::{
    FactoryId, OrganisationId, RequestKey,
    messages::{PastRelease, ReportRange},
};
use messaging::LogicalAddress;

use super::from_factories::request_path;
use crate::{
    ingest::{decode::Incoming, unit::IngestUnit},
    live::{FieldUpdate, LiveEvent, Notification},
    store::{AuditFact, AuditFactKind, FieldRow, Scope, StoreError, WriterKey},
};

/// Releases of one unit of ingest, applied to the stored reports at its end.
#[derive(Default)]
pub(super) struct PastReleaseCollector(Vec<PastRelease>);

impl PastReleaseCollector {
    /// Stores a release, or sets it aside with a reason; then nothing of it takes effect.
    pub(super) async fn collect(
        &mut self,
        unit: &mut IngestUnit<'_>,
        address: &LogicalAddress,
        incoming: &Incoming,
        release: &PastRelease,
    ) -> Result<(), StoreError> {
        let request = request_of(release);
        let (network, id) = (&release.operation_network_id, &release.dynamic_data_request_id);
        let asked = unit.work.asked_requests().of_request(network, id).await?;
        let was_asked = |(factory, operation): &(_, _)| {
            *factory == release.factory_id && *operation == release.operation_id
        };
        if !asked.iter().any(was_asked) {
            return unit.reject_foreign(address, incoming, &release.factory_id, &request).await;
        }
        let recipients = unit.work.recipients().of_request(network, id).await?;
        if !recipients.iter().any(|known| known.organisation_id == release.recipient_id) {
            let reason = format!("{} is no recipient of {request}.", release.recipient_id);
            return unit.reject(address, incoming, "NOT_A_RECIPIENT", reason).await;
        }
        for range in &release.range_list {
            if !is_of_request(unit, release, range).await? {
                let writer = range.data_set_writer_id;
                let reason = format!("The writer {writer} has no reports about {request}.");
                return unit.reject(address, incoming, "UNKNOWN_RANGE", reason).await;
            }
        }
        // What was released before is not looked at again: so each report is, once for each recipient.
        let stored = unit.work.past_releases().of_request(network, id).await?;
        let stored = stored.iter().filter(|stored| {
            stored.factory_id == release.factory_id
                && stored.operation_id == release.operation_id
                && stored.organisation_id == release.recipient_id
        });
        let mut known: Vec<ReportRange> = stored.map(|stored| stored.range).collect();
        let mut new = Vec::new();
        for range in &release.range_list {
            let parts = parts_beyond(*range, &known);
            known.extend(&parts);
            new.extend(parts);
        }
        if new.is_empty() {
            return Ok(());
        }
        let release = PastRelease { range_list: new, ..release.clone() };
        unit.work.past_releases().add(&release).await?;
        let recipient = &release.recipient_id;
        let path = format!("{}/recipients/{recipient}", request_path(&request));
        let facts: Vec<AuditFact> = release.range_list.iter().map(reports).collect();
        unit.record_change(&release.factory_id, "releasePast", path, &facts).await?;
        self.0.push(release);
        Ok(())
    }

    /// Widens the stored reports, and tells the recipients of values that are current.
    pub(super) async fn widen(self, unit: &mut IngestUnit<'_>) -> Result<(), StoreError> {
        for release in self.0 {
            unit.work.past_releases().widen(&release).await?;
            unit.effects.networks.insert(release.operation_network_id.clone());
            notify_recipient(unit, &release).await?;
        }
        Ok(())
    }
}

/// Returns reports by writer, epoch and sequence numbers.
fn reports(range: &ReportRange) -> AuditFact {
    let ReportRange { data_set_writer_id, epoch, first_sequence, last_sequence } = range;
    let range = format!("{data_set_writer_id}/{epoch}/{first_sequence}-{last_sequence}");
    AuditFact::new(AuditFactKind::Reports, range)
}

fn request_of(release: &PastRelease) -> RequestKey {
    RequestKey {
        operation_network_id: release.operation_network_id.clone(),
        operation_id: release.operation_id.clone(),
        dynamic_data_request_id: release.dynamic_data_request_id.clone(),
    }
}

/// Returns true for a range of a writer that is known, and not known to report about another
/// request in this epoch.
async fn is_of_request(
    unit: &mut IngestUnit<'_>,
    release: &PastRelease,
    range: &ReportRange,
) -> Result<bool, StoreError> {
    let key = WriterKey {
        factory_id: release.factory_id.clone(),
        data_set_writer_id: range.data_set_writer_id,
        epoch: range.epoch,
    };
    let Some((network, request)) = unit.reported_about(&key).await? else {
        // Its reports may be on their way still, and its metadata came before them.
        let writer = range.data_set_writer_id;
        return unit.work.past_releases().is_known_writer(&release.factory_id, writer).await;
    };
    Ok(network == release.operation_network_id.as_str()
        && request == release.dynamic_data_request_id.as_str())
}

/// Sends open pages of the recipient the current values that came in the reports.
async fn notify_recipient(
    unit: &mut IngestUnit<'_>,
    release: &PastRelease,
) -> Result<(), StoreError> {
    let request = request_of(release);
    let scope = Scope::Organisation(release.recipient_id.clone());
    let rows = unit.work.fields().list(&scope, &release.operation_network_id).await?;
    let rows = rows.retain_with(release, is_released);
    if rows.is_empty() {
        return Ok(());
    }
    let event = rows.map_with((request, release.factory_id.clone()), event);
    let audience: Vec<OrganisationId> = vec![release.recipient_id.clone()];
    unit.effects.notifications.push(Notification::of_values(event, audience));
    Ok(())
}

fn event((request, factory_id): (RequestKey, FactoryId), rows: Vec<FieldRow>) -> LiveEvent {
    let current = rows.iter().filter_map(|row| row.current.as_ref());
    LiveEvent::Value { request, factory_id, fields: current.map(FieldUpdate::from).collect() }
}

/// Returns true for a field whose current value came in one of the ranges.
fn is_released(release: &PastRelease, row: &FieldRow) -> bool {
    row.key.request == request_of(release)
        && row.factory_id == release.factory_id
        && row.current.as_ref().is_some_and(|value| {
            release.range_list.iter().any(|range| {
                range.epoch == value.epoch
                    && (range.first_sequence..=range.last_sequence).contains(&value.sequence)
            })
        })
}

/// Returns the parts of a range that are in none of the others, ascending.
fn parts_beyond(range: ReportRange, others: &[ReportRange]) -> Vec<ReportRange> {
    let mut others: Vec<_> = others
        .iter()
        .filter(|other| {
            (other.data_set_writer_id, other.epoch) == (range.data_set_writer_id, range.epoch)
        })
        .collect();
    others.sort_by_key(|other| other.first_sequence);
    let mut parts = Vec::new();
    let mut next = u64::from(range.first_sequence);
    for other in others {
        if u64::from(other.first_sequence) > next && next <= u64::from(range.last_sequence) {
            let last = (other.first_sequence - 1).min(range.last_sequence);
            parts.push((next, last));
        }
        next = next.max(u64::from(other.last_sequence) + 1);
    }
    if next <= u64::from(range.last_sequence) {
        parts.push((next, range.last_sequence));
    }
    let part = |(first, last_sequence): (u64, u32)| {
        let first_sequence = u32::try_from(first).unwrap_or(u32::MAX);
        ReportRange { first_sequence, last_sequence, ..range }
    };
    parts.into_iter().map(part).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn range(first_sequence: u32, last_sequence: u32) -> ReportRange {
        ReportRange { data_set_writer_id: 1, epoch: 7, first_sequence, last_sequence }
    }

    fn beyond(first: u32, last: u32, others: &[(u32, u32)]) -> Vec<(u32, u32)> {
        let mut others: Vec<_> = others.iter().map(|(first, last)| range(*first, *last)).collect();
        // Of another writer.
        others.push(ReportRange { data_set_writer_id: 2, ..range(0, u32::MAX) });
        let parts = parts_beyond(range(first, last), &others);
        parts.iter().map(|part| (part.first_sequence, part.last_sequence)).collect()
    }

    #[test]
    fn a_range_is_released_where_none_was_before() {
        assert_eq!(beyond(3, 9, &[]), [(3, 9)]);
        assert_eq!(beyond(3, 9, &[(0, 20)]), Vec::<(u32, u32)>::new());
        assert_eq!(beyond(3, 9, &[(5, 6)]), [(3, 4), (7, 9)]);
        assert_eq!(beyond(3, 9, &[(8, 20), (0, 3), (5, 5)]), [(4, 4), (6, 7)]);
        assert_eq!(beyond(3, 9, &[(10, 20), (0, 2)]), [(3, 9)]);
        assert_eq!(beyond(0, u32::MAX, &[(0, 5), (7, u32::MAX)]), [(6, 6)]);
    }
}
