//! The unit of work: all rows of one transaction.

use rusqlite::Connection;

use super::{
    DocumentKind, PolicyWrites, Writes, announced_gaps, carried_fields, comments, consents,
    control_messages, dead_letters, fields, former_disclosures, identity, ledger,
    mapping_templates, mapping_versions, networks, operator_entries, past_decisions,
    policy_documents, previews, received_messages, recipient_policies, reports, revocations,
    rule_decisions, shadow_mappings, sources, writers,
};

/// Writes the rows of every noun.
pub(super) fn write(connection: &Connection, writes: &Writes) -> rusqlite::Result<()> {
    networks::write(connection, &writes.networks)?;
    received_messages::write(connection, &writes.messages.seen)?;
    comments::write(connection, &writes.messages.comments)?;
    dead_letters::write(connection, &writes.messages.dead_letters)?;
    // Fields go before everything that refers to them by a foreign key.
    fields::write(connection, &writes.fields.decided, &writes.fields.removed)?;
    fields::write_values(connection, &writes.fields.values)?;
    consents::write(connection, &writes.fields.consents)?;
    previews::write(connection, &writes.fields.previews)?;
    let (former, forgotten) = (&writes.fields.former, &writes.fields.forgotten);
    former_disclosures::write(connection, former, forgotten)?;
    mapping_versions::write(connection, &writes.mappings.versions)?;
    shadow_mappings::write(connection, &writes.mappings.shadows)?;
    let (templates, removed) = (&writes.mappings.templates, &writes.mappings.removed_templates);
    mapping_templates::write(connection, templates, removed)?;
    write_policies(connection, &writes.policies)?;
    write_spool(connection, writes)?;
    write_ledger(connection, writes)?;
    sources::write(connection, &writes.sources.put, &writes.sources.removed)?;
    operator_entries::write(connection, &writes.operator_entries, &writes.networks)?;
    if writes.writers.are_epochs_begun {
        identity::end_restoration(connection)?;
    }
    if let Some(is_held) = writes.is_lease_held {
        identity::write_lease(connection, is_held)?;
    }
    Ok(())
}

fn write_policies(connection: &Connection, writes: &PolicyWrites) -> rusqlite::Result<()> {
    policy_documents::write(connection, DocumentKind::Policy, &writes.named)?;
    policy_documents::write(connection, DocumentKind::Rule, &writes.rules)?;
    policy_documents::write(connection, DocumentKind::Alliance, &writes.alliances)?;
    policy_documents::write(connection, DocumentKind::Cap, &writes.caps)?;
    recipient_policies::write(connection, &writes.recipients)?;
    rule_decisions::write(connection, &writes.rule_decisions, &writes.undone_rule_decisions)
}

fn write_spool(connection: &Connection, writes: &Writes) -> rusqlite::Result<()> {
    writers::write(connection, &writes.writers.changed)?;
    carried_fields::write(connection, &writes.writers.carried_fields)?;
    // New reports first: one of them may change its state in the same transaction.
    reports::write(connection, &writes.reports.queued)?;
    reports::apply_moves(connection, &writes.reports.moves)?;
    reports::empty_values(connection, &writes.reports.emptied)?;
    announced_gaps::write(connection, &writes.reports.gaps)?;
    control_messages::write(connection, &writes.controls.queued)?;
    control_messages::remove(connection, &writes.controls.done)?;
    control_messages::park(connection, &writes.controls.parked)?;
    control_messages::count_attempt(connection, &writes.controls.attempted)
}

fn write_ledger(connection: &Connection, writes: &Writes) -> rusqlite::Result<()> {
    ledger::write_entries(connection, &writes.ledger.entries)?;
    ledger::write_heads(connection, &writes.ledger.heads)?;
    ledger::write_logs(connection, &writes.ledger.logs)?;
    ledger::write_witnessed(connection, &writes.ledger.witnessed)?;
    revocations::write(connection, &writes.ledger.revocations)?;
    past_decisions::write(connection, &writes.ledger.past_decisions)?;
    ledger::write_checkpoint(connection, writes.ledger.checkpoint.as_ref())?;
    ledger::write_seal(connection, writes.ledger.seal.as_ref())?;
    // In the transaction of the entries that state it: without them it counts as tampering.
    ledger::remove_entries(connection, &writes.ledger.removed)?;
    if writes.ledger.is_former_retention_stated {
        identity::end_former_retention(connection)?;
    }
    Ok(())
}
