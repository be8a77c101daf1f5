//! Reports: the history of values that factories disclosed.

use std::collections::BTreeMap;

use asi_model::{
    DateTime, DynamicDataRequestId, FactoryId, OperationNetworkId, RequestKey,
    plain_value::ReportedValue,
};
use indexmap::IndexMap;
use serde::Serialize;
use sqlx::QueryBuilder;
use utoipa::ToSchema;

use super::{
    database::{Connection, Database},
    error::StoreError,
    recipient_sets::{RecipientSetId, add_released},
    report_cursor::ReportCursor,
    report_history::Restrictions,
    row::{Columns, DatabaseRow, document},
    scope::Scope,
    writers::WriterKey,
};
use crate::accesses::{Contents, Values, Withheld};

/// A DataSetMessage to store.
#[derive(Debug, Clone, PartialEq)]
pub struct NewReport {
    pub factory_id: FactoryId,
    pub data_set_writer_id: u16,
    pub epoch: u32,
    /// The sequence number within the epoch.
    pub sequence: u32,
    /// The request it answers.
    pub request: RequestKey,
    pub report_name: String,
    /// The newest source time among the fields.
    pub shopfloor_timestamp: Option<DateTime>,
    /// Time of the report at the connector.
    pub report_timestamp: Option<DateTime>,
    /// Time of arrival at the platform.
    pub received_at: DateTime,
    /// True if it belongs to the backlog after an outage.
    pub is_replay: bool,
    /// The organisations that may read it; none where nobody may.
    pub recipient_set: Option<RecipientSetId>,
    /// The fields by their names, in the order of the payload.
    pub fields: IndexMap<String, ReportedValue>,
}

/// A report as its recipients see it.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct Report {
    pub factory_id: FactoryId,
    pub data_set_writer_id: u16,
    pub epoch: u32,
    /// The sequence number within the epoch.
    pub sequence: u32,
    /// The request it answers.
    #[serde(flatten)]
    pub request: RequestKey,
    /// Name of its format, as the request has it.
    pub report_name: String,
    /// The newest source time among the fields.
    pub shopfloor_timestamp: Option<DateTime>,
    /// Time of the report at the connector.
    pub report_timestamp: Option<DateTime>,
    /// Time of arrival at the platform.
    pub received_at: DateTime,
    /// True if it came late, after newer ones.
    pub is_replay: bool,
    /// The fields by their names.
    #[schema(value_type = std::collections::BTreeMap<String, ReportedValue>)]
    pub fields: IndexMap<String, ReportedValue>,
}

impl From<&Report> for ReportCursor {
    fn from(report: &Report) -> Self {
        Self {
            factory_id: report.factory_id.clone(),
            data_set_writer_id: report.data_set_writer_id,
            epoch: report.epoch,
            sequence: report.sequence,
        }
    }
}

impl Values for Vec<Report> {
    fn contents(&self) -> Vec<Contents> {
        Contents::gather(self.iter().flat_map(|report| {
            let reported_at = report.report_timestamp.or(report.shopfloor_timestamp);
            report.fields.iter().map(move |(name, value)| {
                let at = value.source_timestamp.or(reported_at);
                (&report.factory_id, &report.request, name.as_str(), at)
            })
        }))
    }
}

/// Filter and page of the history.
#[derive(Debug, Clone, Default)]
pub struct ReportQuery {
    /// Restricts to this network.
    pub network: Option<OperationNetworkId>,
    /// Restricts to this request.
    pub request: Option<DynamicDataRequestId>,
    /// Restricts to those that arrived after this one. One that was not released to the viewer is like
    /// one that never came: it restricts nothing.
    pub after: Option<ReportCursor>,
    /// Most reports to return.
    pub limit: u32,
    /// The newest ones instead of the oldest; listed in the order of arrival all the same.
    pub is_newest: bool,
}

/// Condition on a row `p` of `report`: it was released to the viewer `$1`.
macro_rules! released {
    () => {
        "(CAST($1 AS TEXT) IS NULL OR EXISTS (
                 SELECT 1 FROM recipient_set_member m WHERE m.organisation_id = $1
                 AND m.recipient_set_id = p.recipient_set_id))"
    };
}

/// Reports of a writer that were released to the same recipients.
#[derive(PartialEq, Eq, Hash, PartialOrd, Ord)]
struct ReleasingWriter<'r> {
    factory: &'r str,
    id: u16,
    epoch: u32,
    recipient_set: RecipientSetId,
}

/// Numbers and arrival of released reports.
struct ReleasedNumbers<'r> {
    first: u32,
    through: u32,
    received: i64,
    /// Arrival of the last one.
    last_at: DateTime,
    /// The request that the last one answers.
    request: &'r RequestKey,
}

fn released(reports: &[NewReport]) -> BTreeMap<ReleasingWriter<'_>, ReleasedNumbers<'_>> {
    let mut writers: BTreeMap<ReleasingWriter<'_>, ReleasedNumbers<'_>> = BTreeMap::new();
    for report in reports {
        let Some(recipient_set) = report.recipient_set else { continue };
        let (factory, id) = (report.factory_id.as_str(), report.data_set_writer_id);
        let writer = ReleasingWriter { factory, id, epoch: report.epoch, recipient_set };
        let released = writers.entry(writer).or_insert(ReleasedNumbers {
            first: report.sequence,
            through: report.sequence,
            received: 0,
            last_at: report.received_at,
            request: &report.request,
        });
        released.first = released.first.min(report.sequence);
        released.through = released.through.max(report.sequence);
        released.received += 1;
        released.last_at = released.last_at.max(report.received_at);
        released.request = &report.request;
    }
    writers
}

/// Repository of reports.
pub struct Reports<'w>(pub(super) &'w mut Connection);

const ROWS_PER_STATEMENT: usize = 200;

impl Reports<'_> {
    /// Returns true if a report with this number is stored.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn is_held(&mut self, writer: &WriterKey, sequence: u32) -> Result<bool, StoreError> {
        let sql =
            "SELECT 1 FROM report WHERE factory_id = $1 AND data_set_writer_id = $2 AND epoch = $3
                       AND sequence = $4";
        let found = sqlx::query(sql)
            .bind(writer.factory_id.as_str())
            .bind(i64::from(writer.data_set_writer_id))
            .bind(i64::from(writer.epoch))
            .bind(i64::from(sequence))
            .fetch_optional(&mut *self.0)
            .await
            .map_err(StoreError::during("look a report up"))?;
        Ok(found.is_some())
    }

    /// Stores reports whose sequence numbers are known to be new.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn add(&mut self, reports: &[NewReport]) -> Result<(), StoreError> {
        for chunk in reports.chunks(ROWS_PER_STATEMENT) {
            let mut query = QueryBuilder::<Database>::new(
                "INSERT INTO report (factory_id, data_set_writer_id, epoch, sequence, operation_network_id,
                     operation_id, dynamic_data_request_id, report_name, shopfloor_timestamp, report_timestamp,
                     received_at, is_replay, recipient_set_id, fields) ",
            );
            query.push_values(chunk, |mut row, report| {
                row.push_bind(report.factory_id.as_str())
                    .push_bind(i64::from(report.data_set_writer_id))
                    .push_bind(i64::from(report.epoch))
                    .push_bind(i64::from(report.sequence))
                    .push_bind(report.request.operation_network_id.as_str())
                    .push_bind(report.request.operation_id.as_str())
                    .push_bind(report.request.dynamic_data_request_id.as_str())
                    .push_bind(&report.report_name)
                    .push_bind(report.shopfloor_timestamp.map(DateTime::ticks))
                    .push_bind(report.report_timestamp.map(DateTime::ticks))
                    .push_bind(report.received_at.ticks())
                    .push_bind(i64::from(report.is_replay))
                    .push_bind(report.recipient_set.map(|set| set.0))
                    .push_bind(document(&report.fields));
            });
            query
                .build()
                .execute(&mut *self.0)
                .await
                .map_err(StoreError::during("store reports"))?;
        }
        self.note_recipients(reports).await
    }

    /// Notes what the writers of these reports released to whom, so that no reader of a writer's
    /// numbers needs its history.
    async fn note_recipients(&mut self, reports: &[NewReport]) -> Result<(), StoreError> {
        let writers: Vec<_> = released(reports).into_iter().collect();
        for chunk in writers.chunks(ROWS_PER_STATEMENT) {
            let mut query = QueryBuilder::<Database>::new(
                "INSERT INTO writer_recipient_set (factory_id, data_set_writer_id, epoch, recipient_set_id,
                     first_sequence, through_sequence, received, last_report_at, operation_network_id,
                     dynamic_data_request_id) ",
            );
            query.push_values(chunk, |mut row, (writer, released)| {
                row.push_bind(writer.factory)
                    .push_bind(i64::from(writer.id))
                    .push_bind(i64::from(writer.epoch))
                    .push_bind(writer.recipient_set.0)
                    .push_bind(i64::from(released.first))
                    .push_bind(i64::from(released.through))
                    .push_bind(released.received)
                    .push_bind(released.last_at.ticks())
                    .push_bind(released.request.operation_network_id.as_str())
                    .push_bind(released.request.dynamic_data_request_id.as_str());
            });
            query.push(add_released!());
            query
                .build()
                .execute(&mut *self.0)
                .await
                .map_err(StoreError::during("note the recipients of writers"))?;
        }
        Ok(())
    }

    /// Reports that were released to the viewer, in the order of arrival.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn list(
        &mut self,
        scope: &Scope,
        query: &ReportQuery,
    ) -> Result<Withheld<Vec<Report>>, StoreError> {
        let restrictions = Restrictions {
            has_viewer: scope.recipient().is_some(),
            has_network: query.network.is_some(),
            has_request: query.request.is_some(),
            is_newest: query.is_newest,
        };
        let after = match &query.after {
            Some(cursor) => self.arrival(scope, cursor).await?.unwrap_or(0),
            None => 0,
        };
        let mut rows = sqlx::query(sqlx::AssertSqlSafe(restrictions.statement()))
            .bind(scope.recipient())
            .bind(after)
            .bind(query.network.as_ref().map(OperationNetworkId::as_str))
            .bind(query.request.as_ref().map(DynamicDataRequestId::as_str))
            .bind(i64::from(query.limit))
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during("list reports"))?;
        if query.is_newest {
            rows.reverse();
        }
        let reports: Result<Vec<Report>, StoreError> = rows.iter().map(read).collect();
        reports.map(Withheld::new)
    }

    /// Returns the place of a report in the order of arrival; `None` where none was released to the
    /// viewer under these numbers.
    async fn arrival(
        &mut self,
        scope: &Scope,
        cursor: &ReportCursor,
    ) -> Result<Option<i64>, StoreError> {
        let sql = concat!(
            "SELECT p.report_id FROM report p WHERE p.factory_id = $2 AND p.data_set_writer_id = $3
             AND p.epoch = $4 AND p.sequence = $5 AND ",
            released!()
        );
        let row = sqlx::query(sql)
            .bind(scope.recipient())
            .bind(cursor.factory_id.as_str())
            .bind(i64::from(cursor.data_set_writer_id))
            .bind(i64::from(cursor.epoch))
            .bind(i64::from(cursor.sequence))
            .fetch_optional(&mut *self.0)
            .await
            .map_err(StoreError::during("look a report up"))?;
        row.map(|row| row.column("report_id")).transpose()
    }
}

fn read(row: &DatabaseRow) -> Result<Report, StoreError> {
    Ok(Report {
        factory_id: row.parsed("factory_id")?,
        data_set_writer_id: row.unsigned("data_set_writer_id")?,
        epoch: row.unsigned("epoch")?,
        sequence: row.unsigned("sequence")?,
        request: RequestKey {
            operation_network_id: row.parsed("operation_network_id")?,
            operation_id: row.parsed("operation_id")?,
            dynamic_data_request_id: row.parsed("dynamic_data_request_id")?,
        },
        report_name: row.column("report_name")?,
        shopfloor_timestamp: row.time_option("shopfloor_timestamp")?,
        report_timestamp: row.time_option("report_timestamp")?,
        received_at: row.time("received_at")?,
        is_replay: row.unsigned::<u8>("is_replay")? != 0,
        fields: row.json("fields")?,
    })
}
