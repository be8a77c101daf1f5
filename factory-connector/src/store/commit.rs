//! The unit of work: all rows of one transaction.

use rusqlite::Connection;

use super::{
    Changes, carried_fields, comments, consents, control_messages, dead_letters, fields, identity,
    ledger, mapping_templates, mapping_versions, networks, operator_entries, policy_documents,
    received_messages, recipient_policies, reports, revocations, rule_decisions, shadow_mappings,
    sources, writers,
};

/// Writes the rows of every noun.
pub(super) fn write(connection: &Connection, changes: &Changes) -> rusqlite::Result<()> {
    networks::write(connection, &changes.networks)?;
    received_messages::write(connection, &changes.seen)?;
    comments::write(connection, &changes.comments)?;
    dead_letters::write(connection, &changes.dead_letters)?;
    // Fields go before everything that refers to them by a foreign key.
    fields::write(connection, &changes.fields, &changes.removed_fields)?;
    fields::write_values(connection, &changes.field_values)?;
    consents::write(connection, &changes.consents)?;
    mapping_versions::write(connection, &changes.mappings.versions)?;
    shadow_mappings::write(connection, &changes.mappings.shadows)?;
    let (templates, removed) = (&changes.mappings.templates, &changes.mappings.removed_templates);
    mapping_templates::write(connection, templates, removed)?;
    policy_documents::write_policies(connection, &changes.policies)?;
    policy_documents::write_rules(connection, &changes.rules)?;
    recipient_policies::write(connection, &changes.recipient_policies)?;
    rule_decisions::write(connection, &changes.rule_decisions, &changes.undone_rule_decisions)?;
    write_spool(connection, changes)?;
    write_ledger(connection, changes)?;
    sources::write(connection, &changes.sources, &changes.removed_sources)?;
    operator_entries::write(connection, &changes.operator_entries, &changes.networks)?;
    if changes.are_epochs_begun {
        identity::end_restoration(connection)?;
    }
    if let Some(is_held) = changes.is_lease_held {
        identity::write_lease(connection, is_held)?;
    }
    Ok(())
}

fn write_spool(connection: &Connection, changes: &Changes) -> rusqlite::Result<()> {
    writers::write(connection, &changes.writers)?;
    carried_fields::write(connection, &changes.carried_fields)?;
    // New reports first: one of them may change its state in the same transaction.
    reports::write(connection, &changes.reports)?;
    reports::apply_moves(connection, &changes.report_moves)?;
    control_messages::write(connection, &changes.controls)?;
    control_messages::remove(connection, &changes.controls_done)?;
    control_messages::park(connection, &changes.controls_parked)?;
    control_messages::count_attempt(connection, &changes.controls_attempted)
}

fn write_ledger(connection: &Connection, changes: &Changes) -> rusqlite::Result<()> {
    ledger::write_entries(connection, &changes.ledger)?;
    ledger::write_heads(connection, &changes.heads)?;
    revocations::write(connection, &changes.revocations)?;
    ledger::write_checkpoint(connection, changes.checkpoint.as_ref())
}
