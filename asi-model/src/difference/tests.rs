//! The table of the contract, and parts that come, change and go.

use serde_json::{Value, json};

use super::*;

fn example() -> Value {
    let message: Value =
        serde_json::from_str(include_str!("../../examples/operation-network.json"))
            .expect("the example is JSON");
    message["operationNetwork"].clone()
}

fn network(value: Value) -> OperationNetwork {
    serde_json::from_value(value).expect("a network")
}

const REQUEST: &str = "/operationList/0/dynamicDataRequestList/0";

#[test]
fn the_contract_s_table_holds() {
    use ConsentEffect as C;
    use MappingEffect as M;
    let field = "/reportDataFormat/reportFieldList/0";
    for (member, value, expected) in [
        ("/description", json!("else"), Some((M::Kept, C::Kept))),
        ("/updateFrequencyUnit", json!("DAY"), Some((M::Kept, C::Kept))),
        ("/updateFrequency", json!(2), Some((M::OfferedAgain, C::BackToPending))),
        ("/validUntil", json!("2019-05-01T00:00:00Z"), Some((M::Kept, C::Kept))),
        ("/validUntil", json!("2020-05-01T00:00:00Z"), Some((M::OfferedAgain, C::BackToPending))),
        ("/validUntil", Value::Null, Some((M::OfferedAgain, C::BackToPending))),
        (
            "/recipientList",
            json!(["acme-aero", "another"]),
            Some((M::OfferedAgain, C::BackToPending)),
        ),
        ("/recipientList", json!(["acme-aero", "acme-aero"]), None),
        ("/purpose", json!("else"), Some((M::OfferedAgain, C::BackToPending))),
        (&format!("{field}/type"), json!(11), Some((M::Suggested, C::BackToPending))),
        (&format!("{field}/unit"), json!("DZN"), Some((M::Suggested, C::BackToPending))),
        (&format!("{field}/unit"), json!("H87"), None),
        (&format!("{field}/valueRank"), json!(1), Some((M::Suggested, C::BackToPending))),
        (
            &format!("{field}/semantic"),
            json!("GOOD_QUANTITY"),
            Some((M::Suggested, C::BackToPending)),
        ),
    ] {
        let mut changed = example();
        let path = format!("{REQUEST}{member}");
        let (parent, name) = path.rsplit_once('/').expect("a member");
        changed.pointer_mut(parent).expect("there")[name] = value.clone();
        let found = difference(&network(example()), &network(changed));
        let effect = found.fields.first().map(|field| (field.mapping, field.consent));
        assert_eq!(effect, expected, "{member} = {value}");
        assert!(found.fields.len() <= 1);
        assert!(found.operations.is_empty() && found.relations.is_empty());
    }
}

#[test]
fn parts_come_change_and_go() {
    let old = network(example());
    assert!(difference(&old, &old).is_empty());
    let mut renamed = example();
    renamed["operationList"][0]["quantityUnit"] = json!("H87");
    assert!(difference(&old, &network(renamed)).is_empty());
    let mut changed = example();
    changed["name"] = json!("Other");
    changed["operationList"][0]["plannedQuantity"] = json!(13);
    changed["operationList"][0]["operationId"] = json!("MakeFrame2");
    changed["operationRelationList"][0]["predecessorOperationId"] = json!("MakeFrame2");
    let new = network(changed);
    let found = difference(&old, &new);
    assert!(found.is_description_changed);
    assert_eq!(found.operations.added, ["MakeFrame2".parse().expect("valid")]);
    assert_eq!(found.operations.removed, ["MakeFrame1".parse().expect("valid")]);
    assert_eq!(found.operations.changed, []);
    assert_eq!(found.relations.changed.len(), 1);
    assert_eq!((found.requests.added.len(), found.requests.removed.len()), (1, 1));
    let effects: Vec<_> = found.fields.iter().map(|field| (field.change, field.consent)).collect();
    assert_eq!(
        effects,
        [
            (FieldChange::Added, ConsentEffect::BackToPending),
            (FieldChange::Removed, ConsentEffect::Removed)
        ]
    );
    let back = difference(&new, &old);
    assert_eq!(back.operations.added, found.operations.removed);
}
