//! Named policies, recipients' policies, standing rules, states and validity, as the books keep
//! them.

use asi_model::{
    DataValue, OrganisationId,
    messages::{MappingState, ValueSource},
};
use disclosure::DecisionBasis;
use serde_json::json;

use super::{
    tests::{arrive, at, books, field, map, network, offer},
    *,
};
use disclosure::{DisclosurePolicy, GateOutcome, RuleAction};

fn id(text: &str) -> DocumentId {
    text.parse().expect("an id")
}

fn policy(disclosure: serde_json::Value) -> NamedPolicy {
    serde_json::from_value(json!({ "name": "n", "disclosure": disclosure })).expect("a policy")
}

fn acme() -> OrganisationId {
    "acme".parse().expect("an id")
}

fn rule(action: &str, value_source: &str) -> Rule {
    serde_json::from_value(
        json!({ "name": "n", "isEnabled": true, "when": { "partners": ["acme", "hull"],
        "namePattern": "made" }, "action": action, "valueSource": value_source, "reason": "no",
        "disclosure": { "roundingStep": 10 } }),
    )
    .expect("a rule")
}

fn state(books: &Books, name: &str) -> MappingState {
    books.field(&field(name)).expect("a field").decision.mapping_state
}

#[test]
fn the_strictest_of_field_and_recipients_holds() {
    let mut books = books();
    map(&mut books, "made", ValueSource::Manual, r#"{"roundingStep":10}"#);
    books
        .put_policy(&id("coarse"), policy(json!({ "roundingStep": 100 })), None, "eve", at(0))
        .expect("kept");
    assert_eq!(offer(&mut books, "made", 149_u64, 1)[0]["Payload"]["made"]["Body"], "150");
    books.set_recipient_policy(&acme(), Some(id("coarse")), None, "eve", at(2)).expect("set");
    let (changes, _) = books.take();
    assert_eq!(changes.consents.len(), 1, "a change of what leaves is a consent");
    assert!(changes.consents[0].policy.contains("100") && changes.consents[0].grounds.is_some());
    assert!(
        changes.controls.iter().any(|control| control.body.contains("multiples of 100")),
        "the partner is told"
    );
    assert_eq!(offer(&mut books, "made", 249_u64, 3)[0]["Payload"]["made"]["Body"], "200");
    let decision = &books.field(&field("made")).expect("a field").decision;
    assert_eq!(
        decision.policy.rounding_step.map(|step| step.to_string()).as_deref(),
        Some("10"),
        "what was consented"
    );
    // A looser policy for the recipient never loosens the field's own.
    books
        .put_policy(&id("coarse"), policy(json!({ "roundingStep": 2 })), Some(1), "eve", at(4))
        .expect("kept");
    assert_eq!(offer(&mut books, "made", 333_u64, 5)[0]["Payload"]["made"]["Body"], "330");
    let stale = books.put_policy(&id("coarse"), policy(json!({})), Some(1), "eve", at(6));
    assert_eq!(stale, Err(DocumentError::Changed(2)));
}

#[test]
fn a_named_policy_takes_its_fields_along() {
    let mut books = books();
    books
        .put_policy(&id("p"), policy(json!({ "roundingStep": 100 })), None, "eve", at(0))
        .expect("kept");
    let verdict = Verdict::Map {
        value_source: ValueSource::Manual,
        mapping: None,
        policy: DisclosurePolicy::default(),
    };
    let grounds = DecisionBasis { policy_id: Some(id("p")), ..DecisionBasis::default() };
    books.decide_on(&field("made"), verdict.clone(), None, "eve", grounds, at(0)).expect("decided");
    assert_eq!(offer(&mut books, "made", 149_u64, 1)[0]["Payload"]["made"]["Body"], "100");
    let draft = serde_json::from_value(json!({ "roundingStep": 1000 })).expect("a policy");
    assert_eq!(books.policy_changes(&id("p"), &draft).len(), 1);
    let unknown = DecisionBasis { policy_id: Some(id("q")), ..DecisionBasis::default() };
    let refused = books.decide_on(&field("made"), verdict, None, "eve", unknown, at(0));
    assert_eq!(refused, Err(DecisionError::UnknownPolicy(id("q"))));
}

#[test]
fn a_rule_decides_about_what_comes_and_can_be_undone() {
    let mut books = books();
    books.put_rule(&id("r"), rule("ACCEPT", "MANUAL"), None, "eve", at(0)).expect("kept");
    assert_eq!(state(&books, "made"), MappingState::Pending, "what is there is decided on demand");
    assert_eq!(books.apply_rules(None, at(1)), 1);
    assert_eq!(
        (state(&books, "made"), state(&books, "note")),
        (MappingState::Mapped, MappingState::Pending)
    );
    let (changes, _) = books.take();
    let decided = &changes.rule_decisions[0];
    assert_eq!((decided.action, decided.rules[0].version), (RuleAction::Accept, 1));
    assert!(
        changes
            .ledger
            .iter()
            .any(|(entry, _)| entry.content.contains(r#""rules":[{"id":"r","version":1}]"#))
    );
    assert_eq!(offer(&mut books, "made", 17_u64, 2)[0]["Payload"]["made"]["Body"], "20");
    books
        .undo_rule_decision(decided.id, &field("made"), decided.consent_version, "eve", at(3))
        .expect("undone");
    assert_eq!(state(&books, "made"), MappingState::Pending);
    assert_eq!(books.apply_rules(None, at(4)), 0, "it is the engineer's now");
    let again =
        books.undo_rule_decision(decided.id, &field("made"), decided.consent_version, "eve", at(5));
    assert_eq!(again, Err(DecisionError::DecidedSince));
}

#[test]
fn a_rule_never_covers_a_recipient_that_it_does_not_name() {
    let mut books = books();
    books.put_rule(&id("r"), rule("ACCEPT", "MANUAL"), None, "eve", at(0)).expect("kept");
    arrive(
        &mut books,
        network(2, |request| request["recipientList"] = json!(["acme", "hull", "spy"])),
    );
    assert_eq!(state(&books, "made"), MappingState::Pending);
    arrive(&mut books, network(3, |request| request["recipientList"] = json!(["acme", "hull"])));
    assert_eq!(state(&books, "made"), MappingState::Mapped, "a new revision is decided at once");
    books.put_rule(&id("s"), rule("REFUSE", "MANUAL"), None, "eve", at(0)).expect("kept");
    arrive(&mut books, network(4, |request| request["purpose"] = json!("something else")));
    assert_eq!(state(&books, "made"), MappingState::Refused, "the most cautious rule wins");
}

#[test]
fn a_rule_without_a_source_of_values_only_offers() {
    let mut books = books();
    books.put_rule(&id("r"), rule("ACCEPT", "MAPPING"), None, "eve", at(0)).expect("kept");
    assert_eq!(books.apply_rules(None, at(1)), 0);
    assert_eq!(
        books.rule_offer(&field("made")).map(|offer| offer.action),
        Some(RuleAction::Prefill)
    );
    // The mapping that a field had is taken up again.
    let mapping = json!({ "mappingId": "m", "target": field("made"), "targetType": "UInt64", "targetUnit": "PIECE",
        "inputs": [], "steps": [] });
    let mapping = serde_json::from_value(mapping).expect("a mapping");
    let policy = DisclosurePolicy::default();
    let verdict = Verdict::Map {
        value_source: ValueSource::Mapping,
        mapping: Some(Box::new(mapping)),
        policy,
    };
    books.decide(&field("made"), verdict, None, "eve", at(2)).expect("decided");
    arrive(&mut books, network(2, |request| request["purpose"] = json!("something else")));
    assert_eq!(state(&books, "made"), MappingState::Mapped);
}

#[test]
fn one_fields_state_withholds_another() {
    let mut books = books();
    map(&mut books, "note", ValueSource::Manual, "{}");
    map(
        &mut books,
        "made",
        ValueSource::Manual,
        r#"{"withholdWhile":[{"field":"note","states":["SETUP"]}]}"#,
    );
    assert_eq!(offer(&mut books, "made", 1_u64, 1).len(), 0, "the state is not known");
    assert_eq!(offer(&mut books, "note", "RUN", 2).len(), 1);
    assert_eq!(offer(&mut books, "made", 2_u64, 3)[0]["Payload"]["made"]["Body"], "2");
    offer(&mut books, "note", "SETUP", 4);
    let value = DataValue::good(3_u64, at(5));
    let outcome = books.candidate(&field("made"), ValueSource::Manual, value, None, at(5));
    assert_eq!(outcome, Some(GateOutcome::Suppressed));
    let left = offer(&mut books, "note", "RUN", 6);
    assert_eq!(left[0]["Payload"]["made"]["Body"], "2", "what came in the state never leaves");
    books
        .decide(&field("note"), Verdict::Refuse, Some("no".to_owned()), "eve", at(7))
        .expect("decided");
    let described_anew = offer(&mut books, "made", 4_u64, 8);
    assert_eq!(
        described_anew[0]["Payload"]["made"]["Body"], "2",
        "the state is not known any more"
    );
    let policy = serde_json::from_str(r#"{"withholdWhile":[{"field":"nothing","states":[1]}]}"#)
        .expect("a policy");
    let verdict = Verdict::Map { value_source: ValueSource::Manual, mapping: None, policy };
    let refused = books.decide(&field("made"), verdict, None, "eve", at(9));
    assert!(
        matches!(refused, Err(DecisionError::Policy(faults)) if faults[0].member == "withholdWhile")
    );
}

#[test]
fn values_flow_within_the_requests_validity_only() {
    let (from, until) = (at(1_000), at(2_000));
    let mut books = books();
    arrive(
        &mut books,
        network(2, |request| {
            request["validFrom"] = json!(from);
            request["validUntil"] = json!(until);
        }),
    );
    map(&mut books, "made", ValueSource::Manual, "{}");
    assert_eq!(offer(&mut books, "made", 1_u64, 500).len(), 0, "not yet asked for");
    assert_eq!(books.next_turn(), Some(from));
    books.begin(from);
    books.report(from, || [7; ledger::SALT_BYTES]);
    assert_eq!(books.take().0.reports.len(), 1, "the newest value, once it is asked for");
    assert_eq!(offer(&mut books, "made", 2_u64, 1_500).len(), 1);
    books.expire(until);
    assert_eq!(state(&books, "made"), MappingState::Pending);
    assert_eq!(offer(&mut books, "made", 3_u64, 2_001).len(), 0);
    let verdict = Verdict::Map {
        value_source: ValueSource::Manual,
        mapping: None,
        policy: DisclosurePolicy::default(),
    };
    assert_eq!(
        books.decide(&field("made"), verdict, None, "eve", at(2_002)),
        Err(DecisionError::Ended)
    );
}
