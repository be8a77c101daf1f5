//! Mappings: versions, imports and shadow mappings.

use asi_model::{DataValue, messages::ValueSource};
use disclosure::DisclosurePolicy;
use mapping::{Mapping, PublishRequest, TargetKey, TransformState};
use serde_json::{Value, json};

use crate::{
    EngineCommand,
    queries::validate_for_field,
    scene::{Scene, at, decision, field, network},
    use_cases::{
        decide::DecisionCommand,
        import_mappings::{MappingImport, import_mappings, set_shadow},
        values::{FieldCandidate, receive_candidate, receive_candidates, release_due},
    },
};

/// Makes a mapping of `made` with these functions, as the field takes it.
fn mapping(scene: &Scene, steps: &Value) -> Mapping {
    let json = json!({ "mappingId": "x", "target": field("made"), "targetType": "UInt64",
        "targetUnit": "PIECE", "inputs": [{ "name": "a", "sourceId": "s",
        "nodeId": "nsu=urn:x;i=1" }], "steps": steps });
    let mapping = serde_json::from_value(json).expect("a mapping");
    validate_for_field(&scene.state, mapping).expect("it fits")
}

/// Imports a mapping: the new versions, the number of consents and of commands for the engine.
fn import(scene: &mut Scene, steps: &Value) -> (Vec<u32>, usize, usize) {
    let mapping = mapping(scene, steps);
    let import = MappingImport { mapping, author: "eve".to_owned(), note: None };
    scene.run(|state| import_mappings(state, vec![import], at(1)).expect("no cap"));
    let (writes, effects) = scene.commit(1);
    let versions = writes.mappings.versions.iter().map(|row| row.version).collect();
    (versions, writes.fields.consents.len(), effects.engine.len())
}

#[test]
fn a_corrected_mapping_is_a_version_and_no_consent() {
    let mut scene = Scene::default();
    let steps = json!([{ "function": "counter" }]);
    scene.commit(0);
    assert_eq!(import(&mut scene, &steps), (vec![], 0, 0), "undecided: a proposal");
    let command = DecisionCommand::Map {
        value_source: ValueSource::Mapping,
        mapping: Some(Box::new(mapping(&scene, &steps))),
        policy: DisclosurePolicy::default(),
    };
    scene.decide("made", decision(command.clone()), 2).expect("decided");
    assert_eq!(scene.commit(2).0.mappings.versions[0].version, 1);
    scene.decide("made", decision(command), 2).expect("decided");
    assert!(scene.commit(2).0.mappings.versions.is_empty(), "the same mapping is no version");

    let counter = r#"[{"function":"counter","total":5,"last":15,"level":null}]"#;
    let counter: TransformState = serde_json::from_str(counter).expect("a state");
    let id = scene.state.field(&field("made")).expect("a field").id();
    let value = DataValue::good(5_u64, at(3));
    receive_candidate(&mut scene.state, id, ValueSource::Mapping, value, Some(counter), at(3));
    let scaled = json!([{ "function": "counter" }, { "function": "scale", "factor": 2 }]);
    assert_eq!(import(&mut scene, &scaled), (vec![2], 0, 1));
    assert_eq!(import(&mut scene, &scaled), (vec![], 0, 0));
    let transform = scene.state.field(&field("made")).expect("a field").transform();
    let transform = serde_json::to_string(&transform).expect("serialises");
    assert!(transform.contains(r#""total":5"#), "a counter goes on through a correction");
}

#[test]
fn a_corrected_mapping_takes_back_the_reports_that_wait() {
    let mut scene = Scene::default();
    scene.map("made", ValueSource::Mapping, "{}");
    scene.map("note", ValueSource::Manual, "{}");
    scene.commit(1);
    let made = scene.state.field(&field("made")).expect("a field").writer();
    let scaled = mapping(&scene, &json!([{ "function": "scale", "factor": 2 }]));
    let import = MappingImport { mapping: scaled, author: "eve".to_owned(), note: None };
    scene.run(|state| import_mappings(state, vec![import], at(2)).expect("no cap"));
    let taken_back: Vec<u16> = scene.pending.purges.keys().copied().collect();
    assert_eq!(taken_back, [made], "what waits was made by the former mapping");
}

#[test]
fn a_mapping_with_another_unit_does_not_fit_its_field() {
    let scene = Scene::default();
    let other = Mapping { target_unit: Some("KGM".to_owned()), ..mapping(&scene, &json!([])) };
    let mismatches = validate_for_field(&scene.state, other).expect_err("another unit");
    let members: Vec<_> = mismatches.iter().map(|mismatch| mismatch.member).collect();
    assert_eq!(members, ["targetUnit"]);
}

#[test]
fn a_shadow_mapping_ends_with_its_field() {
    let mut scene = Scene::default();
    let shadow = mapping(&scene, &json!([]));
    let set = |scene: &mut Scene, shadow| {
        scene.attempt(|state| {
            set_shadow(state, &field("made"), shadow, "eve", at(1)).map(|changes| ((), changes))
        })
    };
    set(&mut scene, Some(shadow.clone())).expect("the field exists");
    let (writes, effects) = scene.commit(1);
    assert_eq!(writes.mappings.shadows.len(), 1);
    assert!(matches!(
        effects.engine.as_slice(),
        [EngineCommand::Put(PublishRequest { is_shadow: true, .. })]
    ));
    set(&mut scene, Some(shadow)).expect("the field exists");
    scene.arrive(network(2, |request| {
        request["reportDataFormat"]["reportFieldList"] = json!([]);
    }));
    let (writes, effects) = scene.commit(2);
    assert!(writes.mappings.is_empty(), "of a removed field nothing is stored");
    assert!(effects.engine.iter().any(|command| matches!(command, EngineCommand::Remove(_))));
}

/// Returns the command that maps `made` with these functions and a delay of an hour.
fn late(scene: &Scene, steps: &Value) -> DecisionCommand {
    DecisionCommand::Map {
        value_source: ValueSource::Mapping,
        mapping: Some(Box::new(mapping(scene, steps))),
        policy: serde_json::from_value(json!({ "delayMs": 3_600_000 })).expect("a policy"),
    }
}

/// Returns the values of `made` in the reports of a transaction.
fn left(scene: &mut Scene, ms: i64) -> Vec<Value> {
    release_due(&mut scene.state, at(ms));
    let (writes, _) = scene.commit(ms);
    let bodies = writes.reports.queued.iter().map(|report| &report.body);
    let reports = bodies.map(|body| serde_json::from_str::<Value>(body).expect("JSON"));
    reports.map(|report| report["Payload"]["made"]["Body"].clone()).collect()
}

#[test]
fn a_corrected_mapping_never_lets_out_values_of_the_former_one() {
    const HOUR: i64 = 3_600_000;
    let (first, second) = (json!([]), json!([{ "function": "scale", "factor": 2 }]));
    for way in ["decision", "import", "other source"] {
        let mut scene = Scene::default();
        let command = late(&scene, &first);
        scene.decide("made", decision(command), 0).expect("decided");
        scene.candidate("made", ValueSource::Mapping, 41_u64, 0);
        assert_eq!(left(&mut scene, HOUR), ["41"]);
        scene.candidate("made", ValueSource::Mapping, 42_u64, HOUR + 1);
        let mut source = ValueSource::Mapping;
        match way {
            "decision" => {
                let command = late(&scene, &second);
                scene.decide("made", decision(command), HOUR + 60_000).expect("decided");
            }
            "import" => {
                let mapping = mapping(&scene, &second);
                let import = MappingImport { mapping, author: "eve".to_owned(), note: None };
                scene.run(|state| {
                    import_mappings(state, vec![import], at(HOUR + 60_000)).expect("no cap")
                });
            }
            _ => {
                source = ValueSource::Manual;
                let DecisionCommand::Map { policy, .. } = late(&scene, &first) else {
                    panic!("a mapped field")
                };
                let command = DecisionCommand::Map { value_source: source, mapping: None, policy };
                scene.decide("made", decision(command), HOUR + 60_000).expect("decided");
            }
        }
        assert!(left(&mut scene, HOUR + 60_000).is_empty(), "{way}: the former value is repeated");
        scene.candidate("made", source, 84_u64, HOUR + 120_000);
        assert!(left(&mut scene, 2 * HOUR + 119_999).is_empty(), "{way}: the waiting value left");
        assert_eq!(left(&mut scene, 2 * HOUR + 120_000), ["84"], "{way}");
    }
}

#[test]
fn a_new_policy_under_the_same_mapping_keeps_what_waits() {
    let mut scene = Scene::default();
    let command = late(&scene, &json!([]));
    scene.decide("made", decision(command.clone()), 0).expect("decided");
    scene.candidate("made", ValueSource::Mapping, 42_u64, 0);
    scene.decide("made", decision(command), 1).expect("decided");
    assert_eq!(left(&mut scene, 3_600_000), ["42"]);
}

/// A batch of the former mapping may still be on its way when the next one is decided.
#[test]
fn candidates_that_a_former_mapping_sent_are_not_accepted() {
    let mut scene = Scene::default();
    let bring = |scene: &mut Scene, target: TargetKey, ms| {
        let candidate = FieldCandidate {
            field: target.field,
            source: ValueSource::Mapping,
            mapping_version: Some(target.version),
            value: DataValue::good(42_u64, at(ms)),
            transform: None,
        };
        receive_candidates(&mut scene.state, vec![candidate], at(ms))[0].is_some()
    };
    let key = |scene: &Scene| scene.state.field(&field("made")).expect("a field").target_key();
    for (version, steps) in
        [json!([]), json!([{ "function": "scale", "factor": 2 }])].iter().enumerate()
    {
        let former = key(&scene);
        let command = late(&scene, steps);
        scene.decide("made", decision(command), 0).expect("decided");
        let (_, effects) = scene.commit(0);
        let [EngineCommand::Put(published)] = &effects.engine[..] else { panic!("published") };
        assert_eq!(published.target, key(&scene), "what the engine brings is what is accepted");
        assert_eq!(bring(&mut scene, former, 1), version == 0, "nothing was published before");
        let present = key(&scene);
        assert!(bring(&mut scene, present, 2));
    }
}
