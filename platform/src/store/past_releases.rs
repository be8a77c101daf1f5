//! Releases of the past: reports that a factory showed to one more recipient after they had left.

use std::collections::BTreeSet;

use asi_model::{
    DynamicDataRequestId, FactoryId, OperationId, OperationNetworkId, OrganisationId,
    messages::{PastRelease, ReportRange},
};

use super::{
    database::{Connection, Database},
    error::StoreError,
    recipient_sets::{RecipientSetId, RecipientSets, add_released},
    row::{Columns, signed},
};

/// A range of reports that a factory released to a recipient afterwards.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ReleasedRange {
    pub factory_id: FactoryId,
    pub operation_id: OperationId,
    /// The recipient that may read them, too.
    pub organisation_id: OrganisationId,
    pub range: ReportRange,
}

impl ReleasedRange {
    /// Returns true for a report in this range.
    #[must_use]
    pub fn contains(&self, writer: u16, epoch: u32, sequence: u32) -> bool {
        let ReportRange { data_set_writer_id, epoch: of_range, first_sequence, last_sequence } =
            self.range;
        (data_set_writer_id, of_range) == (writer, epoch)
            && (first_sequence..=last_sequence).contains(&sequence)
    }
}

/// Condition on a row `p` of `report`: it is in the range `$2` to `$5` of the factory `$1`, and
/// answers the request `$6`, `$7`, `$8`.
macro_rules! in_range {
    () => {
        "p.factory_id = $1 AND p.data_set_writer_id = $2 AND p.epoch = $3
             AND p.sequence BETWEEN $4 AND $5
             AND p.operation_network_id = $6 AND p.operation_id = $7 AND p.dynamic_data_request_id = $8"
    };
}

/// The set of recipients of a row `p` of `report`, those of before the column was there included.
macro_rules! present_set {
    () => {
        "COALESCE(p.recipient_set_id, (SELECT r.recipient_set_id FROM former_report_recipients r
             WHERE r.operation_network_id = p.operation_network_id
             AND r.dynamic_data_request_id = p.dynamic_data_request_id
             AND r.factory_id = p.factory_id AND p.report_id <= r.last_report_id))"
    };
}

/// Repository of releases of the past.
pub struct PastReleases<'w>(pub(super) &'w mut Connection);

impl PastReleases<'_> {
    /// Stores the ranges of a release; those that are stored already stay.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn add(&mut self, release: &PastRelease) -> Result<(), StoreError> {
        for range in &release.range_list {
            let sql = "INSERT INTO past_release (operation_network_id, operation_id, dynamic_data_request_id,
                           factory_id, organisation_id, data_set_writer_id, epoch, first_sequence,
                           last_sequence, decided_at)
                       VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10) ON CONFLICT DO NOTHING";
            sqlx::query(sql)
                .bind(release.operation_network_id.as_str())
                .bind(release.operation_id.as_str())
                .bind(release.dynamic_data_request_id.as_str())
                .bind(release.factory_id.as_str())
                .bind(release.recipient_id.as_str())
                .bind(i64::from(range.data_set_writer_id))
                .bind(i64::from(range.epoch))
                .bind(i64::from(range.first_sequence))
                .bind(i64::from(range.last_sequence))
                .bind(release.decided_at.ticks())
                .execute(&mut *self.0)
                .await
                .map_err(StoreError::during("store a release of the past"))?;
        }
        Ok(())
    }

    /// Lists the ranges that were released of a request, of all factories that were asked.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn of_request(
        &mut self,
        network: &OperationNetworkId,
        request: &DynamicDataRequestId,
    ) -> Result<Vec<ReleasedRange>, StoreError> {
        let sql = "SELECT * FROM past_release
                   WHERE operation_network_id = $1 AND dynamic_data_request_id = $2";
        let rows = sqlx::query(sql)
            .bind(network.as_str())
            .bind(request.as_str())
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during("list releases of the past"))?;
        rows.iter()
            .map(|row| {
                Ok(ReleasedRange {
                    factory_id: row.parsed("factory_id")?,
                    operation_id: row.parsed("operation_id")?,
                    organisation_id: row.parsed("organisation_id")?,
                    range: ReportRange {
                        data_set_writer_id: row.unsigned("data_set_writer_id")?,
                        epoch: row.unsigned("epoch")?,
                        first_sequence: row.unsigned("first_sequence")?,
                        last_sequence: row.unsigned("last_sequence")?,
                    },
                })
            })
            .collect()
    }

    /// Returns true where anything of a writer was received: a report, or its metadata.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn is_known_writer(
        &mut self,
        factory: &FactoryId,
        writer: u16,
    ) -> Result<bool, StoreError> {
        let sql = "SELECT 1 FROM data_set_writer WHERE factory_id = $1 AND data_set_writer_id = $2
                   UNION ALL
                   SELECT 1 FROM writer_meta_data WHERE factory_id = $1 AND data_set_writer_id = $2";
        let found = sqlx::query(sql)
            .bind(factory.as_str())
            .bind(i64::from(writer))
            .fetch_optional(&mut *self.0)
            .await
            .map_err(StoreError::during("look a writer up"))?;
        Ok(found.is_some())
    }

    /// Adds the recipient to those who may read the stored reports of a release, and the current
    /// values that came in them. Nobody loses anything, and other reports stay as they are.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn widen(&mut self, release: &PastRelease) -> Result<(), StoreError> {
        for range in &release.range_list {
            for set in self.present_sets(release, range).await? {
                let members = self.members_with(set, &release.recipient_id).await?;
                let Some(wider) = RecipientSets(&mut *self.0).intern(&members).await? else {
                    continue;
                };
                if set == Some(wider) {
                    continue;
                }
                // The values first: they are found by the reports as they still are.
                self.widen_values(release, range, set, wider).await?;
                self.widen_reports(release, range, set, wider).await?;
            }
        }
        Ok(())
    }

    /// Lists the sets of recipients of the stored reports of a range, each once.
    async fn present_sets(
        &mut self,
        release: &PastRelease,
        range: &ReportRange,
    ) -> Result<Vec<Option<RecipientSetId>>, StoreError> {
        let sql = concat!(
            "SELECT DISTINCT ",
            present_set!(),
            " AS recipient_set_id FROM report p WHERE ",
            in_range!()
        );
        let rows = of_range(sql, release, range)
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during("find the recipients of reports"))?;
        rows.iter()
            .map(|row| Ok(row.column::<Option<i64>>("recipient_set_id")?.map(RecipientSetId)))
            .collect()
    }

    async fn members_with(
        &mut self,
        set: Option<RecipientSetId>,
        recipient: &OrganisationId,
    ) -> Result<BTreeSet<OrganisationId>, StoreError> {
        let mut members = BTreeSet::from([recipient.clone()]);
        let sql = "SELECT organisation_id FROM recipient_set_member WHERE recipient_set_id = $1";
        let rows = sqlx::query(sql)
            .bind(set.map(|set| set.0))
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during("read a set of recipients"))?;
        for row in &rows {
            members.insert(row.parsed("organisation_id")?);
        }
        Ok(members)
    }

    /// Replaces the set `set` of current values by `wider`.
    async fn widen_values(
        &mut self,
        release: &PastRelease,
        range: &ReportRange,
        set: Option<RecipientSetId>,
        wider: RecipientSetId,
    ) -> Result<(), StoreError> {
        let sql = concat!(
            "UPDATE field_value SET recipient_set_id = $10
             WHERE operation_network_id = $6 AND operation_id = $7 AND dynamic_data_request_id = $8
               AND epoch = $3 AND sequence BETWEEN $4 AND $5
               AND EXISTS (SELECT 1 FROM request_field f
                   WHERE f.operation_network_id = $6 AND f.dynamic_data_request_id = $8
                   AND f.field_name = field_value.field_name AND f.factory_id = $1)
               AND EXISTS (SELECT 1 FROM report p
                   WHERE p.sequence = field_value.sequence AND ",
            in_range!(),
            " AND COALESCE(",
            present_set!(),
            ", 0) = COALESCE(CAST($9 AS BIGINT), 0))"
        );
        of_range(sql, release, range)
            .bind(set.map(|set| set.0))
            .bind(wider.0)
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("show current values to one more recipient"))?;
        Ok(())
    }

    /// Replaces the set `set` of reports by `wider`.
    async fn widen_reports(
        &mut self,
        release: &PastRelease,
        range: &ReportRange,
        set: Option<RecipientSetId>,
        wider: RecipientSetId,
    ) -> Result<(), StoreError> {
        // So that the recipient sees the numbers of these reports, as of what was released at once.
        let sql = concat!(
            "INSERT INTO writer_recipient_set (factory_id, data_set_writer_id, epoch, recipient_set_id,
                 first_sequence, through_sequence, received, last_report_at, operation_network_id,
                 dynamic_data_request_id)
             SELECT $1, $2, $3, $10, MIN(p.sequence), MAX(p.sequence), COUNT(*), MAX(p.received_at), $6, $8
             FROM report p WHERE ",
            in_range!(),
            " AND COALESCE(",
            present_set!(),
            ", 0) = COALESCE(CAST($9 AS BIGINT), 0)",
            add_released!()
        );
        of_range(sql, release, range)
            .bind(set.map(|set| set.0))
            .bind(wider.0)
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("note the recipients of writers"))?;
        let sql = concat!(
            "UPDATE report AS p SET recipient_set_id = $10 WHERE ",
            in_range!(),
            " AND COALESCE(",
            present_set!(),
            ", 0) = COALESCE(CAST($9 AS BIGINT), 0)"
        );
        let moved = of_range(sql, release, range)
            .bind(set.map(|set| set.0))
            .bind(wider.0)
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("show reports to one more recipient"))?;
        // Each report counts for one set.
        let sql = "UPDATE writer_recipient_set SET received = received - $5
                   WHERE factory_id = $1 AND data_set_writer_id = $2 AND epoch = $3 AND recipient_set_id = $4";
        sqlx::query(sql)
            .bind(release.factory_id.as_str())
            .bind(i64::from(range.data_set_writer_id))
            .bind(i64::from(range.epoch))
            .bind(set.map(|set| set.0))
            .bind(signed(moved.rows_affected()))
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("note the recipients of writers"))?;
        Ok(())
    }
}

type RangeStatement =
    sqlx::query::Query<'static, Database, <Database as sqlx::Database>::Arguments>;

/// Makes a statement on the stored reports of a range, with its first eight parameters.
fn of_range(sql: &'static str, release: &PastRelease, range: &ReportRange) -> RangeStatement {
    sqlx::query(sql)
        .bind(release.factory_id.to_string())
        .bind(i64::from(range.data_set_writer_id))
        .bind(i64::from(range.epoch))
        .bind(i64::from(range.first_sequence))
        .bind(i64::from(range.last_sequence))
        .bind(release.operation_network_id.to_string())
        .bind(release.operation_id.to_string())
        .bind(release.dynamic_data_request_id.to_string())
}
