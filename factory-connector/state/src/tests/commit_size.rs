//! A commit costs what changed, not what exists.

use asi_model::messages::{OperationNetworkMessage, ValueSource};
use serde_json::json;

use crate::{
    Effects, Writes,
    scene::{Scene, network},
};

/// Returns the network with further requests, each with a field of its own.
fn network_beside(others: usize) -> OperationNetworkMessage {
    let mut message = serde_json::to_value(network(1, |_| ())).expect("serialises");
    let operation = &mut message["operationNetwork"]["operationList"][0];
    let requests = operation["dynamicDataRequestList"].as_array_mut().expect("a list");
    requests.extend((0..others).map(|number| {
        json!({ "dynamicDataRequestId": format!("Other{number}"), "requesterId": "acme",
            "recipientList": ["acme"], "purpose": "Plan", "updateFrequency": 1,
            "updateFrequencyUnit": "HOUR", "reportDataFormat": { "reportName": "Other",
            "reportFieldList": [{ "name": "made", "type": 9 }] } })
    }));
    serde_json::from_value(message).expect("a network")
}

/// Size of a commit: the writers that it changes and describes, the fields whose values it writes,
/// and the members of all rows and effects.
#[derive(Debug, PartialEq)]
struct Size {
    writers: usize,
    descriptions: usize,
    values: usize,
    reports: usize,
    members: usize,
}

impl Size {
    fn of((writes, effects): &(Writes, Effects)) -> Self {
        let controls = writes.controls.queued.iter();
        Self {
            writers: writes.writers.changed.len(),
            descriptions: controls.filter(|control| control.subject == "ua-metadata").count(),
            values: writes.fields.values.len(),
            reports: writes.reports.queued.len(),
            // Printed at length each member has a line of its own, also of rows that this test does
            // not name.
            members: format!("{writes:#?}\n{effects:#?}").lines().count(),
        }
    }
}

/// Commits one decision, then one value, and returns the sizes of both.
fn sizes_beside(others: usize) -> [Size; 2] {
    let mut scene = Scene::empty();
    scene.arrive(network_beside(others));
    scene.commit(0);
    assert_eq!(scene.state.writers().active().count(), others + 1);
    scene.map("made", ValueSource::Manual, "{}");
    let decided = Size::of(&scene.commit(1));
    scene.candidate("made", ValueSource::Manual, 1_u64, 2);
    [decided, Size::of(&scene.commit(2))]
}

#[test]
fn a_commit_writes_the_same_beside_a_thousand_other_requests() {
    let alone = sizes_beside(0);
    let [decided, released] = &alone;
    assert_eq!((decided.writers, decided.descriptions), (1, 1));
    assert_eq!((released.writers, released.descriptions), (1, 0));
    assert_eq!((released.values, released.reports), (1, 1));
    assert_eq!(sizes_beside(1_000), alone);
}
