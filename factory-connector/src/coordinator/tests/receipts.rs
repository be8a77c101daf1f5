//! Receipts in any order: a restored broker delivers old ones late.

use super::*;

/// Sends three values of each field and lets the platform receipt those of the first.
async fn receipted() -> (Running, Report) {
    let running = Running::with_two_open_fields().await;
    for number in 1..=3 {
        running.enter_both(number).await;
    }
    let rows = running.fetch(Lane::Reports).await;
    running.accept(&rows).await;
    let made = reports(&rows[0])[0].clone();
    running.receipt(&made, 2).await;
    let controls = running.fetch(Lane::Control).await;
    running.accept(&controls).await;
    (running, made)
}

/// Returns sequence numbers of that writer's reports that wait to be sent.
async fn waiting(running: &Running, made: &Report) -> Vec<u64> {
    let rows = running.fetch(Lane::Reports).await;
    let reports = rows.iter().flat_map(reports);
    reports.filter(|report| report.writer == made.writer).map(|report| report.sequence).collect()
}

async fn gaps(running: &Running) -> Vec<Value> {
    let rows = running.fetch(Lane::Control).await;
    let gaps = rows.iter().filter(|row| row.envelope.subject == "gap");
    gaps.map(|row| serde_json::from_slice(&row.envelope.body).expect("JSON")).collect()
}

#[tokio::test]
async fn a_late_receipt_makes_no_gap_of_what_was_receipted_since() {
    let (running, made) = receipted().await;
    running.receipt_without(&made, 2, &[0, 1]).await;
    assert_eq!(gaps(&running).await, Vec::<Value>::new());
    assert_eq!(waiting(&running, &made).await, [0, 1], "the platform may really miss them");

    let rows = running.fetch(Lane::Reports).await;
    running.accept(&rows).await;
    running.receipt(&made, 2).await;
    assert_eq!(waiting(&running, &made).await, Vec::<u64>::new());
    let mut beside = connect(&running.folder).await;
    super::failures::consistent(&mut beside).await;
    running.close().await;
}

#[tokio::test]
async fn a_receipted_report_that_cannot_be_sent_again_is_announced_as_a_gap() {
    let (running, made) = receipted().await;
    let mut beside = connect(&running.folder).await;
    let emptied = "UPDATE report SET body = NULL WHERE sequence = 1";
    sqlx::query(emptied).execute(&mut beside).await.expect("as retention does");
    running.receipt_without(&made, 2, &[0, 1]).await;
    let gaps = gaps(&running).await;
    let range = |gap: &Value| (gap["firstSequence"].as_u64(), gap["lastSequence"].as_u64());
    assert_eq!(gaps.iter().map(range).collect::<Vec<_>>(), [(Some(1), Some(1))], "{gaps:?}");
    assert_eq!(waiting(&running, &made).await, [0]);
    running.close().await;
}

/// Returns the gaps of which no receipt came so far: first and last number.
async fn unsettled_gaps(running: &Running, made: &Report) -> Vec<(u32, u32)> {
    let (writer, epoch) = (made.writer as u16, made.epoch as u32);
    let mut session = running.session().await;
    let gaps = session.announced_gaps().of_writer(writer, epoch).await.expect("read");
    gaps.iter().map(|row| (row.gap.first_sequence, row.gap.last_sequence)).collect()
}

#[tokio::test]
async fn an_announcement_that_was_lost_comes_again_with_its_cause() {
    let running = Running::with_two_open_fields().await;
    for number in 1..=3 {
        running.enter_both(number).await;
    }
    let rows = running.fetch(Lane::Reports).await;
    running.accept(&rows[..1]).await;
    let made = reports(&rows[0])[0].clone();
    running.revoke(None).await;
    let lost = running.fetch(Lane::Control).await;
    running.accept(&lost).await;
    assert_eq!(unsettled_gaps(&running, &made).await, [(1, 2)]);
    running.receipt(&made, 0).await;
    assert_eq!(unsettled_gaps(&running, &made).await, [(1, 2)], "it is about the report alone");

    // As the platform answers the question about the numbers through 2.
    running.receipt_without(&made, 2, &[1, 2]).await;
    let again = gaps(&running).await;
    let facts = |gap: &Value| {
        [&gap["firstSequence"], &gap["lastSequence"], &gap["cause"]].map(Value::clone)
    };
    assert_eq!(
        again.iter().map(facts).collect::<Vec<_>>(),
        [[json!(1), json!(2), json!("REVOKED")]]
    );
    running.receipt(&made, 2).await;
    assert_eq!(unsettled_gaps(&running, &made).await, Vec::<(u32, u32)>::new());
    running.close().await;
}

/// A report that the spool gives up for want of room while it is on the wire has left all the same. Where the platform
/// lacks it nevertheless, the cause is the one that was announced: nothing was revoked.
#[tokio::test]
async fn what_was_given_up_while_it_left_and_is_missing_keeps_its_cause() {
    let running = Running::with_two_open_fields().await;
    for number in 1..=3 {
        running.enter_both(number).await;
    }
    let rows = running.fetch(Lane::Reports).await;
    let made = reports(&rows[0])[0].clone();
    let mut beside = connect(&running.folder).await;
    let given_up = "UPDATE report SET state = 'DONE' WHERE writer_id = ? AND sequence = 1";
    sqlx::query(given_up).bind(made.writer as i64).execute(&mut beside).await.expect("given up");
    let announced = "INSERT INTO announced_gap VALUES (?, ?, 1, 1, 'COALESCED', 0)";
    let announced = sqlx::query(announced).bind(made.writer as i64).bind(made.epoch as i64);
    announced.execute(&mut beside).await.expect("announced");
    running.accept(&rows).await;
    // Long enough ago that it is not under way any more.
    let sent = "UPDATE report SET sent_at = 1 WHERE sequence = 1";
    sqlx::query(sent).execute(&mut beside).await.expect("sent");
    running.receipt_without(&made, 2, &[1]).await;
    let again = gaps(&running).await;
    assert_eq!(again.iter().map(|gap| &gap["cause"]).collect::<Vec<_>>(), ["COALESCED"]);
    let entries = running.entries("acme").await;
    assert!(entries.iter().all(|entry| entry["event"] != "PURGED"), "{entries:?}");
    running.close().await;
}
