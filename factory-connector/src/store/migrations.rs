//! Migrations of the tables, oldest first. They only go forward and never change after a release.

use sqlx::{
    SqlSafeStr as _, SqliteConnection,
    migrate::{Migration, MigrationType, Migrator},
};

use super::error::StoreError;

const MIGRATIONS: &[(i64, &str, &str)] = &[
    (1, "initial", include_str!("../../migrations/0001_initial.sql")),
    (10, "mapping versions", include_str!("../../migrations/0010_mapping_versions.sql")),
    (20, "policies", include_str!("../../migrations/0020_policies.sql")),
    (21, "previous revision", include_str!("../../migrations/0021_previous_revision.sql")),
    (30, "operator entries", include_str!("../../migrations/0030_operator_entries.sql")),
    (31, "revocations", include_str!("../../migrations/0031_revocations.sql")),
    (32, "ledger ends", include_str!("../../migrations/0032_ledger_ends.sql")),
    (33, "ledger lookup", include_str!("../../migrations/0033_ledger_lookup.sql")),
    (40, "places", include_str!("../../migrations/0040_places.sql")),
    (41, "recipient list", include_str!("../../migrations/0041_recipient_list.sql")),
    (42, "ledger logs", include_str!("../../migrations/0042_ledger_logs.sql")),
    (43, "caps", include_str!("../../migrations/0043_caps.sql")),
    (44, "ledger witness", include_str!("../../migrations/0044_ledger_witness.sql")),
    (45, "retention", include_str!("../../migrations/0045_retention.sql")),
    (46, "past decisions", include_str!("../../migrations/0046_past_decisions.sql")),
    (47, "former disclosures", include_str!("../../migrations/0047_former_disclosures.sql")),
    (55, "sealed passwords", include_str!("../../migrations/0055_sealed_passwords.sql")),
    (60, "second factors", include_str!("../../migrations/0060_second_factors.sql")),
    (61, "sealed second factors", include_str!("../../migrations/0061_sealed_second_factors.sql")),
    (62, "passkeys", include_str!("../../migrations/0062_passkeys.sql")),
    (63, "announced gaps", include_str!("../../migrations/0063_announced_gaps.sql")),
];

/// Brings the tables up to date.
///
/// # Errors
/// [`StoreError::Migrate`], also for a file of a newer version.
pub(super) async fn migrate(connection: &mut SqliteConnection) -> Result<(), StoreError> {
    let migrations = MIGRATIONS.iter().map(|&(version, name, sql)| {
        Migration::new(version, name.into(), MigrationType::Simple, sql.into_sql_str(), false)
    });
    Migrator::with_migrations(migrations.collect()).run(connection).await?;
    Ok(())
}
