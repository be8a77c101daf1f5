//! The past of a request: what is offered to a recipient that is added, and the decision about it.

use std::collections::BTreeMap;

use asi_model::{FieldName, OrganisationId, messages::ValueSource};
use disclosure::DisclosurePolicy;
use ledger::{Event, Hash, LedgerEntry, past_root};
use serde_json::{Value, json};

use crate::{
    Writes,
    past::{Past, PastOffer, PastReport},
    queries::past_offer,
    scene::{Scene, at, field, network},
    use_cases::decide_past::{PastDecisionError, PastDecisionRequest, decide_past},
};

fn spy() -> OrganisationId {
    "spy".parse().expect("an id")
}

/// Reports as a store has them once they were sent.
#[derive(Default)]
struct Sent {
    reports: Vec<PastReport>,
    policies: BTreeMap<(FieldName, u32), DisclosurePolicy>,
}

impl Sent {
    fn write(&mut self, writes: &Writes) {
        for consent in &writes.fields.consents {
            let name = consent.field.rsplit('/').next().expect("a name").parse().expect("a name");
            let policy = serde_json::from_str(&consent.policy).expect("a policy");
            self.policies.insert((name, consent.version), policy);
        }
        for report in &writes.reports.queued {
            let entry = writes.ledger.entries.iter().find(|(_, id)| *id == Some(report.id));
            let entry: LedgerEntry =
                serde_json::from_str(&entry.expect("an entry").0.content).expect("JSON");
            let Event::Queued { values, consents, .. } = entry.event else {
                panic!("another entry")
            };
            let values = hex::decode(values).expect("hexadecimal").try_into().expect("a hash");
            self.reports.push(PastReport {
                id: report.id,
                data_set_writer_id: report.data_set_writer_id,
                epoch: report.epoch,
                sequence: report.sequence,
                created_at: report.created_at,
                values,
                consents: consents.into(),
            });
        }
    }

    fn past(&self) -> Past {
        Past {
            request: field("made").request,
            recipient: spy(),
            reports: self.reports.clone(),
            policies: self.policies.clone(),
        }
    }
}

/// A request that reported for others, each value under its policy, and then was opened to `spy`
/// under the last policy.
struct Opened {
    scene: Scene,
    sent: Sent,
}

impl Opened {
    fn after(formers: &[&str], present: &str) -> Self {
        let mut scene = Scene::default();
        let mut sent = Sent::default();
        let mut ms = 0;
        for former in formers {
            scene.map("made", ValueSource::Manual, former);
            for _ in 0..2 {
                ms += 10;
                // Coarse enough that every policy of these tests lets it out as another value.
                let value = u64::try_from(ms * 1000).expect("positive");
                scene.candidate("made", ValueSource::Manual, value, ms);
                sent.write(&scene.commit(ms).0);
            }
        }
        scene.arrive(network(2, with_spy));
        scene.commit(ms);
        let mut opened = Self { scene, sent };
        assert_eq!(opened.offer(), None, "nothing is asked before a field is open");
        opened.scene.map("made", ValueSource::Manual, present);
        opened.scene.commit(ms);
        opened
    }

    fn offer(&self) -> Option<PastOffer> {
        past_offer(&self.scene.state, &self.sent.past())
    }

    fn decide(&mut self, is_released: bool, root: Hash) -> Result<Writes, PastDecisionError> {
        let request = PastDecisionRequest {
            past: self.sent.past(),
            is_released,
            root,
            reason: Some("They ask.".to_owned()),
            decided_by: "eve".to_owned(),
        };
        self.scene.attempt(|state| decide_past(state, request, at(1000)))?;
        Ok(self.scene.commit(1000).0)
    }
}

fn with_spy(request: &mut Value) {
    request["recipientList"] = json!(["acme", "hull", "spy"]);
}

fn messages(writes: &Writes) -> Vec<Value> {
    let rows = writes.controls.queued.iter().filter(|row| row.subject == "past-release");
    rows.map(|row| serde_json::from_str(&row.body).expect("JSON")).collect()
}

#[test]
fn the_past_is_shown_by_one_decision_with_its_own_entries() {
    let mut opened = Opened::after(&["{}"], "{}");
    let offer = opened.offer().expect("an offer");
    let roots: Vec<Hash> = opened.sent.reports.iter().map(|report| report.values).collect();
    let [part] = &offer.parts[..] else { panic!("{offer:?}") };
    assert_eq!(part.report_count, 2);
    assert_eq!((part.from, part.until), (at(10), at(20)));
    assert_eq!((offer.report_count, offer.root), (2, past_root(roots)));
    assert_eq!(offer.newest, [opened.sent.reports[0].id, opened.sent.reports[1].id]);

    assert_eq!(opened.decide(true, [0; 32]), Err(PastDecisionError::OfferChanged));
    let writes = opened.decide(true, offer.root).expect("decided");
    let [(entry, None)] = &writes.ledger.entries[..] else { panic!("{:?}", writes.ledger) };
    assert_eq!(entry.recipient, spy());
    let entry: Value = serde_json::from_str(&entry.content).expect("JSON");
    let first = &opened.sent.reports[0];
    assert_eq!((&entry["event"], &entry["epoch"]), (&json!("PAST_RELEASED"), &json!(first.epoch)));
    assert_eq!((&entry["firstSequence"], &entry["lastSequence"]), (&json!(0), &json!(1)));
    assert_eq!(entry["values"], hex::encode(offer.root));
    assert_eq!((&entry["decidedBy"], &entry["reason"]), (&json!("eve"), &json!("They ask.")));
    assert_eq!(writes.ledger.heads.len(), 1, "the chain's head is signed with it");
    let [message] = &messages(&writes)[..] else { panic!("{:?}", writes.controls) };
    assert_eq!(
        (&message["recipientId"], &message["dynamicDataRequestId"]),
        (&json!("spy"), &json!("R1"))
    );
    assert_eq!(
        message["rangeList"],
        json!([{ "dataSetWriterId": first.data_set_writer_id, "epoch": first.epoch,
            "firstSequence": 0, "lastSequence": 1 }])
    );
    let [row] = &writes.ledger.past_decisions[..] else { panic!("{:?}", writes.ledger) };
    assert_eq!((row.is_released, row.report_count), (true, 2));
    assert_eq!(row.decided_by, "eve");

    assert_eq!(opened.offer(), None, "it is asked once");
    assert_eq!(opened.decide(false, offer.root), Err(PastDecisionError::NoPast));
}

#[test]
fn a_past_that_stays_hidden_leaves_no_entry_and_no_message() {
    let mut opened = Opened::after(&["{}"], "{}");
    let root = opened.offer().expect("an offer").root;
    let writes = opened.decide(false, root).expect("decided");
    assert!(writes.ledger.entries.is_empty() && messages(&writes).is_empty(), "{writes:?}");
    let [row] = &writes.ledger.past_decisions[..] else { panic!("{:?}", writes.ledger) };
    assert_eq!((row.is_released, row.report_count), (false, 0));
    assert_eq!(row.root, None);
    assert_eq!(opened.decide(true, root), Err(PastDecisionError::NoPast));
}

/// Reports that left under a looser policy stay with those for whom they left.
#[test]
fn only_what_satisfies_the_present_policy_is_offered() {
    let formers = ["{}", r#"{"roundingStep":10}"#, r#"{"roundingStep":1000}"#];
    let mut opened = Opened::after(&formers, r#"{"roundingStep":10}"#);
    let offer = opened.offer().expect("an offer");
    let offered: Vec<bool> = offer.parts.iter().map(crate::past::PastPart::is_offered).collect();
    assert_eq!(offered, [false, true, true], "{offer:?}");
    assert_eq!(offer.parts[0].looser_fields, [field("made").field_name]);
    let shown: u64 = offer.parts[1..].iter().map(|part| part.report_count).sum();
    assert_eq!(offer.report_count, shown);
    let writes = opened.decide(true, offer.root).expect("decided");
    let epochs: Vec<u32> = opened.sent.reports.iter().map(|report| report.epoch).collect();
    let named = |epoch: &u32, sequence: u32| {
        messages(&writes).iter().any(|message| {
            message["rangeList"].as_array().expect("ranges").iter().any(|range| {
                range["epoch"] == *epoch
                    && range["firstSequence"].as_u64() <= Some(u64::from(sequence))
                    && range["lastSequence"].as_u64() >= Some(u64::from(sequence))
            })
        })
    };
    for (report, epoch) in opened.sent.reports.iter().zip(&epochs) {
        let is_looser = report.consents == offer.parts[0].consents;
        assert_eq!(named(epoch, report.sequence), !is_looser, "{report:?}");
    }

    let mut opened = Opened::after(&["{}"], r#"{"roundingStep":10}"#);
    let offer = opened.offer().expect("an offer");
    assert!(offer.ranges.is_empty(), "{offer:?}");
    assert_eq!(opened.decide(true, offer.root), Err(PastDecisionError::NothingToShow));
    opened.decide(false, offer.root).expect("it can be put away");
}

/// A policy that is tightened between the look and the decision counts.
#[test]
fn a_decision_is_about_what_the_person_saw() {
    let mut opened = Opened::after(&["{}"], "{}");
    let root = opened.offer().expect("an offer").root;
    opened.scene.map("made", ValueSource::Manual, r#"{"roundingStep":10}"#);
    opened.scene.commit(900);
    assert_eq!(opened.decide(true, root), Err(PastDecisionError::OfferChanged));
}

#[test]
fn reports_with_a_field_that_is_closed_are_not_offered() {
    let mut scene = Scene::default();
    let mut sent = Sent::default();
    scene.map("made", ValueSource::Manual, "{}");
    scene.map("note", ValueSource::Manual, "{}");
    scene.candidate("made", ValueSource::Manual, 7_u64, 1);
    sent.write(&scene.commit(1).0);
    scene.candidate("note", ValueSource::Manual, asi_model::Variant::from("a note"), 2);
    sent.write(&scene.commit(2).0);
    scene.arrive(network(2, with_spy));
    scene.commit(3);
    scene.map("made", ValueSource::Manual, "{}");
    scene.commit(3);
    let offer = past_offer(&scene.state, &sent.past()).expect("an offer");
    let [made, both] = &offer.parts[..] else { panic!("{offer:?}") };
    assert!(made.is_offered() && !both.is_offered(), "{offer:?}");
    assert_eq!(both.closed_fields, [field("note").field_name]);
    assert_eq!(offer.report_count, 1);
    let others = Past { recipient: "stranger".parse().expect("an id"), ..sent.past() };
    assert_eq!(past_offer(&scene.state, &others), None, "it is no recipient");
}
