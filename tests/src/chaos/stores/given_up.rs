//! Reports that a connector gave up, and what it announced of them.

use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};

use anyhow::Context as _;
use serde_json::Value;
use sqlx::{Connection as _, Row as _};

use super::{Left, ReportKey, connector_store, open, platform_store};
use crate::chaos::interruptions::Interruptions;

/// Reports by why they were given up: an event of the ledger, or the cause of an announced gap.
pub(in crate::chaos) type Causes = BTreeMap<ReportKey, BTreeSet<String>>;

const COALESCED: &str = "COALESCED";
const PURGED: &str = "PURGED";

/// Reasons for which one factory may give reports up. No run is as long as reports are kept.
pub(in crate::chaos) struct Reasons<'r> {
    /// Everything that ever left it.
    pub left: &'r BTreeMap<ReportKey, Left>,
    /// Request of which consents end and change. Those to all others stay, and nothing is withdrawn.
    pub toggled: &'r str,
    /// Times in which its spool may have been too small; none where it is large.
    pub interruptions: Option<&'r Interruptions>,
}

impl Reasons<'_> {
    fn allow(&self, key: &ReportKey, event: &str) -> bool {
        let Some(report) = self.left.get(key) else { return false };
        match event {
            COALESCED => self.interruptions.is_some_and(|all| all.has(report.id)),
            PURGED => report.content.request == self.toggled,
            _ => false,
        }
    }
}

fn add(causes: &mut Causes, factory: &str, numbers: [i64; 4], cause: &str) {
    let [writer, epoch, first, last] = numbers;
    for sequence in first..=last {
        let key = ReportKey { factory: factory.to_owned(), writer, epoch, sequence };
        causes.entry(key).or_default().insert(cause.to_owned());
    }
}

/// Returns the reports that a connector gave up, as its ledger says.
pub(in crate::chaos) async fn given_up(folder: &Path, factory: &str) -> anyhow::Result<Causes> {
    let mut store = open(&connector_store(folder, factory)).await?;
    let rows = sqlx::query(
        "SELECT content FROM ledger_entry \
         WHERE json_extract(content, '$.event') IN ('COALESCED', 'EXPIRED', 'PURGED')",
    )
    .fetch_all(&mut store)
    .await?;
    // As after `left`.
    store.close().await?;
    let mut causes = Causes::new();
    for row in rows {
        let entry: Value = serde_json::from_str(row.get("content"))?;
        let number =
            |name: &str| entry[name].as_i64().with_context(|| format!("{name} of {entry}"));
        let numbers = [
            number("dataSetWriterId")?,
            number("epoch")?,
            number("firstSequence")?,
            number("lastSequence")?,
        ];
        add(&mut causes, factory, numbers, entry["event"].as_str().unwrap_or_default());
    }
    Ok(causes)
}

/// Returns how many entries of a connector's ledger say that its spool was too small.
pub(in crate::chaos) async fn overflows(folder: &Path, factory: &str) -> anyhow::Result<i64> {
    let mut store = open(&connector_store(folder, factory)).await?;
    let sql =
        "SELECT count(*) AS count FROM ledger_entry WHERE json_extract(content, '$.event') = ?";
    Ok(sqlx::query(sql).bind(COALESCED).fetch_one(&mut store).await?.get("count"))
}

/// Returns every gap that a factory has announced: the reports it gave up.
pub(in crate::chaos) async fn gaps(folder: &Path, factory: &str) -> anyhow::Result<Causes> {
    let mut store = open(&platform_store(folder)).await?;
    let rows = sqlx::query(
        "SELECT data_set_writer_id, epoch, first_sequence, last_sequence, cause \
         FROM sequence_gap WHERE factory_id = ?",
    )
    .bind(factory)
    .fetch_all(&mut store)
    .await?;
    let mut causes = Causes::new();
    for row in rows {
        let numbers = ["data_set_writer_id", "epoch", "first_sequence", "last_sequence"];
        let numbers = numbers.map(|name| row.get::<i64, _>(name));
        add(&mut causes, factory, numbers, row.get::<&str, _>("cause").trim_matches('"'));
    }
    Ok(causes)
}

/// Returns gaps with another cause than that for which the reports were given up, and reports that were given up
/// without a reason. What a replaced store had given up is `former`: its ledger is gone with it.
pub(in crate::chaos) fn faults(
    announced: &Causes,
    [given_up, former]: [&Causes; 2],
    reasons: &Reasons<'_>,
) -> Vec<String> {
    let mut faults = Vec::new();
    for (key, causes) in announced {
        let Some(events) = given_up.get(key).or_else(|| former.get(key)) else {
            faults.push(format!("announced as given up, and was not: {key:?}"));
            continue;
        };
        let wrong = causes.iter().filter(|cause| !events.iter().any(|event| is_of(event, cause)));
        faults.extend(wrong.map(|cause| {
            format!("announced with the cause {cause}, and given up by {events:?}: {key:?}")
        }));
    }
    for (key, events) in given_up {
        let wrong = events.iter().filter(|event| !reasons.allow(key, event));
        faults.extend(wrong.map(|event| format!("given up by {event} without a reason: {key:?}")));
    }
    faults
}

fn is_of(event: &str, cause: &str) -> bool {
    match event {
        // The other cause, that a request has gone, is none: the requests stay.
        PURGED => cause == "REVOKED",
        other => other == cause,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{chaos::content::Content, frame_order::HAMBURG};

    const TOGGLED: &str = "toggled";
    const OTHER: &str = "other";
    /// Number of the report among all that were made.
    const REPORT: i64 = 40;

    fn causes(cause: &str) -> Causes {
        let mut causes = Causes::new();
        add(&mut causes, HAMBURG, [1, 1, 3, 3], cause);
        causes
    }

    /// Returns a report of a request, as it left.
    fn left(request: &str) -> BTreeMap<ReportKey, Left> {
        let content = Content { request: request.to_owned(), ..Content::default() };
        let report = Left { id: REPORT, state: "DONE".to_owned(), recipients: 1, content };
        let keys = causes("").into_keys();
        keys.map(|key| (key, report.clone())).collect()
    }

    fn interrupted(first: i64, last: i64) -> Interruptions {
        let mut interruptions = Interruptions::default();
        interruptions.begin(first);
        interruptions.end(last);
        interruptions
    }

    #[test]
    fn a_gap_has_the_cause_for_which_reports_were_given_up() {
        let (left, interruptions) = (left(TOGGLED), interrupted(REPORT, REPORT));
        let reasons =
            Reasons { left: &left, toggled: TOGGLED, interruptions: Some(&interruptions) };
        let none = Causes::new();
        let found = |cause: &str, event: &str| {
            faults(&causes(cause), [&causes(event), &none], &reasons).len()
        };
        assert_eq!(found("COALESCED", "COALESCED"), 0);
        assert_eq!(found("REVOKED", "PURGED"), 0);
        assert_eq!(found("WITHDRAWN", "PURGED"), 1, "nothing is withdrawn");
        assert_eq!(found("EXPIRED", "COALESCED"), 1);
        assert_eq!(found("COALESCED", "PURGED"), 1);
        assert_eq!(faults(&causes("COALESCED"), [&none, &none], &reasons).len(), 1);
        let former = causes("COALESCED");
        let of_former = |cause: &str| faults(&causes(cause), [&none, &former], &reasons).len();
        assert_eq!(of_former("COALESCED"), 0, "the replaced store had given it up");
        assert_eq!(of_former("REVOKED"), 1);
    }

    #[test]
    fn reports_are_given_up_for_a_reason_only() {
        let found = |request: &str, event: &str, interruptions: Option<&Interruptions>| {
            let left = left(request);
            let reasons = Reasons { left: &left, toggled: TOGGLED, interruptions };
            let none = Causes::new();
            faults(&none, [&causes(event), &none], &reasons).len()
        };
        let (in_time, before, after) =
            (interrupted(9, 40), interrupted(9, 39), interrupted(41, 50));
        assert_eq!(found(OTHER, "COALESCED", Some(&in_time)), 0, "its spool is small");
        assert_eq!(found(OTHER, "COALESCED", Some(&before)), 1, "everything could leave");
        assert_eq!(found(OTHER, "COALESCED", Some(&after)), 1, "it had left before");
        assert_eq!(found(OTHER, "COALESCED", None), 1, "its spool is large");
        assert_eq!(found(TOGGLED, "PURGED", None), 0, "a consent to its request ended");
        assert_eq!(found(OTHER, "PURGED", None), 1, "all consents to its request stay");
        assert_eq!(found(OTHER, "PURGED", Some(&in_time)), 1);
        assert_eq!(found(TOGGLED, "EXPIRED", Some(&in_time)), 1);
    }

    #[test]
    fn what_is_given_up_and_never_left_has_no_reason() {
        let left = BTreeMap::new();
        let reasons = Reasons { left: &left, toggled: TOGGLED, interruptions: None };
        let none = Causes::new();
        assert_eq!(faults(&none, [&causes("PURGED"), &none], &reasons).len(), 1);
    }
}
