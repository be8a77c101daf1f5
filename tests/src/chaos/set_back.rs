//! Reports that a broker has lost with its store, as far as it may have had them: they arrive later, out of their order.

use std::{collections::BTreeSet, path::Path};

use serde_json::Value;

use super::{
    control::documents,
    stores::{self, ReportKey, ReportState},
};
use crate::frame_order::{HAMBURG, MUNICH};

/// Reports of a hundred that may be excused from their order. The order of all others is judged.
const MAX: usize = 25;
/// The same beside a broker of another make: what it had when it ended is not known, so that everything is excused that
/// had no receipt then.
const MAX_BESIDE_ANOTHER: usize = 75;

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
        lost.extend(reports.into_iter().filter_map(|(key, state)| {
            let is_queued = numbers.contains(&(key.writer, key.sequence));
            (state == ReportState::Sent || is_queued).then_some(key)
        }));
    }
    Ok(lost)
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
        assert_eq!(share(750, 1000, true).1, None);
        assert!(share(760, 1000, true).1.is_some());
    }
}
