//! Restarts: what is loaded is what was stored, and what was in effect.

use std::collections::BTreeMap;

use asi_model::{DataValue, Variant, messages::ValueSource};
use disclosure::Versioned;
use ledger::{Head, Heads};
use serde_json::json;

use crate::{
    ConnectorState, IdSource, RecipientPolicy, Snapshot, StateConfig, StoredLedger, StoredNetwork,
    StoredPolicies, Writes,
    scene::{Scene, at, decision, field, network},
    use_cases::{
        decide::{DecisionCommand, DecisionRequest},
        policies::{put_policy, set_recipient_policy},
        values::{
            FieldCandidate, TakenCandidate, know_again, receive_candidates, release_due, take_again,
        },
    },
    writes::{DocumentRow, FieldRow, FieldValueRow, WriterRow},
};

/// Rows as a store has them after some transactions.
#[derive(Default)]
struct Stored {
    networks: BTreeMap<String, StoredNetwork>,
    fields: BTreeMap<i64, (FieldRow, Option<FieldValueRow>)>,
    writers: BTreeMap<u16, WriterRow>,
    heads: BTreeMap<asi_model::OrganisationId, Head>,
    named: BTreeMap<String, DocumentRow>,
    recipients: BTreeMap<asi_model::OrganisationId, RecipientPolicy>,
    past: Vec<(asi_model::RequestKey, asi_model::OrganisationId, i64)>,
}

impl Stored {
    fn write(&mut self, writes: Writes) {
        for row in writes.networks {
            let message = row.message.map(|json| serde_json::from_str(&json).expect("a network"));
            let stored = StoredNetwork {
                operation_network_id: row.operation_network_id.clone(),
                revision: row.revision,
                message,
                received_at: row.received_at,
            };
            self.networks.insert(row.operation_network_id.to_string(), stored);
        }
        for (id, row) in writes.fields.decided {
            let (stored, _) = self.fields.entry(id).or_insert_with(|| (row.clone(), None));
            *stored = row;
        }
        for (id, row) in writes.fields.values {
            self.fields.get_mut(&id).expect("a field").1 = Some(row);
        }
        for id in writes.fields.removed {
            self.fields.remove(&id);
        }
        self.writers.extend(writes.writers.changed);
        for (entry, _) in writes.ledger.entries {
            self.heads.insert(entry.recipient, Head { number: entry.number, hash: entry.hash });
        }
        let named = writes.policies.named.into_iter();
        self.named.extend(named.map(|row| (row.key.id.as_str().to_owned(), row)));
        let past = writes.ledger.past_decisions.into_iter();
        self.past.extend(past.map(|row| (row.request, row.recipient, row.through_report)));
        let recipients = writes.policies.recipients.into_iter();
        self.recipients.extend(recipients.map(|row| (row.recipient, row.set)));
    }

    fn load(&self, ms: i64) -> Scene {
        let named = self.named.values().cloned().map(|row| Versioned {
            key: row.key,
            document: serde_json::from_str(&row.document).expect("a policy"),
            changed_by: row.changed_by,
            changed_at: row.changed_at,
        });
        let snapshot = Snapshot {
            networks: self.networks.values().cloned().collect(),
            fields: self.fields.values().cloned().collect(),
            writers: self.writers.clone().into_iter().collect(),
            ledger: StoredLedger {
                heads: Heads::new(self.heads.clone()),
                past_decisions: self.past.clone(),
                ..StoredLedger::default()
            },
            policies: StoredPolicies {
                named: named.collect(),
                recipients: self.recipients.clone().into_iter().collect(),
                ..StoredPolicies::default()
            },
            ..Snapshot::default()
        };
        let config = StateConfig {
            factory_id: "F".parse().expect("an id"),
            encoding: asi_model::pubsub::json::Encoding::Digicor,
        };
        let (state, pending) =
            ConnectorState::load(config, snapshot, IdSource::new([8; 32]), false, at(ms))
                .expect("it can be read");
        Scene { state, pending }
    }
}

/// Everything that a restart must bring back, as text.
fn description(state: &ConnectorState) -> String {
    let mut fields: Vec<_> = state.fields().iter().collect();
    fields.sort_by_key(|field| field.id());
    let fields: Vec<_> = fields
        .iter()
        .map(|field| {
            let in_force = Some(field.gate().policy()).filter(|_| field.decision().is_mapped());
            (field.row(), field.value_row(), in_force, field.gate().due())
        })
        .collect();
    let mut active: Vec<u16> = state.writers().active().collect();
    active.sort_unstable();
    let writers: Vec<_> =
        active.iter().map(|id| state.writers().get(*id).map(crate::Writer::row)).collect();
    format!("{fields:#?}\n{writers:#?}\n{:#?}", state.ledger().heads())
}

#[test]
fn a_restart_brings_the_same_state_back() {
    let (mut scene, mut stored) = (Scene::default(), Stored::default());
    let mut check = |scene: &mut Scene, ms: i64| {
        stored.write(scene.commit(ms).0);
        let loaded = stored.load(ms);
        assert_eq!(description(&loaded.state), description(&scene.state));
        assert_eq!(loaded.state.fields().next_deadline(), scene.state.fields().next_deadline());
        assert!(loaded.pending.is_urgent(), "what is shown and run again does not wait");
    };
    check(&mut scene, 0);
    let policy = |step: u32| {
        let json = json!({ "name": "n", "disclosure": { "roundingStep": step } });
        serde_json::from_value(json).expect("a policy")
    };
    let coarse: disclosure::DocumentId = "coarse".parse().expect("an id");
    scene
        .attempt(|state| put_policy(state, &coarse, policy(100), None, "eve", at(1)))
        .expect("stored");
    scene.map("made", ValueSource::Manual, r#"{"roundingStep":10,"delayMs":1000}"#);
    scene.map("note", ValueSource::Manual, "{}");
    scene.candidate("made", ValueSource::Manual, 149_u64, 2);
    scene.candidate("note", ValueSource::Manual, "a", 2);
    check(&mut scene, 2);
    let (hull, set) = ("hull".parse().expect("an id"), Some(coarse.clone()));
    scene
        .attempt(|state| set_recipient_policy(state, &hull, set, None, "eve", at(3)))
        .expect("set");
    check(&mut scene, 3);
    release_due(&mut scene.state, at(1002));
    check(&mut scene, 1002);
    let refusal =
        DecisionRequest { reason: Some("no".to_owned()), ..decision(DecisionCommand::Refuse) };
    scene.decide("note", refusal, 1003).expect("refused");
    scene
        .attempt(|state| put_policy(state, &coarse, policy(1000), None, "eve", at(1004)))
        .expect("stored");
    check(&mut scene, 1004);
    scene.arrive(network(2, |request| {
        request["recipientList"] = json!(["acme"]);
        request["reportDataFormat"]["reportFieldList"].as_array_mut().expect("fields").pop();
    }));
    check(&mut scene, 1005);
}

/// A machine's state is unknown after a restart: it must not let a value out that fell due while
/// nobody looked, neither to the partner nor to the nodes.
#[test]
fn a_state_from_before_a_restart_releases_nothing() {
    let (mut scene, mut stored) = (Scene::default(), Stored::default());
    scene.map("note", ValueSource::Mapping, "{}");
    let policy = r#"{"delayMs":1000,"withholdWhile":[{"field":"note","states":["SETUP"]}]}"#;
    scene.map("made", ValueSource::Manual, policy);
    scene.candidate("note", ValueSource::Mapping, "RUN", 1);
    scene.candidate("made", ValueSource::Manual, 7_u64, 2);
    stored.write(scene.commit(3).0);
    let mut scene = stored.load(5000);
    release_due(&mut scene.state, at(5000));
    let disclosed = |scene: &Scene| {
        let field = scene.state.field(&field("made")).expect("a field");
        field.gate().disclosed().is_some()
    };
    assert!(!disclosed(&scene), "the state is unknown");
    let reported = |scene: &mut Scene, ms| {
        let (writes, _) = scene.commit(ms);
        writes.reports.queued.iter().any(|report| report.body.contains("\"made\""))
    };
    assert!(!reported(&mut scene, 5001));
    scene.candidate("note", ValueSource::Mapping, "RUN", 5002);
    assert!(disclosed(&scene) && reported(&mut scene, 5003), "it is known again");
}

/// Offers values of machines one after the other, and returns them as they were taken.
fn take(scene: &mut Scene, values: &[(&str, Variant)], ms: i64) -> Vec<TakenCandidate> {
    let mut taken = Vec::new();
    for (name, value) in values {
        let candidate = FieldCandidate {
            field: scene.state.field(&field(name)).expect("a field").id(),
            source: ValueSource::Mapping,
            mapping_version: None,
            value: DataValue::good(value.clone(), at(ms)),
            transform: None,
        };
        let outcomes = receive_candidates(&mut scene.state, vec![candidate.clone()], at(ms));
        taken.extend(TakenCandidate::all_of(vec![candidate], outcomes));
    }
    taken
}

#[test]
fn what_a_failed_transaction_took_is_taken_again_and_what_it_withheld_stays_withheld() {
    for last in [None, Some(8_u64)] {
        let (mut scene, mut stored) = (Scene::default(), Stored::default());
        scene.map("note", ValueSource::Mapping, "{}");
        let policy = r#"{"withholdWhile":[{"field":"note","states":["SETUP"]}]}"#;
        scene.map("made", ValueSource::Mapping, policy);
        take(&mut scene, &[("note", "SETUP".into())], 1);
        stored.write(scene.commit(2).0);
        let mut values: Vec<(&str, Variant)> = vec![("made", 7_u64.into()), ("note", "RUN".into())];
        values.extend(last.map(|last| ("made", last.into())));
        let taken = take(&mut scene, &values, 3);
        // The transaction fails, and the state is read again. The state that withheld 7 is over by then.
        let mut again = stored.load(4);
        know_again(&mut again.state, &scene.state, at(4));
        take_again(&mut again.state, taken, at(4));
        let made = again.state.field(&field("made")).expect("a field");
        let disclosed = made.gate().disclosed().map(|released| released.value.clone());
        assert_eq!(disclosed, last.map(Variant::from));
    }
}
