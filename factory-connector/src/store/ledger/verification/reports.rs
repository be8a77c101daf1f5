//! The reports that entries refer to, each read and hashed once as far as memory allows.

use std::collections::{BTreeSet, HashMap};

use ledger::{ReportDigest, StoredReport};
use sqlx::{SqliteConnection, sqlite::SqliteRow};

use super::parallel::on_all_processors;
use crate::store::{
    error::StoreError,
    query::{all, query},
    row::{Columns as _, document},
};

/// Reports remembered at most for chains that are behind; a forgotten one is read again.
const REMEMBERED_MAX: usize = 100_000;

/// Reports that were not at hand, and those that no chain needs any more.
pub(super) struct NewReports {
    forgotten: Vec<i64>,
    stored: Vec<(i64, StoredReport)>,
}

/// Reader of reports, which knows those that the check of the entries has at hand.
#[derive(Default)]
pub(super) struct ReportReader(BTreeSet<i64>);

impl ReportReader {
    /// Reads those of the reports that are not at hand. All chains are past `behind`.
    pub async fn read(
        &mut self,
        connection: &mut SqliteConnection,
        referred: &[i64],
        behind: Option<i64>,
    ) -> Result<NewReports, StoreError> {
        let mut forgotten = Vec::new();
        let needed = referred.iter().copied().min().unwrap_or(i64::MAX);
        while let Some(first) = self.0.first().copied()
            && first < needed
            && (self.0.len() > REMEMBERED_MAX || behind.is_none_or(|behind| first < behind))
        {
            self.0.remove(&first);
            forgotten.push(first);
        }
        let missing: Vec<i64> = referred.iter().copied().filter(|id| self.0.insert(*id)).collect();
        if missing.is_empty() {
            return Ok(NewReports { forgotten, stored: Vec::new() });
        }
        let sql = "SELECT id, writer_id, epoch, sequence, created_at,
                       CAST(recipients AS BLOB) AS recipients, CAST(body AS BLOB) AS body, salt,
                       sent_at, CAST(message_id AS BLOB) AS message_id, receipted_at
                   FROM report WHERE id IN (SELECT value FROM json_each(?))";
        let query = query(sql).bind(document(&missing));
        let stored = all(connection, query, "read the ledger's reports", report).await?;
        Ok(NewReports { forgotten, stored })
    }
}

fn report(row: &SqliteRow) -> Result<(i64, StoredReport), StoreError> {
    let report = StoredReport {
        data_set_writer_id: row.column("writer_id")?,
        epoch: row.column("epoch")?,
        sequence: row.column("sequence")?,
        created_at: row.column("created_at")?,
        recipients: row.column("recipients")?,
        body: row.column("body")?,
        salt: row.column("salt")?,
        sent_at: row.column("sent_at")?,
        message_id: row.column("message_id")?,
        receipted_at: row.column("receipted_at")?,
    };
    Ok((row.column("id")?, report))
}

/// Digests that entries are compared with, by the numbers of the reports.
#[derive(Default)]
pub(super) struct Digests(HashMap<i64, ReportDigest>);

impl Digests {
    /// Adds further reports and forgets others.
    pub fn add(&mut self, reports: NewReports) {
        for id in reports.forgotten {
            self.0.remove(&id);
        }
        self.0.extend(on_all_processors(&reports.stored, |(id, report)| (*id, report.digest())));
    }

    /// Returns the digest of a report; `None` for one that is not stored.
    pub fn get(&self, id: i64) -> Option<&ReportDigest> {
        self.0.get(&id)
    }
}
