//! Reports that a connector gave up, and what it announced of them.

use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};

use anyhow::Context as _;
use serde_json::Value;
use sqlx::Row as _;

use super::{ReportKey, connector_store, open, platform_store};
use crate::frame_order::HAMBURG;

/// Reports by why they were given up: an event of the ledger, or the cause of an announced gap.
pub(in crate::chaos) type Causes = BTreeMap<ReportKey, BTreeSet<String>>;

const COALESCED: &str = "COALESCED";

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
/// without a reason: no run is as long as reports are kept, and the spool of one factory alone is small.
pub(in crate::chaos) fn faults(
    factory: &str,
    announced: &Causes,
    given_up: &Causes,
) -> Vec<String> {
    let mut faults = Vec::new();
    for (key, causes) in announced {
        let Some(events) = given_up.get(key) else {
            faults.push(format!("announced as given up, and was not: {key:?}"));
            continue;
        };
        let wrong = causes.iter().filter(|cause| !events.iter().any(|event| is_of(event, cause)));
        faults.extend(wrong.map(|cause| {
            format!("announced with the cause {cause}, and given up by {events:?}: {key:?}")
        }));
    }
    for (key, events) in given_up {
        let has_reason = |event: &str| match event {
            COALESCED => factory == HAMBURG,
            "PURGED" => true,
            _ => false,
        };
        let wrong = events.iter().filter(|event| !has_reason(event));
        faults.extend(wrong.map(|event| format!("given up by {event} without a reason: {key:?}")));
    }
    faults
}

fn is_of(event: &str, cause: &str) -> bool {
    match event {
        "PURGED" => ["REVOKED", "WITHDRAWN"].contains(&cause),
        other => other == cause,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame_order::MUNICH;

    fn causes(factory: &str, cause: &str) -> Causes {
        let mut causes = Causes::new();
        add(&mut causes, factory, [1, 1, 3, 3], cause);
        causes
    }

    #[test]
    fn a_gap_has_the_cause_for_which_reports_were_given_up() {
        let found = |cause: &str, event: &str| {
            faults(HAMBURG, &causes(HAMBURG, cause), &causes(HAMBURG, event)).len()
        };
        assert_eq!(found("COALESCED", "COALESCED"), 0);
        assert_eq!(found("REVOKED", "PURGED"), 0);
        assert_eq!(found("WITHDRAWN", "PURGED"), 0);
        assert_eq!(found("EXPIRED", "COALESCED"), 1);
        assert_eq!(found("COALESCED", "PURGED"), 1);
        assert_eq!(faults(HAMBURG, &causes(HAMBURG, "COALESCED"), &Causes::new()).len(), 1);
    }

    #[test]
    fn reports_are_given_up_for_a_reason_only() {
        let found = |factory: &str, event: &str| {
            faults(factory, &Causes::new(), &causes(factory, event)).len()
        };
        assert_eq!(found(HAMBURG, "COALESCED"), 0, "its spool is small");
        assert_eq!(found(MUNICH, "COALESCED"), 1);
        assert_eq!(found(HAMBURG, "EXPIRED"), 1);
        assert_eq!(found(MUNICH, "PURGED"), 0);
    }
}
