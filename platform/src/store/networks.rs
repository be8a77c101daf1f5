//! Operation networks and their revisions.

use std::collections::BTreeSet;

use asi_model::{
    CollaborationId, DateTime, OperationNetworkId, OrganisationId, network::OperationNetwork,
};
use serde::Serialize;
use utoipa::ToSchema;

use super::{
    database::Connection,
    error::StoreError,
    ownership::Ownership,
    row::{Columns, DatabaseRow, document, signed},
    scope::Scope,
    visibility::{NetworkOwners, Visibility},
};

/// Condition on a network `n`: the organisation `$1` sees anything of it, or nothing is required.
macro_rules! readable {
    () => {
        "(CAST($1 AS TEXT) IS NULL OR EXISTS (SELECT 1 FROM network_reader r
          WHERE r.operation_network_id = n.operation_network_id AND r.organisation_id = $1))"
    };
}

/// Condition on a part `p`: the organisation `$1` may know its state, or nothing is required.
macro_rules! part_readable {
    () => {
        "(CAST($1 AS TEXT) IS NULL OR EXISTS (SELECT 1 FROM network_part_reader r
          WHERE r.operation_network_id = p.operation_network_id AND r.factory_id = p.factory_id
          AND r.organisation_id = $1))"
    };
}

/// Join with the last revision `s` of a network `n` that changed what the organisation `$1` sees.
macro_rules! seen_revision {
    () => {
        "LEFT JOIN seen_revision s ON s.operation_network_id = n.operation_network_id
             AND s.organisation_id = $1"
    };
}

/// A column of the last revision that the viewer saw change, else of the newest one.
macro_rules! seen {
    ($column:literal) => {
        concat!("COALESCE(s.", $column, ", n.", $column, ") AS ", $column, ", ")
    };
}

/// The newest revision of a network.
#[derive(Debug, Clone, PartialEq)]
pub struct NetworkRow {
    /// The collaboration it belongs to.
    pub collaboration_id: CollaborationId,
    /// Counts up with every change, withdrawal included. An organisation is shown the last one that
    /// changed what it sees, with time and author.
    pub revision: u64,
    /// The network as the scope of the query shows it, each operation with its owner.
    pub network: OperationNetwork,
    /// Time of the revision.
    pub updated_at: DateTime,
    /// The user or tool that made it.
    pub updated_by: String,
    /// The organisation of that user or tool; none for an administrator without one.
    pub author_organisation: Option<OrganisationId>,
    /// Time of the withdrawal; absent while in effect.
    pub withdrawn_at: Option<DateTime>,
    /// The organisation that drew it; none where only administrators own it.
    pub drawn_by: Option<OrganisationId>,
}

/// A network in a list.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct NetworkSummary {
    pub operation_network_id: OperationNetworkId,
    /// The collaboration it belongs to.
    pub collaboration_id: CollaborationId,
    /// Name for people.
    pub name: Option<String>,
    /// The last revision that changed what the viewer sees of it.
    pub revision: u64,
    /// Time of that revision.
    pub updated_at: DateTime,
    /// Time of the withdrawal; absent while in effect.
    pub withdrawn_at: Option<DateTime>,
    /// Arrival of the last report about it that the viewer may see.
    pub last_report_at: Option<DateTime>,
    /// Number of parts that the viewer may know of and that wait for a factory's acknowledgement.
    pub parts_unanswered: u64,
    /// Number of rejected parts that the viewer may know of.
    pub parts_rejected: u64,
}

/// Most revisions of a network that are kept, the one in force included; a revision may have 4 MiB.
const REVISIONS_PER_NETWORK_MAX: u32 = 100;
/// Most bytes of these.
const REVISION_BYTES_PER_NETWORK_MAX: u32 = 16 * 1024 * 1024;

/// Repository of operation networks.
pub struct Networks<'w>(pub(super) &'w mut Connection);

impl Networks<'_> {
    /// Stores a revision as the newest. A network stays with the organisation that drew it first.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn put(&mut self, row: &NetworkRow) -> Result<(), StoreError> {
        let sql = "INSERT INTO operation_network (operation_network_id, collaboration_id, name, revision, document,
                       updated_at, updated_by, withdrawn_at, drawn_by, author_organisation)
                   VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10)
                   ON CONFLICT (operation_network_id) DO UPDATE SET name = excluded.name,
                       revision = excluded.revision, document = excluded.document, updated_at = excluded.updated_at,
                       updated_by = excluded.updated_by, withdrawn_at = excluded.withdrawn_at,
                       author_organisation = excluded.author_organisation";
        let text = document(&row.network);
        sqlx::query(sql)
            .bind(row.network.operation_network_id.as_str())
            .bind(row.collaboration_id.as_str())
            .bind(row.network.name.as_deref())
            .bind(signed(row.revision))
            .bind(&text)
            .bind(row.updated_at.ticks())
            .bind(&row.updated_by)
            .bind(row.withdrawn_at.map(DateTime::ticks))
            .bind(row.drawn_by.as_ref().map(OrganisationId::as_str))
            .bind(row.author_organisation.as_ref().map(OrganisationId::as_str))
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("store a network"))?;
        let sql = "INSERT INTO operation_network_revision (operation_network_id, revision, document, created_at,
                       created_by) VALUES ($1, $2, $3, $4, $5)";
        sqlx::query(sql)
            .bind(row.network.operation_network_id.as_str())
            .bind(signed(row.revision))
            .bind(&text)
            .bind(row.updated_at.ticks())
            .bind(&row.updated_by)
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("store a revision"))?;
        self.forget_oldest_revisions(&row.network.operation_network_id).await
    }

    /// Forgets the oldest revisions of a network beyond the bounds; the one in force stays.
    async fn forget_oldest_revisions(&mut self, id: &OperationNetworkId) -> Result<(), StoreError> {
        let sql = "DELETE FROM operation_network_revision WHERE operation_network_id = $1 AND revision <= (
                       SELECT MAX(revision) FROM (
                           SELECT revision, ROW_NUMBER() OVER newest AS position,
                               SUM(octet_length(document)) OVER newest AS total
                           FROM operation_network_revision WHERE operation_network_id = $1
                           WINDOW newest AS (ORDER BY revision DESC)) AS counted
                       WHERE position > $2 OR (position > 1 AND total > $3))";
        sqlx::query(sql)
            .bind(id.as_str())
            .bind(i64::from(REVISIONS_PER_NETWORK_MAX))
            .bind(i64::from(REVISION_BYTES_PER_NETWORK_MAX))
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("forget the oldest revisions"))?;
        Ok(())
    }

    /// Returns the numbers of the revisions of a network that are kept.
    #[cfg(test)]
    async fn stored_revisions(&mut self, id: &OperationNetworkId) -> Vec<i64> {
        let sql = "SELECT revision FROM operation_network_revision WHERE operation_network_id = $1
                   ORDER BY revision";
        let rows = sqlx::query_scalar(sql).bind(id.as_str()).fetch_all(&mut *self.0).await;
        rows.expect("read")
    }

    /// Notes a revision as the last one that changed what these organisations see of the network.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn note_seen(
        &mut self,
        row: &NetworkRow,
        organisations: &BTreeSet<OrganisationId>,
    ) -> Result<(), StoreError> {
        for organisation in organisations {
            let sql = "INSERT INTO seen_revision (operation_network_id, organisation_id, revision, updated_at,
                           updated_by, author_organisation) VALUES ($1, $2, $3, $4, $5, $6)
                       ON CONFLICT (operation_network_id, organisation_id) DO UPDATE SET
                           revision = excluded.revision, updated_at = excluded.updated_at,
                           updated_by = excluded.updated_by, author_organisation = excluded.author_organisation";
            sqlx::query(sql)
                .bind(row.network.operation_network_id.as_str())
                .bind(organisation.as_str())
                .bind(signed(row.revision))
                .bind(row.updated_at.ticks())
                .bind(&row.updated_by)
                .bind(row.author_organisation.as_ref().map(OrganisationId::as_str))
                .execute(&mut *self.0)
                .await
                .map_err(StoreError::during("note who sees a revision"))?;
        }
        Ok(())
    }

    /// Looks one up of which the viewer sees anything, and shows the part that the viewer sees.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn lookup(
        &mut self,
        scope: &Scope,
        id: &OperationNetworkId,
    ) -> Result<Option<NetworkRow>, StoreError> {
        let sql = concat!(
            "SELECT n.operation_network_id, n.collaboration_id, n.document, n.withdrawn_at, n.drawn_by, ",
            seen!("revision"),
            seen!("updated_at"),
            seen!("updated_by"),
            "CASE WHEN s.revision IS NULL THEN n.author_organisation ELSE s.author_organisation END
                 AS author_organisation FROM operation_network n ",
            seen_revision!(),
            " WHERE n.operation_network_id = $2 AND ",
            readable!()
        );
        let row = sqlx::query(sql)
            .bind(scope.member())
            .bind(id.as_str())
            .fetch_optional(&mut *self.0)
            .await
            .map_err(StoreError::during("look a network up"))?;
        let Some(mut row) = row.as_ref().map(read).transpose()? else { return Ok(None) };
        if let Scope::Organisation(_) = scope {
            let owners = self.owners(&row).await?;
            row.network = Visibility::new(&row.network, &owners, scope).project();
        }
        Ok(Some(row))
    }

    /// Returns the owners of a network and of what is in it.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn owners(&mut self, row: &NetworkRow) -> Result<NetworkOwners, StoreError> {
        let id = &row.network.operation_network_id;
        Ownership(&mut *self.0).of_network(id, &row.collaboration_id, row.drawn_by.as_ref()).await
    }

    /// Returns a page of the networks of which the viewer sees anything, by id, after `after`.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn list(
        &mut self,
        scope: &Scope,
        after: &str,
        limit: u32,
    ) -> Result<Vec<NetworkSummary>, StoreError> {
        let sql = concat!(
            "SELECT n.operation_network_id, n.collaboration_id, n.name, n.withdrawn_at, ",
            seen!("revision"),
            seen!("updated_at"),
            "(SELECT MAX(v.received_at) FROM field_value v
                        JOIN request_field f ON f.operation_network_id = v.operation_network_id
                          AND f.dynamic_data_request_id = v.dynamic_data_request_id AND f.field_name = v.field_name
                        WHERE v.operation_network_id = n.operation_network_id AND f.mapping_state = 'MAPPED'
                          AND (CAST($2 AS TEXT) IS NULL OR EXISTS (SELECT 1 FROM request_recipient r
                               JOIN recipient_set_member m ON m.organisation_id = r.organisation_id
                               WHERE r.operation_network_id = v.operation_network_id
                                 AND r.dynamic_data_request_id = v.dynamic_data_request_id
                                 AND m.recipient_set_id = v.recipient_set_id
                                 AND r.organisation_id = $2))) AS last_report_at,
                       (SELECT COUNT(*) FROM network_part p WHERE p.operation_network_id = n.operation_network_id
                          AND p.state = 'SENT' AND ",
            part_readable!(),
            ") AS parts_unanswered,
                       (SELECT COUNT(*) FROM network_part p WHERE p.operation_network_id = n.operation_network_id
                          AND p.state = 'REJECTED' AND ",
            part_readable!(),
            ") AS parts_rejected FROM operation_network n ",
            seen_revision!(),
            " WHERE n.operation_network_id > $3 AND ",
            readable!(),
            " ORDER BY n.operation_network_id LIMIT $4"
        );
        let rows = sqlx::query(sql)
            .bind(scope.member())
            .bind(scope.recipient())
            .bind(after)
            .bind(i64::from(limit))
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during("list networks"))?;
        rows.iter()
            .map(|row| {
                Ok(NetworkSummary {
                    operation_network_id: row.parsed("operation_network_id")?,
                    collaboration_id: row.parsed("collaboration_id")?,
                    name: row.column("name")?,
                    revision: row.unsigned("revision")?,
                    updated_at: row.time("updated_at")?,
                    withdrawn_at: row.time_option("withdrawn_at")?,
                    last_report_at: row.time_option("last_report_at")?,
                    parts_unanswered: row.unsigned("parts_unanswered")?,
                    parts_rejected: row.unsigned("parts_rejected")?,
                })
            })
            .collect()
    }
}

fn read(row: &DatabaseRow) -> Result<NetworkRow, StoreError> {
    Ok(NetworkRow {
        collaboration_id: row.parsed("collaboration_id")?,
        revision: row.unsigned("revision")?,
        network: row.json("document")?,
        updated_at: row.time("updated_at")?,
        updated_by: row.column("updated_by")?,
        author_organisation: row.parsed_option("author_organisation")?,
        withdrawn_at: row.time_option("withdrawn_at")?,
        drawn_by: row.parsed_option("drawn_by")?,
    })
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::store::{Collaboration, Store};

    fn revision(name: &str, revision: u64, description: &str) -> NetworkRow {
        let operation =
            json!({ "operationId": "op", "operationType": "PRODUCTION", "owningFactoryId": "F" });
        let document = json!({ "operationNetworkId": name, "name": description,
            "operationList": [operation] });
        NetworkRow {
            collaboration_id: "c".parse().expect("valid"),
            revision,
            network: serde_json::from_value(document).expect("valid"),
            updated_at: DateTime::from_ticks(1),
            updated_by: "u".to_owned(),
            author_organisation: None,
            withdrawn_at: None,
            drawn_by: None,
        }
    }

    #[tokio::test]
    async fn a_network_keeps_a_bounded_number_of_revisions_and_bytes() {
        let folder = tempfile::tempdir().expect("a folder");
        let store = Store::open(&folder.path().join("store.sqlite")).await.expect("it opens");
        let mut work = store.begin().await.expect("begun");
        let collaboration = Collaboration {
            collaboration_id: "c".parse().expect("valid"),
            name: "c".to_owned(),
            created_at: DateTime::from_ticks(0),
            members: Vec::new(),
            factories: Vec::new(),
        };
        work.collaborations().add(&collaboration).await.expect("stored");
        let mut networks = work.networks();
        networks.put(&revision("other", 1, "of others")).await.expect("stored");
        let newest = u64::from(REVISIONS_PER_NETWORK_MAX) + 20;
        for number in 1..=newest {
            networks.put(&revision("net", number, "short")).await.expect("stored");
        }
        let id = |name: &str| name.parse().expect("valid");
        let kept = networks.stored_revisions(&id("net")).await;
        assert_eq!((kept.first(), kept.len()), (Some(&21), REVISIONS_PER_NETWORK_MAX as usize));
        let half = "x".repeat(REVISION_BYTES_PER_NETWORK_MAX as usize / 2 - 1_000);
        for number in 1..=3 {
            networks.put(&revision("net", newest + number, &half)).await.expect("stored");
        }
        let kept = networks.stored_revisions(&id("net")).await;
        assert_eq!(kept, [122, 123], "the newest ones that fit");
        assert_eq!(networks.stored_revisions(&id("other")).await, [1], "others lose nothing");
    }
}
