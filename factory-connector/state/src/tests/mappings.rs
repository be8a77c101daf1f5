//! Mappings: versions, imports and shadow mappings.

use asi_model::{DataValue, messages::ValueSource};
use disclosure::DisclosurePolicy;
use mapping::{Mapping, PublishRequest, TransformState};
use serde_json::{Value, json};

use crate::{
    EngineCommand,
    queries::validate_for_field,
    scene::{Scene, at, decision, field, network},
    use_cases::{
        decide::DecisionCommand,
        import_mappings::{MappingImport, import_mappings, set_shadow},
        values::receive_candidate,
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
    scene.run(|state| import_mappings(state, vec![import], at(1)));
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
