//! Named policies and policies of recipients.

use asi_model::{DataValue, OrganisationId, messages::ValueSource};
use disclosure::{DecisionBasis, DisclosurePolicy, DocumentId, GateOutcome, NamedPolicy};
use serde_json::json;

use crate::{
    DocumentError,
    queries::{fields_under_policy, policy_changes},
    scene::{Scene, at, decision, field, network},
    use_cases::{
        decide::{DecisionCommand, DecisionError, DecisionRequest},
        policies::{put_policy, set_recipient_policy},
        validity::begin_requests,
        values::{FieldCandidate, receive_candidates},
    },
};

fn id(text: &str) -> DocumentId {
    text.parse().expect("an id")
}

fn acme() -> OrganisationId {
    "acme".parse().expect("an id")
}

/// Stores a named policy, where its version is the expected one.
fn put(
    scene: &mut Scene,
    name: &str,
    disclosure: serde_json::Value,
    expected: Option<u32>,
) -> Result<u32, DocumentError> {
    let policy = json!({ "name": "n", "disclosure": disclosure });
    let policy: NamedPolicy = serde_json::from_value(policy).expect("a policy");
    let stored =
        scene.attempt(|state| put_policy(state, &id(name), policy, expected, "eve", at(0)));
    stored.map(|version| version.version)
}

#[test]
fn the_strictest_of_field_and_recipients_holds() {
    let mut scene = Scene::default();
    scene.map("made", ValueSource::Manual, r#"{"roundingStep":10}"#);
    put(&mut scene, "coarse", json!({ "roundingStep": 100 }), None).expect("stored");
    assert_eq!(scene.offer("made", 149_u64, 1)[0]["Payload"]["made"]["Body"], "150");
    let coarse = Some(id("coarse"));
    scene
        .attempt(|state| set_recipient_policy(state, &acme(), coarse, None, "eve", at(2)))
        .expect("set");
    let (writes, _) = scene.commit(2);
    let [consent] = &writes.fields.consents[..] else { panic!("{:?}", writes.fields.consents) };
    assert!(consent.policy.contains("100") && consent.basis.is_some());
    let tells_partner =
        |text: &str| writes.controls.queued.iter().any(|control| control.body.contains(text));
    assert!(tells_partner("multiples of 100"), "the partner is told");
    let [report] = &writes.reports.queued[..] else { panic!("{:?}", writes.reports) };
    let report: serde_json::Value = serde_json::from_str(&report.body).expect("JSON");
    assert_eq!(report["Payload"]["made"]["Body"], "200", "the finer 150 is not sent again");
    assert_eq!(scene.offer("made", 349_u64, 3)[0]["Payload"]["made"]["Body"], "300");
    let decision = scene.state.field(&field("made")).expect("a field").decision();
    let consented = decision.policy.rounding_step.map(|step| step.to_string());
    assert_eq!(consented.as_deref(), Some("10"), "what was consented to stays");

    // A looser policy for the recipient never loosens the field's own.
    put(&mut scene, "coarse", json!({ "roundingStep": 2 }), Some(1)).expect("stored");
    assert_eq!(scene.offer("made", 333_u64, 5)[0]["Payload"]["made"]["Body"], "330");
    let stale = put(&mut scene, "coarse", json!({}), Some(1));
    assert_eq!(stale, Err(DocumentError::Changed(2)));
}

#[test]
fn a_named_policy_takes_its_fields_along() {
    let mut scene = Scene::default();
    put(&mut scene, "p", json!({ "roundingStep": 100 }), None).expect("stored");
    let command = DecisionCommand::Map {
        value_source: ValueSource::Manual,
        mapping: None,
        policy: DisclosurePolicy::default(),
    };
    let with_policy = |name: &str| DecisionRequest {
        basis: DecisionBasis { policy_id: Some(id(name)), ..DecisionBasis::default() },
        ..decision(command.clone())
    };
    scene.decide("made", with_policy("p"), 0).expect("decided");
    assert_eq!(scene.offer("made", 149_u64, 1)[0]["Payload"]["made"]["Body"], "100");
    let draft = serde_json::from_value(json!({ "roundingStep": 1000 })).expect("a policy");
    assert_eq!(policy_changes(&scene.state, &id("p"), &draft).len(), 1);
    let refused = scene.decide("made", with_policy("q"), 0);
    assert_eq!(refused, Err(DecisionError::UnknownPolicy(id("q"))));
}

/// Returns the names of the fields that a change of a named policy visits.
fn visited(scene: &Scene, name: &str) -> Vec<String> {
    let id = id(name);
    let fields = fields_under_policy(&scene.state, &id);
    let mut names: Vec<String> = fields.map(|field| field.key().field_name.to_string()).collect();
    names.sort();
    names
}

/// The cost of a changed policy follows the fields under it, not all that are mapped.
#[test]
fn a_changed_policy_visits_the_fields_that_it_concerns() {
    let mut scene = Scene::default();
    for name in ["p", "q"] {
        put(&mut scene, name, json!({ "delayMs": 1000 }), None).expect("stored");
    }
    let command = DecisionCommand::Map {
        value_source: ValueSource::Manual,
        mapping: None,
        policy: DisclosurePolicy::default(),
    };
    let named = |name: &str| DecisionRequest {
        basis: DecisionBasis { policy_id: Some(id(name)), ..DecisionBasis::default() },
        ..decision(command.clone())
    };
    scene.decide("made", named("p"), 0).expect("decided");
    scene.map("note", ValueSource::Manual, "{}");
    assert_eq!((visited(&scene, "p"), visited(&scene, "q")), (vec!["made".to_owned()], vec![]));
    scene.commit(0);

    put(&mut scene, "q", json!({ "delayMs": 2000 }), Some(1)).expect("stored");
    let (writes, _) = scene.commit(1);
    assert!(writes.fields.consents.is_empty() && writes.fields.values.is_empty(), "{writes:?}");
    put(&mut scene, "p", json!({ "delayMs": 2000 }), Some(1)).expect("stored");
    let (writes, _) = scene.commit(2);
    assert_eq!((writes.fields.consents.len(), writes.fields.values.len()), (1, 1));

    let q = Some(id("q"));
    scene
        .attempt(|state| set_recipient_policy(state, &acme(), q, None, "eve", at(3)))
        .expect("set");
    assert_eq!(visited(&scene, "q"), ["made", "note"]);
    scene.decide("made", named("q"), 4).expect("decided");
    assert_eq!((visited(&scene, "p").len(), visited(&scene, "q").len()), (0, 3));
    scene.decide("made", decision(DecisionCommand::LeavePending), 5).expect("decided");
    assert_eq!(visited(&scene, "q"), ["note"], "what is not mapped is not concerned");
}

#[test]
fn a_state_of_one_field_withholds_another() {
    let mut scene = Scene::default();
    scene.map("note", ValueSource::Manual, "{}");
    let policy = r#"{"withholdWhile":[{"field":"note","states":["SETUP"]}]}"#;
    scene.map("made", ValueSource::Manual, policy);
    assert_eq!(scene.offer("made", 1_u64, 1).len(), 0, "the state is unknown");
    assert_eq!(scene.offer("note", "RUN", 2).len(), 1);
    assert_eq!(scene.offer("made", 2_u64, 3)[0]["Payload"]["made"]["Body"], "2");
    scene.offer("note", "SETUP", 4);
    let outcome = scene.candidate("made", ValueSource::Manual, 3_u64, 5);
    assert_eq!(outcome, Some(GateOutcome::Suppressed));
    let reports = scene.offer("note", "RUN", 6);
    assert_eq!(reports[0]["Payload"]["made"]["Body"], "2", "a withheld value is never released");
    let reason = Some("no".to_owned());
    let refusal = DecisionRequest { reason, ..decision(DecisionCommand::Refuse) };
    scene.decide("note", refusal, 7).expect("decided");
    let reports = scene.offer("made", 4_u64, 8);
    assert_eq!(reports[0]["Payload"]["made"]["Body"], "2", "the state is unknown again");
    let policy = r#"{"withholdWhile":[{"field":"nothing","states":[1]}]}"#;
    let policy = serde_json::from_str(policy).expect("a policy");
    let command = DecisionCommand::Map { value_source: ValueSource::Manual, mapping: None, policy };
    let refused = scene.decide("made", decision(command), 9);
    assert!(
        matches!(refused, Err(DecisionError::Policy(faults)) if faults[0].member == "withholdWhile")
    );
}

#[test]
fn states_of_another_type_withhold() {
    let mut scene = Scene::default();
    scene.map("note", ValueSource::Manual, "{}");
    scene.map("made", ValueSource::Manual, WITHHELD_IN_SETUP);
    scene.offer("note", "RUN", 1);
    assert_eq!(scene.offer("made", 1_u64, 2)[0]["Payload"]["made"]["Body"], "1");
    // A number where the condition has texts: whether it is one of the states nobody knows.
    scene.offer("note", 7_u64, 3);
    let outcome = scene.candidate("made", ValueSource::Manual, 2_u64, 4);
    assert_eq!(outcome, Some(GateOutcome::Suppressed));
    scene.offer("note", "RUN", 5);
    assert_eq!(scene.offer("made", 3_u64, 6)[0]["Payload"]["made"]["Body"], "3");
    // What no value of a field can be is refused as a state.
    for states in [r#"{"field":"note","states":[7,true]}"#, r#"{"states":["SETUP"]}"#] {
        let policy = format!(r#"{{"withholdWhile":[{states}]}}"#);
        let policy = serde_json::from_str(&policy).expect("a policy");
        let command =
            DecisionCommand::Map { value_source: ValueSource::Manual, mapping: None, policy };
        let refused = scene.decide("made", decision(command), 7);
        assert!(
            matches!(&refused, Err(DecisionError::Policy(faults)) if faults[0].message.contains("is one of a")),
            "{states}: {refused:?}"
        );
    }
}

const WITHHELD_IN_SETUP: &str = r#"{"withholdWhile":[{"field":"note","states":["SETUP"]}]}"#;

/// Offers candidates for `made` (numbers) and `note` (texts) that come together. Returns the
/// numbers that left.
fn together(scene: &mut Scene, batch: &[Result<u64, &str>], ms: i64) -> Vec<serde_json::Value> {
    let candidate = |value: &Result<u64, &str>| {
        let (name, value) = match value {
            Ok(number) => ("made", DataValue::good(*number, at(ms))),
            Err(text) => ("note", DataValue::good(*text, at(ms))),
        };
        let id = scene.state.field(&field(name)).expect("a field").id();
        let source = ValueSource::Mapping;
        FieldCandidate { field: id, source, mapping_version: None, value, transform: None }
    };
    let candidates = batch.iter().map(candidate).collect();
    receive_candidates(&mut scene.state, candidates, at(ms));
    let (writes, _) = scene.commit(ms);
    let bodies = writes.reports.queued.iter().map(|report| &report.body);
    let reports = bodies.map(|body| serde_json::from_str::<serde_json::Value>(body).expect("JSON"));
    reports
        .filter_map(|report| report["Payload"].get("made").map(|made| made["Body"].clone()))
        .collect()
}

#[test]
fn a_state_that_withholds_is_judged_before_the_values_of_its_batch() {
    let mut scene = Scene::default();
    scene.map("note", ValueSource::Mapping, "{}");
    scene.map("made", ValueSource::Mapping, WITHHELD_IN_SETUP);
    // The state of the first batch holds for its values, in any order.
    assert_eq!(together(&mut scene, &[Ok(1), Err("RUN")], 1), ["1"]);
    assert_eq!(together(&mut scene, &[Ok(2), Err("SETUP")], 2), ["1"], "it came before its state");
    assert_eq!(together(&mut scene, &[Ok(3), Err("RUN")], 3), ["1"], "it came in the state before");
    assert_eq!(together(&mut scene, &[Ok(4)], 4), ["4"]);
    let through = [Ok(5), Err("SETUP"), Ok(6), Err("RUN"), Ok(7)];
    assert_eq!(together(&mut scene, &through, 5), ["4"], "a state between counts, too");
    assert_eq!(together(&mut scene, &[Err("SETUP")], 6), ["4"]);
    assert_eq!(together(&mut scene, &[Ok(8), Err("RUN"), Ok(9)], 7), ["9"]);
}

/// The two fields, the request of which begins at 1 000 ms.
fn before_the_request_begins() -> Scene {
    let mut scene = Scene::default();
    scene.arrive(network(2, |request| request["validFrom"] = json!(at(1_000))));
    scene.map("note", ValueSource::Mapping, "{}");
    scene.map("made", ValueSource::Mapping, WITHHELD_IN_SETUP);
    scene
}

/// Lets the request begin, and returns the numbers and the texts that left.
fn begun(scene: &mut Scene) -> (Vec<serde_json::Value>, Vec<serde_json::Value>) {
    begin_requests(&mut scene.state, at(1_000));
    let (writes, _) = scene.commit(1_000);
    let bodies = writes.reports.queued.iter().map(|report| &report.body);
    let reports: Vec<serde_json::Value> =
        bodies.map(|body| serde_json::from_str(body).expect("JSON")).collect();
    let of = |name: &str| {
        let members = reports.iter().filter_map(|report| report["Payload"].get(name));
        members.map(|member| member["Body"].clone()).collect()
    };
    (of("made"), of("note"))
}

#[test]
fn what_came_in_a_state_before_its_request_begins_is_withheld() {
    type Kept<'t> = (&'t [Result<u64, &'t str>], Vec<serde_json::Value>);
    let all: [Kept<'_>; 6] = [
        (&[Err("RUN"), Ok(1)], vec![json!("1")]),
        (&[Err("RUN"), Err("SETUP"), Ok(2), Err("RUN")], vec![]),
        (&[Err("RUN"), Ok(3), Err("SETUP"), Ok(4), Err("RUN")], vec![]),
        // The state that holds when it begins counts, wherever its field stands among them.
        (&[Err("RUN"), Ok(5), Err("SETUP")], vec![]),
        (&[Err("SETUP"), Ok(6), Err("RUN"), Ok(7)], vec![json!("7")]),
        (&[Ok(8), Err("RUN")], vec![]),
    ];
    for (values, expected) in all {
        let mut scene = before_the_request_begins();
        for (ms, value) in (0..).zip(values) {
            assert_eq!(together(&mut scene, std::slice::from_ref(value), ms), [""; 0]);
        }
        let (made, note) = begun(&mut scene);
        assert_eq!(made, expected, "{values:?}");
        assert_eq!(note.len(), 1, "{values:?}");
    }
}

#[test]
fn what_is_kept_for_a_request_does_not_outlive_its_policy() {
    let mut scene = before_the_request_begins();
    scene.map("made", ValueSource::Mapping, "{}");
    together(&mut scene, &[Err("SETUP"), Ok(1)], 1);
    scene.map("made", ValueSource::Mapping, WITHHELD_IN_SETUP);
    together(&mut scene, &[Err("RUN")], 2);
    assert_eq!(begun(&mut scene).0, [""; 0], "nobody knows in which state it came");
}

#[test]
fn reports_of_another_function_are_taken_back() {
    for (former, is_taken_back) in [("LAST", true), ("MAXIMUM", true), ("MEAN", false)] {
        let mut scene = Scene::default();
        let own = format!(r#"{{"aggregate":{{"function":"{former}","windowMs":120000}}}}"#);
        scene.map("made", ValueSource::Manual, &own);
        scene.commit(0);
        let mean = r#"{"aggregate":{"function":"MEAN","windowMs":60000}}"#;
        scene.map("made", ValueSource::Manual, mean);
        let made = scene.state.field(&field("made")).expect("a field").writer();
        assert_eq!(scene.pending.purges.contains_key(&made), is_taken_back, "{former}");
    }
}

/// A recipient reads its chain: ids of policies and rules are words of the plant about others.
#[test]
fn no_chain_of_a_recipient_names_a_document_of_the_plant() {
    let mut scene = Scene::default();
    for name in ["price-of-hull", "secret-of-acme"] {
        put(&mut scene, name, json!({ "roundingStep": 100 }), None).expect("stored");
    }
    let recipients = Some(id("secret-of-acme"));
    scene
        .attempt(|state| set_recipient_policy(state, &acme(), recipients, None, "eve", at(1)))
        .expect("set");
    let command = DecisionCommand::Map {
        value_source: ValueSource::Manual,
        mapping: None,
        policy: DisclosurePolicy::default(),
    };
    let basis = DecisionBasis { policy_id: Some(id("price-of-hull")), ..DecisionBasis::default() };
    let request = DecisionRequest { basis, ..decision(command) };
    scene.decide("made", request, 2).expect("decided");
    let (writes, _) = scene.commit(3);
    let [consent] = &writes.fields.consents[..] else { panic!("{:?}", writes.fields.consents) };
    let stored = consent.basis.as_deref().expect("a basis");
    assert!(stored.contains("price-of-hull") && stored.contains("secret-of-acme"), "{stored}");
    let stored: DecisionBasis = serde_json::from_str(stored).expect("a basis");
    let committed = serde_json::to_string(&ledger::basis_for_recipients(&stored)).expect("JSON");
    let entries: Vec<&str> =
        writes.ledger.entries.iter().map(|(entry, _)| entry.content.as_str()).collect();
    for entry in &entries {
        assert!(!entry.contains("price-of-hull") && !entry.contains("secret-of-acme"), "{entry}");
        assert!(!entry.contains(stored.salt.as_deref().expect("a salt")), "{entry}");
    }
    let consents = entries.iter().filter(|entry| entry.contains(&committed));
    assert_eq!(consents.count(), 2, "both chains commit to them: {entries:?}");
}
