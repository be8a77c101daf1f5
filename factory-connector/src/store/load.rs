//! Snapshot of the store, read at a start and after a failed transaction.

use super::{
    Snapshot, StoredBudgets, StoredLedger, StoredMappings, StoredPolicies, error::StoreError,
    session::StoreSession,
};

/// Reads everything that the connector has in memory.
pub(super) async fn load(session: &mut StoreSession) -> Result<Snapshot, StoreError> {
    let heads = session.ledger().heads().await?;
    Ok(Snapshot {
        networks: session.networks().all().await?,
        fields: session.fields().all().await?,
        writers: session.writers().all().await?,
        ledger: StoredLedger {
            logs: session.ledger().logs(&heads).await?,
            heads,
            last_checkpoint: session.checkpoints().last().await?,
            former_retention: session.ledger().former_retention().await?,
            past_decisions: session.past_decisions().newest().await?,
        },
        last_row: session.spool().last_id().await?,
        last_field: 0,
        operator_entries: session.operator_entries().all().await?,
        mappings: StoredMappings {
            newest_versions: session.mapping_versions().newest().await?,
            shadows: session.shadow_mappings().all().await?,
        },
        policies: StoredPolicies {
            named: session.policy_documents().newest_policies().await?,
            rules: session.policy_documents().newest_rules().await?,
            recipients: session.recipient_policies().newest().await?,
            last_rule_decision: session.rule_decisions().last_id().await?,
        },
        budgets: StoredBudgets {
            alliances: session.policy_documents().newest_alliances().await?,
            caps: session.policy_documents().newest_caps().await?,
        },
        former_disclosures: session.former_disclosures().all().await?,
    })
}
