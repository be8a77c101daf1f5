use super::*;
use crate::store::Ledger;

/// The disk fails at any statement of the transaction: the caller gets the error, nothing of the
/// transaction is stored, and the next attempt continues the numbers without a gap.
#[tokio::test]
async fn a_failure_of_any_statement_leaves_chain_and_spool_consistent() {
    let running = Running::with_two_open_fields().await;
    let mut beside = connect(&running.folder).await;
    for (number, table) in (1..).zip([
        "operator_entry",
        "writer",
        "report",
        "field_value",
        "ledger_entry",
        "ledger_head",
    ]) {
        let value = json!(number * 10);
        fail(&running, table, vec![entry("made", value.clone())]).await;
        running.enter(vec![entry("made", value)]).await.expect("written");
        consistent(&mut beside).await;
    }
    running.close().await;
}

/// Messages may be under way that the store does not have: keep-alives, and what was deleted
/// because it was accepted. Were its number given again, its outcome would be taken for the new
/// row's.
#[tokio::test]
async fn no_number_comes_again_after_a_failure() {
    let running = Running::with_two_open_fields().await;
    let controls = running.fetch(Lane::Control).await;
    let last = controls.last().expect("the decisions are told").id;
    running.accept(&controls).await;
    fail(&running, "report", vec![entry("made", json!(1))]).await;
    running.enter_both(1).await;
    let reports = running.fetch(Lane::Reports).await;
    assert!(reports.iter().all(|row| row.id > last), "{reports:?} come after {last:?}");
    running.close().await;
}

/// The link records an outcome again that could not be written: the ledger states the message in
/// which the reports left all the same.
#[tokio::test]
async fn an_outcome_that_is_recorded_again_keeps_its_message() {
    let running = Running::with_two_open_fields().await;
    running.enter_both(1).await;
    let rows = running.fetch(Lane::Reports).await;
    assert!(rows.iter().all(|row| running.spool.may_leave(row)), "on the wire");
    let accepted = || {
        let outcome = |row: &SpoolRow| RowOutcome {
            id: row.id,
            outcome: SendOutcome::Accepted,
            at: OffsetDateTime::now_utc(),
        };
        rows.iter().map(outcome).collect::<Vec<_>>()
    };
    let mut beside = connect(&running.folder).await;
    break_table(&mut beside, "ledger_entry").await;
    running.spool.record(accepted()).await.expect_err("it cannot be written");
    mend_table(&mut beside).await;
    running.spool.record(accepted()).await.expect("recorded");
    let entries = running.entries("acme").await;
    let sent: Vec<_> = entries.iter().filter(|entry| entry["event"] == "SENT").collect();
    assert!(
        !sent.is_empty() && sent.iter().all(|entry| entry["messageId"].is_string()),
        "{sent:?}"
    );
    running.close().await;
}

/// The heads of all chains are signed at every start, also where its first transaction fails.
#[tokio::test]
async fn heads_are_signed_after_a_start_whose_first_transaction_failed() {
    let folder = Running::with_two_open_fields().await.close().await;
    let mut beside = connect(folder.path()).await;
    sqlx::query("UPDATE ledger_head SET signature = x'00'")
        .execute(&mut beside)
        .await
        .expect("set");
    break_table(&mut beside, "ledger_head").await;
    let running = Running::open_in(folder.path().to_owned(), Some(folder)).await;
    running.coordinator.read(|_| ()).await.expect("it goes on after the failure");
    mend_table(&mut beside).await;
    let begun = std::time::Instant::now();
    loop {
        let unsigned: i64 =
            sqlx::query_scalar("SELECT count(*) FROM ledger_head WHERE signature = x'00'")
                .fetch_one(&mut beside)
                .await
                .expect("counted");
        if unsigned == 0 {
            break;
        }
        assert!(begun.elapsed() < DEADLINE, "{unsigned} heads are not signed");
        tokio::time::sleep(PAUSE).await;
    }
    running.close().await;
}

/// Enters something while nothing can be written to a table.
async fn fail(running: &Running, table: &str, entries: Vec<OperatorEntry>) {
    let mut beside = connect(&running.folder).await;
    break_table(&mut beside, table).await;
    assert_eq!(running.enter(entries).await, Err(CoordinatorError::NotWritten), "{table}");
    mend_table(&mut beside).await;
}

/// Lets every write to a table fail.
pub(super) async fn break_table(beside: &mut SqliteConnection, table: &str) {
    for event in ["INSERT", "UPDATE"] {
        let sql = format!(
            "CREATE TRIGGER broken_{event} BEFORE {event} ON {table} BEGIN SELECT RAISE(ABORT, 'disk full'); END"
        );
        sqlx::query(sqlx::AssertSqlSafe(sql)).execute(&mut *beside).await.expect("made");
    }
}

/// Lets writes succeed again.
pub(super) async fn mend_table(beside: &mut SqliteConnection) {
    for event in ["INSERT", "UPDATE"] {
        let sql = format!("DROP TRIGGER broken_{event}");
        sqlx::query(sqlx::AssertSqlSafe(sql)).execute(&mut *beside).await.expect("dropped");
    }
}

/// The ledger is intact; each report has its entry in each recipient's chain; sequence numbers have
/// no hole.
pub(super) async fn consistent(connection: &mut SqliteConnection) {
    let outcome = Ledger(&mut *connection).verify(None).await.expect("read");
    assert!(outcome.is_intact(), "{outcome:?}");
    let unmatched: i64 = sqlx::query_scalar(
        "SELECT count(*) FROM report r WHERE (SELECT count(*) FROM ledger_entry e WHERE e.report_id = r.id) \
         <> json_array_length(r.recipients)",
    )
    .fetch_one(&mut *connection)
    .await
    .expect("counted");
    assert_eq!(unmatched, 0, "every report is in the chain of each of its recipients");
    let holes: i64 = sqlx::query_scalar(
        "SELECT count(*) FROM (SELECT max(sequence) + 1 - count(*) AS missing FROM report GROUP BY writer_id, epoch) \
         WHERE missing <> 0",
    )
    .fetch_one(&mut *connection)
    .await
    .expect("counted");
    assert_eq!(holes, 0, "sequence numbers have no hole");
    let behind: i64 = sqlx::query_scalar(
        "SELECT count(*) FROM writer w WHERE w.next_sequence <> coalesce((SELECT max(sequence) + 1 FROM report r \
         WHERE r.writer_id = w.id AND r.epoch = w.epoch), 0)",
    )
    .fetch_one(connection)
    .await
    .expect("counted");
    assert_eq!(behind, 0, "the next number follows the last report");
}
