use std::collections::BTreeMap;

use proptest::{collection::vec, prelude::*};
use serde_json::{Value as Json, json};

use super::*;
use crate::exchange::{TemplateFault, TemplateParameter, numbers, read_table, write_table};

fn any_step() -> impl Strategy<Value = Json> {
    prop::sample::select(vec![
        json!({"function": "scale", "factor": 0.1, "divisor": 3, "offset": -2}),
        json!({"function": "constant", "value": {"type": "UInt64", "value": "18446744073709551615"}}),
        json!({"function": "convert", "to": "String", "rounding": "halfEven", "overflow": "clamp"}),
        json!({"function": "lookup", "entries": [{"from": "a\"b,;\n", "to": 1}], "otherwise": 0.5}),
        json!({"function": "counter", "modulus": 65536, "onDecrease": "set", "resetBy": "b"}),
        json!({"function": "window", "aggregate": "mean", "durationMs": 60000}),
        json!({"function": "script", "source": "(v, ctx) => {\n  return `${v}`;\n}"}),
        json!({"function": "merge", "rule": "firstGood", "inputs": ["a", "b"]}),
        json!({"function": "deadband"}),
    ])
}

fn any_input() -> impl Strategy<Value = Json> {
    let plain = "[a-z]{1,3}".prop_map(
        |id| json!({"name": "input", "sourceId": "press", "nodeId": format!("nsu=urn:x;s={id}")}),
    );
    let rich = "[a-z]{1,3}".prop_map(|id| {
        json!({"name": id, "sourceId": "press", "nodeId": "i=7", "valueType": "Int64", "unit": "H87", "triggers": false,
               "monitor": {"samplingIntervalMs": 50.0, "browsePath": ["nsu=urn:x;Press"]}})
    });
    prop_oneof![plain, rich]
}

prop_compose! {
    fn any_mapping()(
        id in "[!-~äß]{1,12}",
        name in "[A-Za-z_][A-Za-z0-9_.-]{0,8}",
        network in "[!-~ ]{1,8}",
        inputs in vec(any_input(), 0..3),
        steps in vec(any_step(), 0..4),
        unit in prop::option::of("[A-Z0-9]{2,3}"),
        rank in prop::sample::select(vec![-1, 1, 2]),
        late in prop::sample::select(vec!["ignore", "use"]),
    ) -> Mapping {
        let mut json = json!({
            "mappingId": id, "targetType": "UInt64", "targetValueRank": rank, "lateValues": late,
            "inputs": inputs, "steps": steps,
            "target": { "operationNetworkId": network, "operationId": "o", "dynamicDataRequestId": "r", "fieldName": name },
        });
        if let Some(unit) = unit {
            json["targetUnit"] = unit.into();
        }
        serde_json::from_value(json).expect("a mapping")
    }
}

proptest! {
    #[test]
    fn tables_come_back(mappings in vec(any_mapping(), 0..6)) {
        prop_assert_eq!(read_table(&write_table(&mappings)), Ok(mappings));
    }

    #[test]
    fn files_come_back(mappings in vec(any_mapping(), 0..6)) {
        let file = MappingFile::new(Vec::new(), mappings);
        prop_assert_eq!(MappingFile::read(&file.write()).expect("reads"), file);
    }

    #[test]
    fn a_mapping_made_a_template_comes_back(mapping in any_mapping(), value in "[a-z]{2,4}") {
        let values = BTreeMap::from([("p".to_owned(), value)]);
        // Words of the format itself are no good parameters: they would be replaced wherever they
        // stand.
        let is_word = serde_json::to_string(&mapping).expect("serialises").matches(values["p"].as_str()).count() > 0;
        prop_assume!(!is_word);
        let template = MappingTemplate::from_mapping("t", &mapping, &values);
        prop_assert_eq!(template.fill(&values), Ok(mapping));
    }
}

#[test]
fn gaps_of_a_template_are_not_filled_with_further_gaps() {
    let mapping = serde_json::from_value(json!({ "mappingId": "m", "target": {
        "operationNetworkId": "n", "operationId": "o", "dynamicDataRequestId": "r",
        "fieldName": "f" }, "targetType": "Double", "inputs": [ { "name": "x",
        "sourceId": "Press12", "nodeId": "nsu=urn:x;s=zz" } ], "steps": [] }))
    .expect("a mapping");
    // The longest value counts.
    let two = [("machine", "Press12"), ("short", "Press1")];
    let two: BTreeMap<String, String> =
        two.into_iter().map(|(name, value)| (name.to_owned(), value.to_owned())).collect();
    let template = MappingTemplate::from_mapping("t", &mapping, &two);
    assert_eq!(template.mapping["inputs"][0]["sourceId"], "${machine}");
    // Each name has the value of all twice: before, 40 of them were a text of a terabyte.
    let many: BTreeMap<String, String> =
        (0..40).map(|index| (format!("zz{index}"), "z".to_owned())).collect();
    let template = MappingTemplate::from_mapping("t", &mapping, &many);
    assert_eq!(template.mapping["inputs"][0]["nodeId"], "nsu=urn:x;s=${zz0}${zz0}");
}

#[test]
fn a_table_reads_as_people_write_it() {
    let text = "mappingId;fieldName;operationNetworkId;operationId;dynamicDataRequestId;targetType;sourceId;nodeId\r\n\
                m1;progress;net;op;req;UInt64;press;nsu=urn:press;s=Counter\r\n";
    // The separator stands within a cell: it must be quoted, and the fault says where.
    let faults = read_table(text).expect_err("a cell too many");
    assert_eq!(faults[0].column, "nodeId");
    let text = text.replace("nsu=urn:press;s=Counter", "\"nsu=urn:press;s=Counter\"");
    let mappings = read_table(&text).expect("a table");
    assert_eq!(mappings[0].inputs[0].node_id.to_string(), "nsu=urn:press;s=Counter");
    assert_eq!(mappings[0].target.to_string(), "net/op/req/progress");
}

#[test]
fn everything_wrong_with_a_table_is_said() {
    let text = "mappingId,operationNetworkId,operationId,dynamicDataRequestId,fieldName,targetType,nodeId,sourceId,steps\n\
                ,n,o,r,f,UInt64,,,\n\
                m,n,o,r,1st,Nothing,x,press,[{\n";
    let faults = read_table(text).expect_err("wrong");
    let places: Vec<(usize, &str)> =
        faults.iter().map(|fault| (fault.line, fault.column.as_str())).collect();
    assert_eq!(
        places,
        [(2, "mappingId"), (3, "fieldName"), (3, "targetType"), (3, "nodeId"), (3, "steps")]
    );
    let faults = read_table("mappingId,colour\n").expect_err("wrong");
    assert_eq!(faults.len(), 6);
}

#[test]
fn templates_fill_series() {
    let template = MappingTemplate {
        template_id: "press".to_owned(),
        name: None,
        description: None,
        parameters: ["n", "factor"]
            .map(|name| TemplateParameter {
                name: name.to_owned(),
                description: None,
                default: (name == "factor").then(|| "0.5".to_owned()),
            })
            .into(),
        mapping: json!({
            "mappingId": "press-${n:2}", "targetType": "Double",
            "target": { "operationNetworkId": "n", "operationId": "MakeFrame${n}", "dynamicDataRequestId": "r", "fieldName": "f" },
            "inputs": [{ "name": "a", "sourceId": "press${n:2}", "nodeId": "nsu=urn:press;s=Counter" }],
            "steps": [{ "function": "scale", "factor": "${factor}" }, { "function": "script", "source": "(v) => `$${v}`" }],
        }),
    };
    let sets: Vec<_> = numbers("1..2,10")
        .expect("numbers")
        .into_iter()
        .map(|n| BTreeMap::from([("n".to_owned(), n.to_string())]))
        .collect();
    let mappings = template.fill_all(&sets).expect("fills");
    let ids: Vec<&str> = mappings.iter().map(|mapping| mapping.mapping_id.as_str()).collect();
    assert_eq!(ids, ["press-01", "press-02", "press-10"]);
    assert_eq!(mappings[2].inputs[0].source_id.as_str(), "press10");
    assert_eq!(
        serde_json::to_value(&mappings[0].steps).expect("serialises"),
        json!([{ "function": "scale", "factor": 0.5, "divisor": 1, "offset": 0 }, { "function": "script", "source": "(v) => `${v}`" }])
    );
    assert_eq!(
        template.fill(&BTreeMap::new()),
        Err(TemplateFault::MissingParameter("n".to_owned()))
    );
    let unknown =
        BTreeMap::from([("n".to_owned(), "1".to_owned()), ("m".to_owned(), "1".to_owned())]);
    assert_eq!(template.fill(&unknown), Err(TemplateFault::UnusedValue("m".to_owned())));
    assert_eq!(numbers("5..2"), None);
    assert_eq!(numbers("0..4294967295"), None);
}
