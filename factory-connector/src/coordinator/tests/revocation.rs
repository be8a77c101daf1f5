use super::*;
use crate::store::Ledger;

/// Brings four reports of each data set: the first delivered, the second sent, the third fetched by
/// the link (returned), the fourth waiting. Returns the first report of the field "made" as well.
async fn reports_on_their_way(running: &Running) -> (Report, Vec<SpoolRow>) {
    running.enter_both(1).await;
    let first = running.fetch(Lane::Reports).await;
    assert_eq!(running.accept(&first).await, 1);
    let made = reports(&first[0]).into_iter().next().expect("a report");
    running.receipt(&made, 0).await;
    running.enter_both(2).await;
    let second = running.fetch(Lane::Reports).await;
    assert_eq!(running.accept(&second).await, 1);
    running.enter_both(3).await;
    let third = running.fetch(Lane::Reports).await;
    assert_eq!(reports(&third[0]).len(), 2, "both data sets share the message");
    running.enter_both(4).await;
    (made, third)
}

/// A revocation stops the field at once, takes back waiting reports, notifies the partner, and
/// leaves a receipt that names the last number delivered.
#[tokio::test]
async fn a_revocation_stops_takes_back_notifies_and_states_what_had_left() {
    let running = Running::with_two_open_fields().await;
    let (made, third) = reports_on_their_way(&running).await;

    let id = running.revoke(Some("Enough.")).await;

    assert_eq!(running.accept(&third).await, 0, "fetched before, but it does not leave any more");
    let rest = running.fetch(Lane::Reports).await;
    let left: Vec<Report> = rest.iter().flat_map(reports).collect();
    assert!(!left.is_empty() && left.iter().all(|report| report.writer != made.writer), "{left:?}");
    running.accept(&rest).await;
    let refused = running.enter(vec![entry("made", json!(5))]).await.expect("answered");
    assert!(matches!(refused[0], EntryOutcome::Refused(_)), "{refused:?}");

    assert_receipt(&running, &id, &made).await;
    assert_partner_is_notified(&running).await;
    assert_receipt_for_partners(&running, &id).await;

    // A report in flight arrives all the same, and the receipt's page shows it.
    running.receipt(&made, 1).await;
    let found = running.session().await.revocations().lookup(&id).await.expect("read");
    let found = found.expect("a receipt");
    assert_eq!((found.arrived_since, found.open), (1, 0));

    for recipient in ["acme", "hull"] {
        let entries = running.entries(recipient).await;
        let revoked = entries.iter().find(|entry| entry["event"] == "REVOKED").expect("an entry");
        assert_eq!(
            (&revoked["revocationId"], &revoked["lastDeliveredSequence"]),
            (&json!(id), &json!(0))
        );
        assert!(
            entries.iter().any(|entry| entry["event"] == "SENT" && entry["messageId"].is_string())
        );
    }
    let folder = running.close().await;
    let outcome = Ledger(&mut connect(folder.path()).await).verify(None).await.expect("read");
    assert!(outcome.is_intact(), "{outcome:?}");
    assert_eq!(outcome.revocations, 1);
}

/// The receipt names author, reason, fields, and the last number of each delivery state.
async fn assert_receipt(running: &Running, id: &str, made: &Report) {
    let found = running.session().await.revocations().lookup(id).await.expect("read");
    let found = found.expect("a receipt");
    let receipt = &found.receipt;
    assert_eq!(
        (receipt.revoked_by.as_deref(), receipt.reason.as_deref()),
        (Some("eve"), Some("Enough."))
    );
    assert_eq!(
        receipt.fields.iter().map(|f| (f.field.clone(), f.consent_version)).collect::<Vec<_>>(),
        [(field("made"), 1)]
    );
    let [writer] = &receipt.writers[..] else { panic!("{:?}", receipt.writers) };
    assert_eq!(
        (u64::from(writer.data_set_writer_id), u64::from(writer.epoch)),
        (made.writer, made.epoch)
    );
    assert_eq!(writer.last_queued_sequence, Some(3));
    assert_eq!(writer.last_sent_sequence, Some(1));
    assert_eq!(writer.last_delivered_sequence, Some(0));
    let range =
        |first_sequence, last_sequence| ::ledger::Sequences { first_sequence, last_sequence };
    assert_eq!(writer.in_flight, [range(1, 1)]);
    assert_eq!(writer.taken_back, [range(2, 3)]);
    assert_eq!((found.arrived_since, found.open), (0, 1));
}

/// The partner learns the decision, and the gap of the reports that will never come.
async fn assert_partner_is_notified(running: &Running) {
    let messages: Vec<Value> = running
        .fetch(Lane::Control)
        .await
        .iter()
        .map(|row| serde_json::from_slice(&row.envelope.body).expect("JSON"))
        .collect();
    assert!(messages.iter().any(
        |message| message["messageType"] == "decision" && message["mappingState"] == "PENDING"
    ));
    let gap = messages.iter().find(|message| message["messageType"] == "gap").expect("a gap");
    assert_eq!(gap["firstSequence"], json!(2));
    assert_eq!(gap["lastSequence"], json!(3));
    assert_eq!(gap["cause"], json!("REVOKED"));
}

/// The recipients get what the receipt says about their request, signed with the ledger's key and
/// without the user's name.
async fn assert_receipt_for_partners(running: &Running, id: &str) {
    let rows = running.fetch(Lane::Control).await;
    let sent = rows.iter().filter(|row| row.envelope.subject == "revocation");
    let sent: Vec<Value> =
        sent.map(|row| serde_json::from_slice(&row.envelope.body).expect("JSON")).collect();
    let [message] = &sent[..] else { panic!("{sent:?}") };
    assert_eq!(message["recipientList"], json!(["acme", "hull"]));
    assert_eq!(message["dynamicDataRequestId"], "R1");
    let stored = running.session().await.revocations().lookup(id).await.expect("read");
    let key = hex::decode(stored.expect("a receipt").public_key).expect("hexadecimal");
    let key: ::ledger::Hash = key.try_into().expect("a key");
    let signature = hex::decode(message["signature"].as_str().expect("a text")).expect("hex");
    let text = message["signedText"].as_str().expect("a text");
    let receipt = ::ledger::RevocationReceipt::verified(text, &signature, &key).expect("signed");
    assert_eq!((receipt.revocation_id.as_str(), receipt.revoked_by), (id, None));
    assert_eq!((receipt.fields.len(), receipt.writers.len()), (1, 1));
    assert_eq!(receipt.writers[0].last_delivered_sequence, Some(0));
}

/// A report that the broker accepts at the moment of its revocation has left, and the ledger
/// records both.
#[tokio::test]
async fn a_report_that_leaves_while_it_is_taken_back_is_recorded() {
    let running = Running::with_two_open_fields().await;
    running.enter_both(1).await;
    let rows = running.fetch(Lane::Reports).await;
    assert!(rows.iter().all(|row| running.spool.may_leave(row)), "on the wire");
    running.revoke(None).await;
    let accepted = rows.iter().map(|row| RowOutcome {
        id: row.id,
        outcome: SendOutcome::Accepted,
        at: OffsetDateTime::now_utc(),
    });
    running.spool.record(accepted.collect()).await.expect("recorded");
    let made = reports(&rows[0]).into_iter().next().expect("a report");
    running.receipt(&made, 0).await;
    let entries = running.entries("acme").await;
    let of = |event: &str| {
        entries
            .iter()
            .filter(|entry| {
                entry["event"] == event && entry["dataSetWriterId"] == json!(made.writer)
            })
            .count()
    };
    assert_eq!(of("PURGED"), 1, "{entries:?}");
    assert_eq!(of("SENT"), 1, "{entries:?}");
    assert_eq!(of("RECEIPTED"), 1, "{entries:?}");
    running.close().await;
}

/// A withdrawal by the partner ends consents too.
#[tokio::test]
async fn a_withdrawal_yields_a_receipt() {
    let running = Running::with_two_open_fields().await;
    running.enter_both(1).await;
    let withdraw = json!({ "messageType": "withdraw", "messageId": new_message_id(), "factoryId": "F",
        "operationNetworkId": "n", "revision": 2 });
    running.receive("withdraw", withdraw).await;
    let all = running.session().await.revocations().page(None, 10).await.expect("read");
    let [found] = &all[..] else { panic!("{all:?}") };
    assert_eq!((found.receipt.fields.len(), found.receipt.writers.len()), (2, 2));
    assert_eq!(found.receipt.revoked_by, None);
    assert!(found.receipt.writers.iter().all(|writer| writer.recipient_list.len() == 2));
    assert_eq!(running.fetch(Lane::Reports).await.len(), 0);
    running.close().await;
}
