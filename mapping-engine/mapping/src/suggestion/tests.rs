use asi_model::network::Semantic;

use super::*;

fn requested(
    name: &str,
    value_type: BuiltInType,
    unit: Option<&str>,
    semantic: Option<Semantic>,
) -> RequestedField {
    RequestedField {
        name: name.to_owned(),
        value_type,
        value_rank: -1,
        unit: unit.map(str::to_owned),
        semantic,
        descriptions: vec!["Update the status of materialOutput in the buffer".to_owned()],
        asset: Some("Press2".to_owned()),
    }
}

fn variable(path: &str, value_type: BuiltInType, unit: Option<&str>, value: f64) -> KnownVariable {
    let mut path: Vec<String> = path.split('/').map(str::to_owned).collect();
    let node_id = NodeId::string("urn:press", &path.join("."));
    KnownVariable {
        source_id: SourceId::new("press").expect("an id"),
        node_id,
        name: path.pop().expect("a name"),
        path,
        description: None,
        value_type: Some(value_type),
        value_rank: Some(-1),
        unit: unit.map(str::to_owned),
        type_names: Vec::new(),
        value: Some(value),
    }
}

fn plant() -> Vec<KnownVariable> {
    use BuiltInType as T;
    vec![
        variable("Press1/PartCounter", T::UInt32, Some("H87"), 17.0),
        variable("Press2/PartCounter", T::UInt32, Some("H87"), 12.0),
        variable("Press2/ScrapCounter", T::UInt32, Some("H87"), 1.0),
        variable("Press2/PlannedParts", T::UInt32, Some("H87"), 100.0),
        variable("Press2/OilTemperature", T::Double, Some("CEL"), 41.5),
        variable("Press2/MachineState", T::Int32, None, 3.0),
        variable("Press2/JobProgress", T::Float, Some("P1"), 12.5),
        variable("Press2/PartCounterLabel", T::String, None, 0.0),
        variable("Press2/Counters", T::ExtensionObject, None, 0.0),
    ]
}

fn best(field: &RequestedField, past: &[PastDecision]) -> Vec<String> {
    suggest(field, &plant(), past, 3).into_iter().map(|suggestion| suggestion.path).collect()
}

#[test]
fn the_right_variable_comes_first() {
    use BuiltInType as T;
    for (field, expected) in [
        (
            requested("progressStatus", T::UInt64, Some("PIECE"), Some(Semantic::ProducedQuantity)),
            "Press2/PartCounter",
        ),
        (
            requested("rejects", T::UInt64, Some("PIECE"), Some(Semantic::ScrapQuantity)),
            "Press2/ScrapCounter",
        ),
        (
            requested("progress", T::Double, Some("P1"), Some(Semantic::PercentComplete)),
            "Press2/JobProgress",
        ),
        (
            requested("operationState", T::Int32, None, Some(Semantic::OperationState)),
            "Press2/MachineState",
        ),
        (requested("oilTemp", T::Double, Some("FAH"), None), "Press2/OilTemperature"),
    ] {
        assert_eq!(best(&field, &[]).first().map(String::as_str), Some(expected), "{}", field.name);
    }
}

#[test]
fn what_cannot_be_is_not_suggested() {
    let field = requested("temperature", BuiltInType::Double, Some("MMT"), None);
    assert!(best(&field, &[]).is_empty(), "degrees are no millimetres");
    let field = requested("vibration", BuiltInType::Double, None, None);
    assert!(best(&field, &[]).is_empty(), "nothing is like it");
    let field = requested("partCounter", BuiltInType::Guid, None, None);
    assert_eq!(best(&field, &[]), ["Press2/PartCounterLabel"], "only a text may be a Guid");
}

#[test]
fn earlier_decisions_weigh_and_reasons_are_given() {
    let field = requested(
        "progressStatus",
        BuiltInType::UInt64,
        Some("PIECE"),
        Some(Semantic::ProducedQuantity),
    );
    let first = &plant()[0];
    let past = PastDecision {
        field_name: "progressStatus".to_owned(),
        semantic: Some(Semantic::ProducedQuantity),
        source_id: first.source_id.clone(),
        node_id: first.node_id.clone(),
    };
    assert_eq!(best(&field, &[past]).first().map(String::as_str), Some("Press1/PartCounter"));
    let suggestions =
        suggest(&requested("oilTemp", BuiltInType::Int32, Some("FAH"), None), &plant(), &[], 1);
    let kinds: Vec<ReasonKind> = suggestions[0].reasons.iter().map(|reason| reason.kind).collect();
    assert!(kinds.contains(&ReasonKind::Name) && kinds.contains(&ReasonKind::Unit), "{kinds:?}");
    let functions: Vec<&str> = suggestions[0].steps.iter().map(Step::function).collect();
    assert_eq!(functions, ["unitConversion", "convert"]);
    assert!(
        suggestions[0].reasons.windows(2).all(|pair| pair[0].points.abs() >= pair[1].points.abs())
    );
}
