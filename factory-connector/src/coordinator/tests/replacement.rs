//! Consents that are replaced: what waited under the former one leaves only if the new one allows it.

use super::*;
use crate::store::Ledger;

fn map(value_source: ValueSource, policy: &str) -> DecisionCommand {
    let policy = serde_json::from_str(policy).expect("a policy");
    DecisionCommand::Map { value_source, mapping: None, policy }
}

impl Running {
    async fn decide_made(&self, value_source: ValueSource, policy: &str) {
        decide_field(&self.coordinator, field("made"), map(value_source, policy)).await;
    }

    /// Returns the reports that the link would fetch and may send, as JSON.
    async fn would_leave(&self) -> Vec<Value> {
        let rows = self.fetch(Lane::Reports).await;
        let rows = rows.iter().filter(|row| self.spool.may_leave(row));
        let messages = rows.map(|row| serde_json::from_slice::<Value>(&row.envelope.body));
        let messages: Vec<Value> = messages.map(|message| message.expect("JSON")).collect();
        let reports = messages.iter().filter_map(|message| message["Messages"].as_array());
        reports.flatten().cloned().collect()
    }

    async fn restarted(self) -> Self {
        let folder = self.close().await;
        Self::open_in(folder.path().to_owned(), Some(folder)).await
    }

    async fn gaps(&self) -> Vec<Value> {
        let rows = self.fetch(Lane::Control).await;
        let messages = rows.iter().map(|row| serde_json::from_slice::<Value>(&row.envelope.body));
        let messages = messages.map(|message| message.expect("JSON"));
        messages.filter(|message| message["messageType"] == "gap").collect()
    }
}

/// Values of a field in reports, as texts.
fn values_of(reports: &[Value], name: &str) -> Vec<String> {
    let bodies = reports.iter().filter_map(|report| report["Payload"][name]["Body"].as_str());
    bodies.map(str::to_owned).collect()
}

#[tokio::test]
async fn a_stricter_policy_takes_back_what_waits_under_the_former_one() {
    let running = Running::with_two_open_fields().await;
    running.enter_both(4711).await;
    let fetched = running.fetch(Lane::Reports).await;
    running.enter_both(4712).await;
    let epoch = reports(&fetched[0])[0].epoch;

    running.decide_made(ValueSource::Manual, r#"{"roundingStep":1000}"#).await;

    assert_eq!(running.accept(&fetched).await, 0, "fetched before, but it does not leave any more");
    let left = running.would_leave().await;
    assert_eq!(values_of(&left, "made"), ["5000"]);
    assert_eq!(values_of(&left, "note"), ["note 4711", "note 4712"], "another request's");
    let report = left.iter().find(|report| report["Payload"]["made"].is_object());
    let report = report.expect("the newest value as the policy allows it");
    assert_eq!(report["MetaDataVersion"]["MajorVersion"], json!(epoch), "the consent goes on");
    assert_eq!(report["SequenceNumber"], json!(2));
    // Nothing is lost without a word: the partner is told which numbers never come, and the ledger
    // of each recipient says so.
    let gaps = running.gaps().await;
    let [gap] = &gaps[..] else { panic!("{gaps:?}") };
    let numbers = (&gap["firstSequence"], &gap["lastSequence"], &gap["cause"]);
    assert_eq!(numbers, (&json!(0), &json!(1), &json!("REVOKED")));
    for recipient in ["acme", "hull"] {
        let entries = running.entries(recipient).await;
        let purged: Vec<_> = entries.iter().filter(|entry| entry["event"] == "PURGED").collect();
        assert_eq!(purged.len(), 1, "{entries:?}");
        assert_eq!(
            (&purged[0]["firstSequence"], &purged[0]["lastSequence"]),
            (&json!(0), &json!(1))
        );
        assert!(entries.iter().all(|entry| entry["event"] != "REVOKED"), "no consent ended");
    }
    let folder = running.close().await;
    let outcome = Ledger(&mut connect(folder.path()).await).verify(None).await.expect("read");
    assert!(outcome.is_intact(), "{outcome:?}");
}

#[tokio::test]
async fn what_waits_over_a_restart_is_taken_back_by_a_stricter_policy_for_its_recipient() {
    let running = Running::with_two_open_fields().await;
    running.enter_both(4711).await;
    let running = running.restarted().await;
    assert_eq!(values_of(&running.would_leave().await, "made"), ["4711"], "it waits still");
    let coarse: disclosure::DocumentId = "coarse".parse().expect("an id");
    let policy = json!({ "name": "n", "disclosure": { "roundingStep": 1000 } });
    let policy = serde_json::from_value(policy).expect("a policy");
    let id = coarse.clone();
    let put = running.coordinator.execute(move |state, now| {
        connector_state::use_cases::policies::put_policy(state, &id, policy, None, "eve", now)
    });
    put.await.expect("written").expect("stored");
    let hull = "hull".parse().expect("an id");
    let set = running.coordinator.execute(move |state, now| {
        use connector_state::use_cases::policies::set_recipient_policy;
        set_recipient_policy(state, &hull, Some(coarse), None, "eve", now)
    });
    set.await.expect("written").expect("set");
    assert_eq!(values_of(&running.would_leave().await, "made"), ["5000"]);
    let running = running.restarted().await;
    assert_eq!(values_of(&running.would_leave().await, "made"), ["5000"]);
    assert_eq!(running.gaps().await.len(), 1, "no step concerns a text");
    running.close().await;
}

/// The newest value may not come earlier, either.
#[tokio::test]
async fn a_policy_that_delays_holds_back_what_waits() {
    let running = Running::with_two_open_fields().await;
    running.enter_both(4711).await;
    running.decide_made(ValueSource::Manual, r#"{"delayMs":3600000}"#).await;
    assert_eq!(values_of(&running.would_leave().await, "made"), [""; 0]);
    running.enter_both(4712).await;
    let running = running.restarted().await;
    assert_eq!(values_of(&running.would_leave().await, "made"), [""; 0]);
    running.close().await;
}

#[tokio::test]
async fn another_source_takes_back_what_waits_of_the_former_one() {
    let running = Running::with_two_open_fields().await;
    running.enter_both(4711).await;
    running.decide_made(ValueSource::External, "{}").await;
    let left = running.would_leave().await;
    assert_eq!(values_of(&left, "made"), [""; 0]);
    assert_eq!(values_of(&left, "note"), ["note 4711"]);
    running.close().await;
}

#[tokio::test]
async fn a_looser_policy_takes_nothing_back() {
    let running = Running::with_two_open_fields().await;
    running.decide_made(ValueSource::Manual, r#"{"roundingStep":1000}"#).await;
    running.enter_both(4711).await;
    running.decide_made(ValueSource::Manual, r#"{"roundingStep":10}"#).await;
    running.enter_both(4712).await;
    let left = running.would_leave().await;
    assert_eq!(values_of(&left, "made").last().map(String::as_str), Some("4710"));
    assert!(values_of(&left, "made").contains(&"5000".to_owned()), "{left:?}");
    assert!(running.gaps().await.is_empty());
    running.close().await;
}

/// A report that was sent and not receipted is not sent again.
#[tokio::test]
async fn a_report_that_was_lost_on_its_way_does_not_come_again_under_a_stricter_policy() {
    let running = Running::with_two_open_fields().await;
    running.enter_both(4711).await;
    let rows = running.fetch(Lane::Reports).await;
    assert_eq!(running.accept(&rows).await, 1);
    let lost = reports(&rows[0]).into_iter().next().expect("a report");
    running.decide_made(ValueSource::Manual, r#"{"roundingStep":1000}"#).await;
    let rows = running.fetch(Lane::Reports).await;
    running.accept(&rows).await;
    // Long ago: it is not on its way any more.
    sqlx::query("UPDATE report SET sent_at = sent_at - 60000000 WHERE state = 'SENT'")
        .execute(&mut connect(&running.folder).await)
        .await
        .expect("written");
    running.receipt_without(&lost, 1, &[0]).await;
    assert_eq!(values_of(&running.would_leave().await, "made"), [""; 0]);
    let gaps = running.gaps().await;
    assert_eq!(gaps.len(), 1, "{gaps:?}");
    assert_eq!(gaps[0]["lastSequence"], json!(0));
    running.close().await;
}
