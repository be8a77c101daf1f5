//! Selections of entries by subject, compared with a read of all entries.

use std::collections::BTreeSet;

use ::ledger::EventKind;

use super::*;
use crate::store::{LedgerCursor, LedgerFilter, LedgerSubject};

/// Two requests, filled, sent, partly receipted; one revoked and opened again, which begins an
/// epoch.
async fn long_ledger() -> Running {
    let running = Running::with_two_open_fields().await;
    for number in 1..=3 {
        running.enter_both(number).await;
    }
    let rows = running.fetch(Lane::Reports).await;
    running.accept(&rows).await;
    running.receipt(&reports(&rows[0])[0], 1).await;
    running.revoke(None).await;
    running.open_fields().await;
    for number in 4..=6 {
        running.enter_both(number).await;
    }
    let rows = running.fetch(Lane::Reports).await;
    running.accept(&rows).await;
    running
}

/// Returns the fields that an entry is about, derived from all entries.
fn fields_of(entry: &Value, all: &[Value]) -> BTreeSet<String> {
    if let Some(name) = entry["field"]["fieldName"].as_str() {
        return [name.to_owned()].into();
    }
    let is_of = |queued: &&Value| {
        let is_same = |member: &str| queued[member] == entry[member];
        let sequence = queued["firstSequence"].as_u64();
        let is_within = entry["event"] == "REVOKED"
            || (entry["firstSequence"].as_u64() <= sequence
                && sequence <= entry["lastSequence"].as_u64());
        queued["event"] == "QUEUED" && is_same("dataSetWriterId") && is_same("epoch") && is_within
    };
    let consents = all.iter().filter(is_of).filter_map(|queued| queued["consents"].as_object());
    consents.flat_map(|consents| consents.keys().cloned()).collect()
}

#[tokio::test]
async fn lookups_find_the_entries_that_a_full_read_finds() {
    let running = long_ledger().await;
    let all = running.entries("hull").await;
    for kind in ["CONSENT", "QUEUED", "SENT", "RECEIPTED", "REVOKED"] {
        assert!(all.iter().any(|entry| entry["event"] == kind), "there is a {kind}");
    }
    let mut session = running.session().await;
    let kinds =
        EventKind::OF_REPORTS.into_iter().chain([EventKind::Consent]).map(Some).chain([None]);
    for kind in kinds {
        for name in [None, Some("made"), Some("note"), Some("unheard")] {
            let subject = name.map(|name| LedgerSubject {
                operation_network_id: "n".parse().expect("an id"),
                operation_id: Some("op".parse().expect("an id")),
                dynamic_data_request_id: Some(request_of(name).parse().expect("an id")),
                field_name: name.parse().ok(),
            });
            let is_meant = |entry: &&Value| {
                kind.is_none_or(|kind| entry["event"] == kind.name())
                    && name.is_none_or(|name| fields_of(entry, &all).contains(name))
            };
            let expected: Vec<u64> =
                all.iter().filter(is_meant).filter_map(|entry| entry["number"].as_u64()).collect();
            let filter = LedgerFilter {
                kind,
                subject,
                recipient: "hull".parse().ok(),
                ..LedgerFilter::default()
            };
            let mut cursor = LedgerCursor::new(filter.clone());
            let forwards = session.ledger().next(&mut cursor).await.expect("read");
            let forwards: Vec<u64> = forwards.iter().map(|row| row.number).collect();
            assert_eq!(forwards, expected, "{kind:?} of {name:?}");
            let (mut backwards, mut before) = (Vec::new(), None);
            loop {
                let page = session.ledger().page("hull", &filter, before, 2).await.expect("read");
                before = page.last().map(|row| row.number);
                if before.is_none() {
                    break;
                }
                backwards.extend(page.iter().map(|row| row.number));
            }
            backwards.reverse();
            assert_eq!(backwards, expected, "{kind:?} of {name:?}, two at a time");
        }
    }
}

#[tokio::test]
async fn fields_are_found_by_words() {
    let running = long_ledger().await;
    let check = async |words: &[&str], expected: &[&str]| {
        let words: Vec<String> = words.iter().map(|word| (*word).to_owned()).collect();
        let found = running.session().await.ledger().fields(&words, 10).await.expect("read");
        let names: Vec<&str> = found.iter().map(|key| key.field_name.as_str()).collect();
        assert_eq!(names, expected, "{words:?}");
    };
    check(&[], &["made", "note"]).await;
    check(&["OP", "r2"], &["note"]).await;
    check(&["made", "R2"], &[]).await;
}
