//! Previews: the message that a decision would let out.

use std::sync::Arc;

use asi_model::{
    DataValue,
    messages::ValueSource,
    pubsub::json::{Encoding, encode_data_set_message},
};
use serde_json::{Value, json};

use crate::{
    queries::{draft_frame, draft_gate},
    scene::{Scene, at, field, network},
    use_cases::values::release_due,
};

/// Returns the text of a report without its numbers and the time at which it was made.
fn without_numbers(report: &str) -> String {
    let mut report: Value = serde_json::from_str(report).expect("JSON");
    for member in ["SequenceNumber", "MetaDataVersion", "Timestamp"] {
        assert!(!report[member].is_null(), "{member}: {report}");
        report[member] = Value::Null;
    }
    report.to_string()
}

/// The field stands between two others of its request, of which one is mapped after it.
#[test]
fn a_preview_is_the_message_that_then_leaves() {
    for policy in ["{}", r#"{"roundingStep":10}"#, r#"{"timeStepMs":60000}"#] {
        let mut scene = Scene::empty();
        scene.arrive(network(1, |request| {
            request["reportDataFormat"]["reportFieldList"] = json!([
                { "name": "made", "type": 9, "unit": "PIECE" },
                { "name": "scrap", "type": 9, "unit": "PIECE" },
                { "name": "refused", "type": 12 },
                { "name": "note", "type": 12 },
            ]);
        }));
        for name in ["made", "note"] {
            scene.map(name, ValueSource::Manual, "{}");
        }
        scene.offer("made", 7_u64, 1);
        scene.offer("note", "well", 2);

        let value = DataValue::good(17_u64, at(30_000));
        let draft = Arc::new(serde_json::from_str(policy).expect("a policy"));
        let mut gate =
            draft_gate(&scene.state, &field("scrap"), draft, at(30_000)).expect("a field");
        gate.on(at(30_000), value);
        let until = gate.due();
        until.into_iter().for_each(|due| gate.on_time(due));
        let frame = draft_frame(&scene.state, &field("scrap"), &gate, at(30_000));
        let previewed = encode_data_set_message(&frame.expect("a message"), Encoding::Digicor);

        scene.map("scrap", ValueSource::Manual, policy);
        scene.commit(30_000);
        let mut left = scene.offer("scrap", 17_u64, 30_000);
        if let Some(due) = until {
            assert_eq!(left, Vec::<Value>::new(), "{policy}");
            release_due(&mut scene.state, due);
            let (writes, _) = scene.commit(60_000);
            let bodies = writes.reports.queued.iter().map(|report| report.body.parse());
            left = bodies.collect::<Result<_, _>>().expect("JSON");
        }
        let [left] = &left[..] else { panic!("{policy}: {left:?}") };
        let members: Vec<&String> = left["Payload"].as_object().expect("members").keys().collect();
        assert_eq!(members[6..], ["made", "madeUnit", "scrap", "scrapUnit", "note"], "{policy}");
        assert_eq!(without_numbers(&previewed), without_numbers(&left.to_string()), "{policy}");
    }
}
