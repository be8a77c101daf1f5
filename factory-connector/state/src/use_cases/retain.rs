//! Retention: old values are emptied and old entries removed. The chains say so in the same
//! transaction; what is missing without such an entry counts as tampering.

use std::collections::BTreeMap;

use asi_model::{DateTime, OrganisationId};
use ledger::{Anchor, Event, Hash, LedgerKey, RetentionRule, RetentionStatement, SequenceRange};

use crate::{
    ChangeSet, ConnectorState, FormerRetention,
    ledger_chains::single,
    writes::{AnchorRow, RemovedEntries},
};

/// Limit of retention: only what is older than so many days is affected.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RetentionLimit {
    pub days: u32,
    /// The time that many days ago.
    pub before: DateTime,
}

/// A report that is old enough to be emptied.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OldReport {
    /// Number of the report.
    pub id: i64,
    /// Number of the message in which it was sent.
    pub message: i64,
    pub data_set_writer_id: u16,
    pub epoch: u32,
    pub sequence: u32,
    /// Organisations whose chains have an entry about it.
    pub recipients: Vec<OrganisationId>,
}

/// The oldest entries of a chain that are old enough to be removed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OldEntries {
    /// Organisation of the chain.
    pub recipient: OrganisationId,
    /// Number, hash and time of the last of them.
    pub last: (u64, Hash, DateTime),
    /// Hashes of the log's leaves up to that entry, as an anchor states them.
    pub leaves: Vec<Hash>,
    /// Numbers of the reports that they are about.
    pub reports: Vec<i64>,
}

/// Empties the values of reports, and states in the chains of their recipients which.
pub fn empty_values(
    state: &mut ConnectorState,
    reports: &[OldReport],
    limit: RetentionLimit,
    now: DateTime,
) -> ChangeSet {
    let mut changes = ChangeSet::default();
    let mut of_chains: BTreeMap<&OrganisationId, Vec<SequenceRange>> = BTreeMap::new();
    for report in reports {
        let range = single(report.data_set_writer_id, report.epoch, report.sequence);
        for recipient in &report.recipients {
            of_chains.entry(recipient).or_default().push(range);
        }
        changes.writes.reports.emptied.push(report.id);
    }
    let RetentionLimit { days, before } = limit;
    for (recipient, ranges) in of_chains {
        let rule = RetentionRule::ValueDays;
        let ranges = joined(ranges);
        for statement in RetentionStatement::of_values(rule, Some(days), before, &ranges) {
            append(state, &mut changes, recipient, now, statement);
        }
    }
    changes
}

/// Removes the oldest entries of chains: signed anchors stand for them, and an entry of each chain
/// says so.
pub fn remove_entries(
    state: &mut ConnectorState,
    chains: Vec<OldEntries>,
    limit: RetentionLimit,
    key: &LedgerKey,
    now: DateTime,
) -> ChangeSet {
    let mut changes = ChangeSet::default();
    for OldEntries { recipient, last: (number, hash, last_entry_at), leaves, reports } in chains {
        let statement = RetentionStatement {
            rule: RetentionRule::EntryDays,
            days: Some(limit.days),
            before: limit.before,
            emptied: Vec::new(),
            removed_through: Some(number),
        };
        append(state, &mut changes, &recipient, now, statement);
        // As it is stored beside the text, which has microseconds only.
        let recorded_at = DateTime::from_unix_micros(now.unix_micros());
        let content = Anchor {
            factory_id: state.config.factory_id.clone(),
            recipient: recipient.clone(),
            number,
            hash: hex::encode(hash),
            leaves: leaves.iter().map(hex::encode).collect(),
            last_entry_at,
            recorded_at,
        }
        .canonical();
        let (signature, public_key) = (key.sign(&content), key.public());
        let anchor = AnchorRow { recipient, number, recorded_at, content, signature, public_key };
        changes.writes.ledger.removed.push(RemovedEntries { anchor, reports });
    }
    changes
}

/// States in every chain what was found emptied and removed: nobody can say any more when that was
/// and by which rule. From here on everything is stated as it happens.
pub fn state_former(
    state: &mut ConnectorState,
    former: FormerRetention,
    now: DateTime,
) -> ChangeSet {
    let mut changes = ChangeSet::default();
    changes.writes.ledger.is_former_retention_stated = true;
    let FormerRetention { emptied, removed } = former;
    let chains: Vec<OrganisationId> =
        state.ledger.heads().iter().map(|(recipient, _)| recipient.clone()).collect();
    for recipient in chains {
        let of_chain = emptied.iter().filter(|(_, recipients)| recipients.contains(&recipient));
        let ranges = joined(of_chain.map(|(range, _)| *range).collect());
        let rule = RetentionRule::FormerVersion;
        let mut statements = RetentionStatement::of_values(rule, None, now, &ranges);
        let removed_through = removed.get(&recipient).copied();
        match statements.first_mut() {
            Some(first) => first.removed_through = removed_through,
            // A chain of which nothing is missing says so, too: it cannot be said later.
            None => statements.push(RetentionStatement {
                rule,
                days: None,
                before: now,
                emptied: Vec::new(),
                removed_through,
            }),
        }
        for statement in statements {
            append(state, &mut changes, &recipient, now, statement);
        }
    }
    changes
}

fn append(
    state: &mut ConnectorState,
    changes: &mut ChangeSet,
    recipient: &OrganisationId,
    now: DateTime,
    statement: RetentionStatement,
) {
    let event = Event::Retention(statement);
    state.ledger.append_one(&mut changes.writes.ledger, recipient, now, &event);
}

/// Joins neighbouring ranges of the same writer and epoch.
fn joined(mut ranges: Vec<SequenceRange>) -> Vec<SequenceRange> {
    ranges.sort_unstable_by_key(|range| {
        (range.data_set_writer_id, range.epoch, range.first_sequence)
    });
    let mut joined: Vec<SequenceRange> = Vec::new();
    for range in ranges {
        match joined.last_mut() {
            Some(last)
                if last.data_set_writer_id == range.data_set_writer_id
                    && last.epoch == range.epoch
                    && last.last_sequence.saturating_add(1) >= range.first_sequence =>
            {
                last.last_sequence = last.last_sequence.max(range.last_sequence);
            }
            _ => joined.push(range),
        }
    }
    joined
}
