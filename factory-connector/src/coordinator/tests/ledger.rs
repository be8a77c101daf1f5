use ::ledger::{
    Verification,
    audit::{Audit, AuditError, AuditStart, Auditor},
};
use asi_model::OrganisationId;
use sqlx::{
    Column as _, Connection as _, Row as _, TypeInfo as _, ValueRef as _, sqlite::SqliteRow,
};

use tampering::AuditFile;
use transparency_log::VerifierKey;

use super::*;
use crate::store::Ledger;

/// Everything that the ledger rests on. What the spool alone works with (states, counters) is not
/// part of it.
const GUARDED: [(&str, &[&str]); 8] = [
    ("ledger_entry", &["recipient", "number", "recorded_at", "report_id", "content", "hash"]),
    ("ledger_head", &["recipient", "number", "hash", "signature", "public_key"]),
    ("ledger_log", &["recipient", "start", "size", "root", "leaves", "checkpoint"]),
    ("ledger_checkpoint", &["number", "recorded_at", "content", "signature", "public_key"]),
    ("ledger_seal", &["number", "signature", "public_key"]),
    ("revocation", &["revocation_id", "revoked_at", "content", "signature", "public_key"]),
    (
        "report",
        &[
            "id",
            "writer_id",
            "epoch",
            "sequence",
            "created_at",
            "recipients",
            "body",
            "salt",
            "sent_at",
            "message_id",
            "receipted_at",
        ],
    ),
    (
        "consent",
        &[
            "field",
            "version",
            "mapping_state",
            "value_source",
            "policy",
            "decided_by",
            "decided_at",
        ],
    ),
];

/// Makes a small ledger with an entry of each kind, and a checkpoint.
pub(super) async fn small_ledger() -> TempDir {
    let running = Running::with_two_open_fields().await;
    running.enter_both(1).await;
    let rows = running.fetch(Lane::Reports).await;
    running.accept(&rows).await;
    running.receipt(&reports(&rows[0])[0], 0).await;
    running.revoke(None).await;
    let is_made = || async {
        let count: i64 = sqlx::query_scalar("SELECT count(*) FROM ledger_checkpoint")
            .fetch_one(running.session().await.connection())
            .await
            .expect("counted");
        if count > 0 { Ok(()) } else { Err("none".to_owned()) }
    };
    testkit::wait::eventually("the daily checkpoint", DEADLINE, is_made).await.expect("made");
    running.close().await
}

pub(super) async fn verified(connection: &mut SqliteConnection) -> Verification {
    Ledger(connection).verify(None).await.expect("the tables can be read")
}

#[derive(Debug, Clone, PartialEq)]
enum Cell {
    Number(i64),
    Text(Vec<u8>),
    Blob(Vec<u8>),
    Nothing,
}

fn cell(row: &SqliteRow, place: usize) -> Cell {
    let raw = row.try_get_raw(place).expect("a column");
    if raw.is_null() {
        return Cell::Nothing;
    }
    match raw.type_info().name() {
        "INTEGER" => Cell::Number(row.get(place)),
        "TEXT" => Cell::Text(row.get_unchecked(place)),
        _ => Cell::Blob(row.get(place)),
    }
}

/// Each third bit of numbers, a bit of each byte of short cells and of each fourth byte of long
/// ones: another in each. That no bit of entries and values is without guard is shown beside the
/// verification itself.
fn flips(cell: &Cell) -> Vec<Cell> {
    let of = |bytes: &[u8]| -> Vec<Vec<u8>> {
        let step = if bytes.len() > 16 { 4 } else { 1 };
        let bits: Vec<usize> =
            (0..bytes.len()).step_by(step).map(|byte| byte * 8 + byte / step % 8).collect();
        let flip = |bit: &usize| {
            let mut bytes = bytes.to_vec();
            bytes[bit / 8] ^= 1 << (bit % 8);
            bytes
        };
        bits.iter().map(flip).collect()
    };
    match cell {
        Cell::Number(number) => {
            (0..63).step_by(3).map(|bit| Cell::Number(number ^ (1 << bit))).collect()
        }
        Cell::Text(bytes) => of(bytes).into_iter().map(Cell::Text).collect(),
        Cell::Blob(bytes) => of(bytes).into_iter().map(Cell::Blob).collect(),
        Cell::Nothing => vec![Cell::Number(1)],
    }
}

async fn put(
    connection: &mut SqliteConnection,
    table: &str,
    column: &str,
    row: i64,
    cell: &Cell,
) -> bool {
    let value = if matches!(cell, Cell::Text(_)) { "CAST(? AS TEXT)" } else { "?" };
    // Tables without a row id are found by the place of the row in the order of the shadow table.
    let sql = format!(
        "UPDATE {table} SET {column} = {value} WHERE ({keys}) = (SELECT {keys} FROM shadow_{table} WHERE place = ?)",
        keys = keys(table)
    );
    let query = sqlx::query(sqlx::AssertSqlSafe(sql));
    let query = match cell {
        Cell::Number(number) => query.bind(*number),
        Cell::Text(bytes) | Cell::Blob(bytes) => query.bind(bytes.clone()),
        Cell::Nothing => query.bind(None::<i64>),
    };
    query.bind(row).execute(connection).await.is_ok_and(|done| done.rows_affected() == 1)
}

fn keys(table: &str) -> &'static str {
    match table {
        "ledger_entry" => "recipient, number",
        "ledger_head" | "ledger_log" => "recipient",
        "ledger_checkpoint" => "number",
        "revocation" => "revocation_id",
        "report" | "ledger_seal" => "id",
        _ => "field, version",
    }
}

/// Each change of a stored bit is found: the row is changed in a transaction that is rolled back
/// afterwards.
#[tokio::test]
async fn every_bit_of_the_ledger_is_guarded() {
    let folder = small_ledger().await;
    let mut connection = connect(folder.path()).await;
    let intact = verified(&mut connection).await;
    assert!(intact.is_intact(), "{intact:?}");
    assert!(
        intact.entries > 10
            && intact.values_compared > 2
            && intact.checkpoints == 1
            && intact.revocations == 1
    );
    run(&mut connection, "PRAGMA foreign_keys = OFF").await;
    let mut changes = 0;
    for (table, columns) in GUARDED {
        let shadow = format!(
            "CREATE TEMP TABLE shadow_{table} AS SELECT row_number() OVER (ORDER BY {keys}) AS place, * FROM {table}",
            keys = keys(table)
        );
        run(&mut connection, &shadow).await;
        for column in columns {
            let sql = format!("SELECT place, {column} FROM shadow_{table}");
            let rows = sqlx::query(sqlx::AssertSqlSafe(sql))
                .fetch_all(&mut connection)
                .await
                .expect("read");
            for row in rows {
                assert_eq!(row.column(1).name(), *column);
                let place: i64 = row.get("place");
                for flipped in flips(&cell(&row, 1)) {
                    let mut attempt = connection.begin().await.expect("a transaction");
                    if put(&mut attempt, table, column, place, &flipped).await {
                        changes += 1;
                        let outcome = verified(&mut attempt).await;
                        assert!(
                            !outcome.is_intact(),
                            "{table}.{column} of row {place}: {flipped:?}"
                        );
                    }
                    attempt.rollback().await.expect("rolled back");
                }
            }
        }
    }
    assert!(changes > 1500, "{changes} changes were tried");
    assert!(verified(&mut connection).await.is_intact(), "nothing was left behind");
}

/// Each deletion of one or several rows is found, at the end of a chain too.
#[tokio::test]
async fn every_deletion_is_found() {
    let folder = small_ledger().await;
    let mut connection = connect(folder.path()).await;
    run(&mut connection, "PRAGMA foreign_keys = OFF").await;
    for (table, _) in GUARDED {
        let sql = format!("SELECT count(*) FROM {table}");
        let count: i64 = sqlx::query_scalar(sqlx::AssertSqlSafe(sql))
            .fetch_one(&mut connection)
            .await
            .expect("counted");
        for place in 0..count {
            for condition in ["=", ">="] {
                let mut attempt = connection.begin().await.expect("a transaction");
                let sql = format!(
                    "DELETE FROM {table} WHERE ({keys}) {condition} \
                     (SELECT {keys} FROM {table} ORDER BY {keys} LIMIT 1 OFFSET {place})",
                    keys = keys(table)
                );
                run(&mut attempt, &sql).await;
                assert!(!verified(&mut attempt).await.is_intact(), "{sql}");
                attempt.rollback().await.expect("rolled back");
            }
        }
    }
}

/// Reads the audit file of the first recipient's chain, a checkpoint that is older, and its key.
async fn audit_file(folder: &Path) -> (AuditFile, VerifierKey) {
    let mut connection = connect(folder).await;
    let mut ledger = Ledger(&mut connection);
    let recipients = ledger.recipients().await.expect("read");
    let recipient: OrganisationId = recipients[0].parse().expect("an id");
    let kept = ledger.log_checkpoint(&recipient).await.expect("read").expect("a checkpoint");
    let key = crate::ledger_key::open(&folder.join(LEDGER_KEY_FILE)).expect("the key");
    let start = ledger.audit_start(&recipient, Some(&key)).await.expect("read").expect("a log");
    let entries = ledger.audit_entries(&recipient, start.number).await.expect("read");
    let mut lines = vec![serde_json::to_string(&start).expect("JSON")];
    lines.extend(entries.iter().map(|entry| serde_json::to_string(entry).expect("JSON")));
    (AuditFile { lines, checkpoint: kept.note, foreign: Vec::new() }, kept.key)
}

fn audit(lines: &[String], checkpoint: &str, key: &VerifierKey) -> Result<Audit, AuditError> {
    let first = lines.first().map(String::as_str).unwrap_or_default();
    let mut auditor = Auditor::new(checkpoint, key, first, None)?;
    lines[1..].iter().for_each(|line| auditor.take(line));
    Ok(auditor.finish())
}

/// A checkpoint that was kept elsewhere proves the whole chain by a file, without the store.
#[tokio::test]
async fn an_audit_file_is_proven_by_a_checkpoint() {
    let folder = small_ledger().await;
    let (file, key) = audit_file(folder.path()).await;
    let start: AuditStart = serde_json::from_str(&file.lines[0]).expect("a start");
    let newest = start.checkpoint.expect("the file has a checkpoint");
    for checkpoint in [&file.checkpoint, &newest] {
        let outcome = audit(&file.lines, checkpoint, &key).expect("it begins");
        assert!(outcome.is_intact(), "{outcome:#?}");
        assert!(outcome.values_compared > 1);
        let is_newest = checkpoint == &newest;
        assert_eq!(outcome.entries_after == 0, is_newest, "{outcome:#?}");
    }
    let older = audit(&file.lines[..file.lines.len() - 1], &newest, &key).expect("it begins");
    assert!(!older.is_intact(), "an older copy");
}

/// The file of a real connector cannot be changed unnoticed by one who has no key.
#[tokio::test]
async fn every_kind_of_tampering_with_an_audit_file_is_found() {
    let folder = small_ledger().await;
    let (file, key) = audit_file(folder.path()).await;
    let faults = |lines: &[String], checkpoint: &str| {
        audit(lines, checkpoint, &key).map_or(1, |outcome| outcome.fault_count)
    };
    assert_eq!(faults(&file.lines, &file.checkpoint), 0, "the file itself is intact");
    tampering::try_all(&file, &faults).assert_all_found(200);
}

/// Without the key beside the ledger a file has a checkpoint only where the newest entry has one.
#[tokio::test]
async fn an_audit_file_without_the_key_says_that_its_end_is_unsigned() {
    let folder = small_ledger().await;
    let (file, _) = audit_file(folder.path()).await;
    let mut connection = connect(folder.path()).await;
    let mut ledger = Ledger(&mut connection);
    let recipient = ledger.recipients().await.expect("read")[0].parse().expect("an id");
    let start = ledger.audit_start(&recipient, None).await.expect("read").expect("a log");
    assert_eq!(start.checkpoint, None);
    assert!(file.lines[0].contains("\"checkpoint\""));
}

/// An attacker who rewrites and re-signs everything does not have the key that was noted before.
#[tokio::test]
async fn another_key_is_found() {
    let folder = small_ledger().await;
    let mut connection = connect(folder.path()).await;
    let other = crate::ledger_key::open(&folder.path().join("other.pem")).expect("a key");
    let outcome = Ledger(&mut connection).verify(Some(other.public())).await.expect("read");
    assert!(!outcome.is_intact());
}

pub(super) async fn run(connection: &mut SqliteConnection, sql: &str) {
    sqlx::query(sqlx::AssertSqlSafe(sql.to_owned())).execute(connection).await.expect("it runs");
}
