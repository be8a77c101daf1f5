//! The past of a request, from the store to the ledger and the platform.

use connector_state::{
    past::{Past, PastOffer},
    queries::past_offer,
    use_cases::decide_past::{PastDecisionError, PastDecisionRequest, decide_past},
};

use super::*;
use crate::store::Ledger;

fn spy() -> asi_model::OrganisationId {
    "spy".parse().expect("an id")
}

/// The network with one more recipient of both requests.
fn network_with_spy(revision: u64) -> Value {
    let mut network = network(revision);
    let requests = &mut network["operationNetwork"]["operationList"][0]["dynamicDataRequestList"];
    for request in requests.as_array_mut().expect("requests") {
        request["recipientList"] = json!(["acme", "hull", "spy"]);
    }
    network
}

/// Sends two reports of each data set, leaves a third waiting, and then opens both to one more
/// recipient. Returns what was sent of the field "made".
async fn with_a_past() -> (Running, Vec<Report>) {
    let running = Running::with_two_open_fields().await;
    let mut sent = Vec::new();
    for number in 1..=2 {
        running.enter_both(number).await;
        let rows = running.fetch(Lane::Reports).await;
        assert_eq!(running.accept(&rows).await, 1);
        sent.push(reports(&rows[0]).into_iter().next().expect("a report"));
    }
    running.enter_both(3).await;
    running.receive("operation-network", network_with_spy(2)).await;
    assert_eq!(running.offer().await.1, None, "nothing is open to the recipient yet");
    running.open_fields().await;
    (running, sent)
}

impl Running {
    /// Reads the past of "made" for the recipient that was added, with what is offered of it.
    async fn offer(&self) -> (Past, Option<PastOffer>) {
        let request = field("made").request;
        let after = self
            .coordinator
            .read({
                let request = request.clone();
                move |state| state.past().decided_through(&request, &spy())
            })
            .await
            .expect("running")
            .unwrap_or_default();
        let mut session = self.session().await;
        let past = session.past_reports().of(&request, &spy(), after).await.expect("read");
        let offered = self.coordinator.read(move |state| (past_offer(state, &past), past)).await;
        let (offer, past) = offered.expect("running");
        (past, offer)
    }

    async fn decide_past(&self, is_released: bool) -> Result<(), PastDecisionError> {
        let (past, offer) = self.offer().await;
        let request = PastDecisionRequest {
            past,
            is_released,
            root: offer.map(|offer| offer.root).unwrap_or_default(),
            reason: None,
            decided_by: "eve".to_owned(),
        };
        let decided =
            self.coordinator.execute(move |state, now| decide_past(state, request, now)).await;
        decided.expect("written").map(drop)
    }

    async fn past_releases(&self) -> Vec<Value> {
        let rows = self.fetch(Lane::Control).await;
        let messages = rows.iter().map(|row| serde_json::from_slice(&row.envelope.body));
        let messages: Vec<Value> = messages.map(|message| message.expect("JSON")).collect();
        messages.into_iter().filter(|message| message["messageType"] == "past-release").collect()
    }
}

/// Entries of a kind in a recipient's chain.
async fn of_kind(running: &Running, recipient: &str, kind: &str) -> Vec<Value> {
    let entries = running.entries(recipient).await;
    entries.into_iter().filter(|entry| entry["event"] == kind).collect()
}

#[tokio::test]
async fn what_left_for_others_is_shown_once_by_a_decision_and_survives_a_restart() {
    let (running, sent) = with_a_past().await;
    let epochs = running.session().await.past_reports().epochs().await.expect("read");
    let request = field("made").request;
    assert!(epochs.iter().any(|epoch| epoch.request == request
        && epoch.recipients.iter().map(|id| id.as_str()).eq(["acme", "hull"])));
    let (_, offer) = running.offer().await;
    let offer = offer.expect("an offer");
    let bodies = running.session().await.past_reports().bodies(&offer.newest).await.expect("read");
    assert_eq!(bodies.len(), 2, "what waited was taken back and never left");
    assert!(bodies[1].contains(r#""made":{"Type":9,"Body":"2"}"#), "{bodies:?}");
    assert_eq!(of_kind(&running, "spy", "QUEUED").await, Vec::<Value>::new());

    running.decide_past(true).await.expect("decided");
    let [release] = &running.past_releases().await[..] else { panic!("one message") };
    assert_eq!(
        (&release["recipientId"], &release["rangeList"]),
        (
            &json!("spy"),
            &json!([{ "dataSetWriterId": sent[0].writer, "epoch": sent[0].epoch,
                "firstSequence": sent[0].sequence, "lastSequence": sent[1].sequence }])
        )
    );
    let [entry] = &of_kind(&running, "spy", "PAST_RELEASED").await[..] else { panic!("one entry") };
    assert_eq!((&entry["firstSequence"], &entry["lastSequence"]), (&json!(0), &json!(1)));
    assert_eq!(entry["decidedBy"], "eve");
    assert_eq!(of_kind(&running, "hull", "PAST_RELEASED").await, Vec::<Value>::new());
    let decisions = running.session().await.past_decisions().page(i64::MAX, 9).await.expect("read");
    let [decision] = &decisions[..] else { panic!("{decisions:?}") };
    assert_eq!((decision.is_released, decision.report_count), (true, 2));
    assert_eq!(decision.root.as_deref(), entry["values"].as_str());
    assert_eq!(running.offer().await.1, None);

    let folder = running.close().await;
    let outcome = Ledger(&mut connect(folder.path()).await).verify(None).await.expect("read");
    assert!(outcome.is_intact(), "{outcome:?}");
    let running = Running::open_in(folder.path().to_owned(), Some(folder)).await;
    assert_eq!(running.offer().await.1, None, "it is not asked again");
    assert_eq!(running.decide_past(true).await, Err(PastDecisionError::NoPast));
    assert_eq!(running.past_releases().await.len(), 1, "the message waits for the link");
    running.close().await;
}

#[tokio::test]
async fn a_past_that_was_refused_stays_hidden_after_a_restart() {
    let (running, _) = with_a_past().await;
    running.decide_past(false).await.expect("decided");
    assert_eq!(running.past_releases().await, Vec::<Value>::new());
    assert_eq!(of_kind(&running, "spy", "PAST_RELEASED").await, Vec::<Value>::new());
    let folder = running.close().await;
    let running = Running::open_in(folder.path().to_owned(), Some(folder)).await;
    assert_eq!(running.offer().await.1, None);
    running.close().await;
}

/// An offer ends with the consent, and what was shown is not shown again.
#[tokio::test]
async fn a_revocation_ends_the_offer_and_follows_a_release() {
    let (running, _) = with_a_past().await;
    running.revoke(None).await;
    assert_eq!(running.offer().await.1, None, "nothing is open");
    assert_eq!(running.decide_past(true).await, Err(PastDecisionError::NoPast));
    running.open_fields().await;
    running.decide_past(true).await.expect("decided");
    running.enter_both(4).await;
    running.revoke(Some("Enough.")).await;
    let kinds: Vec<Value> =
        running.entries("spy").await.iter().map(|entry| entry["event"].clone()).collect();
    let place = |kind: &str| kinds.iter().rposition(|found| found == kind);
    assert!(place("PAST_RELEASED") < place("REVOKED"), "{kinds:?}");
    let folder = running.close().await;
    let outcome = Ledger(&mut connect(folder.path()).await).verify(None).await.expect("read");
    assert!(outcome.is_intact(), "{outcome:?}");
}
