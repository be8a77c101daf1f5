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

use crate::{
    ingest::{decode::Incoming, unit::IngestUnit},
    live::{FieldUpdate, LiveEvent, Notification},
    store::{FieldRow, Scope, StoreError, WriterKey},
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
        unit.work.past_releases().add(release).await?;
        self.0.push(release.clone());
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
