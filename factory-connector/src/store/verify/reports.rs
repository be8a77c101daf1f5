//! The reports that entries refer to, each read and hashed once as far as memory allows.

use std::collections::{BTreeSet, HashMap};

use sqlx::{SqliteConnection, sqlite::SqliteRow};

use super::on_all_processors;
use crate::store::{StoreError, load::get, writer::id_list};
use ledger::{ReportDigest, StoredReport};

/// Most reports remembered for chains that are behind; what is forgotten is read again.
const REMEMBERED_MAX: usize = 100_000;
const REPORTS: &str = "SELECT id, writer_id, epoch, sequence, created_at, CAST(recipients AS BLOB), CAST(body AS BLOB), salt \
    FROM report WHERE id IN (SELECT value FROM json_each(?))";

/// Reports that were not at hand, and those that no chain needs any more.
pub(super) struct NewReports {
    forgotten: Vec<i64>,
    stored: Vec<(i64, StoredReport)>,
}

/// Which reports are at hand where entries are looked at.
#[derive(Default)]
pub(super) struct Wanted(BTreeSet<i64>);

impl Wanted {
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
        let rows = sqlx::query(REPORTS)
            .bind(id_list(&missing))
            .fetch_all(connection)
            .await
            .map_err(StoreError::while_doing("read the ledger's reports"))?;
        Ok(NewReports { forgotten, stored: rows.iter().map(report).collect::<Result<_, _>>()? })
    }
}

fn report(row: &SqliteRow) -> Result<(i64, StoredReport), StoreError> {
    let report = StoredReport {
        data_set_writer_id: get(row, 1)?,
        epoch: get(row, 2)?,
        sequence: get(row, 3)?,
        created_at: get(row, 4)?,
        recipients: get(row, 5)?,
        body: get(row, 6)?,
        salt: get(row, 7)?,
    };
    Ok((get(row, 0)?, report))
}

/// What entries are compared with.
#[derive(Default)]
pub(super) struct Digests(HashMap<i64, ReportDigest>);

impl Digests {
    /// Takes further reports.
    pub fn add(&mut self, reports: NewReports) {
        for id in reports.forgotten {
            self.0.remove(&id);
        }
        self.0.extend(on_all_processors(&reports.stored, |(id, report)| (*id, report.digest())));
    }

    /// The report with a number; none where there is none.
    pub fn get(&self, id: i64) -> Option<&ReportDigest> {
        self.0.get(&id)
    }
}
