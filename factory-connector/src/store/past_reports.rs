//! Reports of the past: what left of a request for others than a recipient that was added later.
//!
//! Only reports that were sent are of the past, and only those whose values are still here: what
//! nobody can look at is not offered.

use std::collections::BTreeMap;

use asi_model::{FieldName, OrganisationId, RequestKey};
use connector_state::past::{Past, PastReport, ReportConsents};
use ledger::{Event, LedgerEntry};
use sqlx::{SqliteConnection, sqlite::SqliteRow};

use super::{
    consents,
    error::StoreError,
    query::{all, query},
    row::{Columns as _, document},
};

/// Most reports that are decided about at once; the newer ones are asked about afterwards.
const REPORTS_MAX: i64 = 100_000;

const READ: &str = "read the reports of the past";

/// Recipients of an epoch of a request's writer. They are the same for all reports of an epoch:
/// with other recipients a new one begins.
#[derive(Debug, Clone, PartialEq)]
pub struct EpochRecipients {
    pub request: RequestKey,
    pub recipients: Vec<OrganisationId>,
    /// Number of its last report.
    pub last_report: i64,
}

/// Repository of reports of the past.
pub struct PastReports<'c>(pub(super) &'c mut SqliteConnection);

impl PastReports<'_> {
    /// Reads the recipients of all epochs in which anything was reported, by the first report that
    /// is stored of each. Costs two lookups per epoch, however many its reports.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn epochs(&mut self) -> Result<Vec<EpochRecipients>, StoreError> {
        let sql = "SELECT c.operation_network_id, c.operation_id, c.dynamic_data_request_id,
                       r.recipients,
                       (SELECT l.id FROM report l
                        WHERE l.writer_id = c.writer_id AND l.epoch = c.epoch
                        ORDER BY l.sequence DESC LIMIT 1) AS last_report
                   FROM (SELECT DISTINCT operation_network_id, operation_id,
                             dynamic_data_request_id, writer_id, epoch FROM carried_field) AS c
                   JOIN report r ON r.id = (SELECT f.id FROM report f
                       WHERE f.writer_id = c.writer_id AND f.epoch = c.epoch
                       ORDER BY f.sequence LIMIT 1)";
        all(self.0, query(sql), READ, |row| {
            Ok(EpochRecipients {
                request: row.request_key()?,
                recipients: row.document("recipients")?,
                last_report: row.column("last_report")?,
            })
        })
        .await
    }

    /// Reads the reports of a request with greater numbers than `after` that left for others than
    /// this recipient, oldest first, at most 100 000, with the policies under which they left.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn of(
        &mut self,
        request: &RequestKey,
        recipient: &OrganisationId,
        after: i64,
    ) -> Result<Past, StoreError> {
        let sql = "SELECT r.id, r.created_at,
                       (SELECT e.content FROM ledger_entry e WHERE e.report_id = r.id LIMIT 1)
                           AS content
                   FROM (SELECT DISTINCT x.writer_id, x.epoch FROM carried_field x
                         WHERE x.operation_network_id = ?1 AND x.operation_id = ?2
                             AND x.dynamic_data_request_id = ?3
                             AND NOT EXISTS (SELECT 1 FROM json_each((
                                 SELECT f.recipients FROM report f
                                 WHERE f.writer_id = x.writer_id AND f.epoch = x.epoch
                                 ORDER BY f.sequence LIMIT 1)) WHERE value = ?5)) AS c
                   CROSS JOIN report r ON r.writer_id = c.writer_id AND r.epoch = c.epoch
                   WHERE r.sent_at IS NOT NULL AND r.body IS NOT NULL AND r.id > ?4
                       AND NOT EXISTS (SELECT 1 FROM json_each(r.recipients) WHERE value = ?5)
                   ORDER BY r.id LIMIT ?6";
        let query = query(sql)
            .bind(request.operation_network_id.to_string())
            .bind(request.operation_id.to_string())
            .bind(request.dynamic_data_request_id.to_string())
            .bind(after)
            .bind(recipient.to_string())
            .bind(REPORTS_MAX);
        let mut found = all(self.0, query, READ, report).await?;
        share_consents(&mut found);
        let reports: Vec<PastReport> = found.into_iter().flatten().collect();
        let policies = self.policies(request, &reports).await?;
        Ok(Past { request: request.clone(), recipient: recipient.clone(), reports, policies })
    }

    async fn policies(
        &mut self,
        request: &RequestKey,
        reports: &[PastReport],
    ) -> Result<BTreeMap<(FieldName, u32), disclosure::DisclosurePolicy>, StoreError> {
        let mut policies = BTreeMap::new();
        let mut read: Option<&ReportConsents> = None;
        for consents in reports.iter().map(|report| &report.consents) {
            if read == Some(consents) {
                continue;
            }
            read = Some(consents);
            for (name, version) in &**consents {
                let key = (name.clone(), *version);
                if policies.contains_key(&key) {
                    continue;
                }
                let field = request.field(name.clone()).to_string();
                let policy = consents::policy(self.0, &field, u64::from(*version)).await?;
                if let Some(policy) = policy.and_then(|text| serde_json::from_str(&text).ok()) {
                    policies.insert(key, policy);
                }
            }
        }
        Ok(policies)
    }

    /// Reads reports with these numbers as they left: the DataSetMessages, oldest first.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn bodies(&mut self, ids: &[i64]) -> Result<Vec<String>, StoreError> {
        let sql = "SELECT body FROM report
                   WHERE body IS NOT NULL AND id IN (SELECT value FROM json_each(?)) ORDER BY id";
        all(self.0, query(sql).bind(document(ids)), READ, |row| row.column("body")).await
    }
}

/// Reads a report; `None` where the ledger has no entry about its values any more.
fn report(row: &SqliteRow) -> Result<Option<PastReport>, StoreError> {
    let content: Option<String> = row.column("content")?;
    let entry: Option<LedgerEntry> =
        content.as_deref().and_then(|text| serde_json::from_str(text).ok());
    let Some(Event::Queued { range, values, consents }) = entry.map(|entry| entry.event) else {
        return Ok(None);
    };
    let root = hex::decode(&values).ok().and_then(|root| root.try_into().ok());
    let Some(values) = root else { return Ok(None) };
    Ok(Some(PastReport {
        id: row.column("id")?,
        data_set_writer_id: range.data_set_writer_id,
        epoch: range.epoch,
        sequence: range.first_sequence,
        created_at: row.time("created_at")?,
        values,
        consents: consents.into(),
    }))
}

/// Lets neighbours with the same consents share them: there are many reports and few consents.
fn share_consents(reports: &mut [Option<PastReport>]) {
    let mut last: Option<ReportConsents> = None;
    for report in reports.iter_mut().flatten() {
        match &last {
            Some(known) if *known == report.consents => report.consents = known.clone(),
            _ => last = Some(report.consents.clone()),
        }
    }
}
