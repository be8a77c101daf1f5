//! Reports that a broker has lost with its store, or turned round, as far as it may have had them: they arrive later, out
//! of their order.

use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
    time::Duration,
};

use serde_json::Value;

use super::{
    control::documents,
    stores::{self, ReportKey, ReportState, Unreceipted},
};
use crate::frame_order::{HAMBURG, MUNICH};

/// Reports of a hundred that may be excused from their order. The order of all others is judged.
const MAX: usize = 25;
/// The same beside a broker of another make, which says of no message where it is: everything is excused that may have been
/// on its way to the platform when a link or the broker ended.
const MAX_BESIDE_ANOTHER: usize = 50;
/// Time in which a broker that is ended has ended. What is made later comes to it once it runs again.
const ENDS_WITHIN: Duration = Duration::from_millis(500);

/// Reports that the platform held at a time.
pub(super) type Held = BTreeSet<ReportKey>;

/// Number of each factory's newest report at a time.
pub(super) type Newest = BTreeMap<&'static str, i64>;

/// Writer and sequence number.
type Number = (i64, i64);

/// Returns the reports that the broker, which does not run, may have had: those that left and have no receipt, and those
/// that wait as far as the connector knows and are in the broker's queue. One that waits and is in no queue cannot be
/// lost.
pub(super) async fn with_the_store(folder: &Path) -> anyhow::Result<Vec<ReportKey>> {
    let queued = stores::queued(folder).await?;
    let mut lost = Vec::new();
    for factory in [MUNICH, HAMBURG] {
        let queue = format!("factory.{factory}.ingress");
        let bodies = queued.iter().filter(|(name, _)| *name == queue);
        let numbers: BTreeSet<Number> = bodies.flat_map(|(_, body)| numbers(body)).collect();
        let reports = stores::unreceipted_reports(folder, factory).await?;
        lost.extend(reports.into_iter().filter_map(|Unreceipted { key, state, .. }| {
            let is_queued = numbers.contains(&(key.writer, key.sequence));
            (state == ReportState::Sent || is_queued).then_some(key)
        }));
    }
    Ok(lost)
}

/// Returns the reports that the platform holds: they come no more, whatever is turned round from then on.
pub(super) async fn held(folder: &Path) -> anyhow::Result<Held> {
    let mut held = Held::new();
    for factory in [MUNICH, HAMBURG] {
        held.extend(stores::held(folder, factory).await?);
    }
    Ok(held)
}

/// Returns the newest reports once a broker that begins to end now has ended.
pub(super) async fn newest_at_its_end(folder: &Path) -> anyhow::Result<Newest> {
    tokio::time::sleep(ENDS_WITHIN).await;
    let mut newest = Newest::new();
    for factory in [MUNICH, HAMBURG] {
        newest.insert(factory, stores::spool(folder, factory).await?.last);
    }
    Ok(newest)
}

/// Returns the reports that may be on their way to the platform, which held others before.
pub(super) async fn on_the_way(
    folder: &Path,
    held: &Held,
    newest: Option<&Newest>,
) -> anyhow::Result<Vec<ReportKey>> {
    let mut found = Vec::new();
    for factory in [MUNICH, HAMBURG] {
        let newest = newest.and_then(|newest| newest.get(factory).copied());
        let reports = stores::unreceipted_reports(folder, factory).await?;
        found.extend(may_be_on_the_way(reports, held, newest));
    }
    Ok(found)
}

/// Leaves out what the platform held before, and what was made after the broker's end.
fn may_be_on_the_way(
    reports: Vec<Unreceipted>,
    held: &Held,
    newest: Option<i64>,
) -> impl Iterator<Item = ReportKey> {
    let there_in_time = move |report: &Unreceipted| newest.is_none_or(|newest| report.id <= newest);
    let in_time = reports.into_iter().filter(there_in_time).map(|report| report.key);
    in_time.filter(move |key| !held.contains(key))
}

/// Returns the numbers of the reports in a message.
fn numbers(body: &[u8]) -> Vec<Number> {
    let documents = documents(body);
    let reports = documents.iter().filter_map(|document| document["Messages"].as_array()).flatten();
    let number = |report: &Value, name: &str| report[name].as_i64();
    reports
        .filter_map(|report| {
            number(report, "DataSetWriterId").zip(number(report, "SequenceNumber"))
        })
        .collect()
}

/// Returns the share of reports that are excused from their order, for people, and the fault where it is too large.
pub(super) fn share(excused: usize, left: usize, is_external: bool) -> (String, Option<String>) {
    let part = excused * 100 / left.max(1);
    let most = if is_external { MAX_BESIDE_ANOTHER } else { MAX };
    let fault = (part > most)
        .then(|| format!("{excused} of {left} reports are excused from their order, {part} %"));
    (format!("{part} %"), fault)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_reports_of_a_message_are_found_by_their_numbers() {
        let body =
            b"\0Sx{\"MessageId\":\"m\",\"Messages\":[{\"DataSetWriterId\":3,\"SequenceNumber\":7,\
            \"Payload\":{}},{\"DataSetWriterId\":4,\"SequenceNumber\":0}]}\0{\"fieldName\":\"f\"}";
        assert_eq!(numbers(body), [(3, 7), (4, 0)]);
    }

    #[test]
    fn too_many_excuses_are_a_fault() {
        assert_eq!(share(250, 1000, false), ("25 %".to_owned(), None));
        assert!(share(260, 1000, false).1.is_some());
        assert_eq!(share(0, 0, false).1, None);
        assert_eq!(share(500, 1000, true).1, None);
        assert!(share(510, 1000, true).1.is_some());
    }

    #[test]
    fn what_is_held_or_was_made_after_the_end_has_no_excuse() {
        let key = |sequence| ReportKey { factory: "F".into(), writer: 1, epoch: 1, sequence };
        let report =
            |sequence, state| Unreceipted { key: key(sequence), id: 100 + sequence, state };
        let reports = || {
            let sent = [1, 2, 3].map(|sequence| report(sequence, ReportState::Sent));
            sent.into_iter().chain([report(4, ReportState::Waiting)]).collect::<Vec<_>>()
        };
        let held = BTreeSet::from([key(1)]);
        let excused = |newest| may_be_on_the_way(reports(), &held, newest).collect::<Vec<_>>();
        assert_eq!(excused(None), [key(2), key(3), key(4)]);
        assert_eq!(excused(Some(103)), [key(2), key(3)]);
        assert!(excused(Some(100)).is_empty());
    }
}
