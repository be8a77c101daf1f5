//! Publishing, replacing, withdrawing, and what comes back with candidates.

use asi_model::{DataValue, DateTime, StatusCode, Variant};
use mapping_engine::{
    EngineError, Mapping, MappingEngineConfig, MappingId, PublishRequest, ScriptRuntime, Step,
    TransformState,
};
use serde_json::json;

use crate::bench::{Bench, Worker, mapping_id, published, script_mapping, target_of};

/// Worker that is not there: no test of this kind needs a script.
pub fn no_worker() -> Worker {
    Worker { engine: ScriptRuntime::QuickJs, path: "/nonexistent".into(), deno: None }
}

pub fn chain(id: &str, inputs: &[&str], target: &str, steps: serde_json::Value) -> Mapping {
    let mut mapping = script_mapping(id, inputs, target, "(v) => v");
    mapping.steps = serde_json::from_value::<Vec<Step>>(steps).expect("steps");
    mapping
}

#[tokio::test]
async fn values_become_candidates_with_status_and_time() {
    let mut bench = Bench::start(&no_worker(), |_| {});
    let steps = json!([{ "function": "scale", "factor": 0.5 }]);
    bench.put(chain("half", &["a"], "Double", steps)).await;
    let time = DateTime::from_unix_micros(1_700_000_000_000_000);
    let value = DataValue { status: StatusCode::UNCERTAIN, ..DataValue::good(7_i32, time) };
    bench
        .send("half", "a", vec![DataValue { server_timestamp: Some(time), ..value.clone() }])
        .await;
    let candidate = bench.next("half").await;
    assert_eq!(
        candidate.value,
        DataValue { value: 3.5.into(), server_timestamp: Some(time), ..value }
    );
    assert_eq!(candidate.target, target_of(&mapping_id("half")));
    assert_eq!(candidate.state, None, "nothing is remembered");
    let status = bench.status("half").await;
    assert_eq!(status.received, 1);
    assert_eq!(status.yielded, 1);
    assert_eq!(status.faults, 0);
    bench.stop().await;
}

#[tokio::test]
async fn state_comes_with_the_last_candidate_of_a_batch_and_goes_back_in() {
    let mut bench = Bench::start(&no_worker(), |_| {});
    let counter = || chain("count", &["a"], "UInt64", json!([{ "function": "counter" }]));
    bench.put(counter()).await;
    bench.feed_all("count", "a", [10_u64, 12, 15].map(Variant::from)).await;
    let mut candidates = Vec::new();
    for _ in 0..3 {
        candidates.push(bench.next("count").await);
    }
    let last = candidates.pop().expect("three came");
    assert_eq!(last.value.value, 5_u64.into());
    let state = last.state.expect("the last one carries it");
    bench.stop().await;

    let json = serde_json::to_string(&state).expect("serialises");
    assert_eq!(json, r#"[{"function":"counter","total":5,"last":15,"level":null}]"#);
    let state: TransformState = serde_json::from_str(&json).expect("reads back");
    let mut bench = Bench::start(&no_worker(), |_| {});
    bench.publish(PublishRequest { state: Some(state), ..published(counter()) }).await;
    assert_eq!(bench.ask("count", 20_u64).await.value, 10_u64.into());
    bench.stop().await;
}

#[tokio::test]
async fn wrong_mappings_are_rejected_with_everything_and_right_ones_put_all_the_same() {
    let mut bench = Bench::start(&no_worker(), |_| {});
    let wrong =
        chain("wrong", &["a", "a"], "Int32", json!([{ "function": "scale", "divisor": 0 }]));
    let right = chain("right", &["a"], "Int32", json!([]));
    let put = bench.handle.put_many(vec![published(wrong), published(right)]).await.expect("runs");
    let Err(EngineError::Rejected(found)) = &put[0] else { panic!("{put:?}") };
    let pointers: Vec<&str> = found.iter().map(|d| d.pointer.as_str()).collect();
    assert_eq!(pointers, ["/inputs/1/name", "/steps/0/divisor"]);
    assert!(put[1].as_ref().is_ok_and(Vec::is_empty), "{put:?}");
    assert_eq!(bench.ask("right", 4_i32).await.value, 4_i32.into());
    assert_eq!(bench.survey(None, 10).await.items.len(), 1);
    bench.remove("right").await;
    assert_eq!(bench.survey(None, 10).await.items.len(), 0);
    bench.stop().await;
}

#[tokio::test]
async fn a_shadow_runs_on_live_values_and_yields_nothing() {
    let mut bench = Bench::start(&no_worker(), |_| {});
    bench.put(chain("m", &["a"], "Int32", json!([]))).await;
    let mut shadow = chain(
        "m",
        &["a"],
        "Int32",
        json!([{ "function": "expression", "expression": "value * 2" }]),
    );
    shadow.mapping_id = MappingId::new("m.shadow").expect("an id");
    bench.publish(PublishRequest { is_shadow: true, ..published(shadow) }).await;
    assert_eq!(bench.ask("m", 5_i32).await.value, 5_i32.into());
    assert_eq!(bench.ask("m", 6_i32).await.value, 6_i32.into());
    let status = bench.status("m.shadow").await;
    assert_eq!((status.received, status.yielded), (2, 2));
    assert_eq!(status.last_candidate.map(|candidate| candidate.value), Some(json!(12)));
    bench.stop().await;
}

#[tokio::test]
async fn what_came_in_is_recorded_and_can_be_tried_on() {
    let mut bench = Bench::start(&no_worker(), |_| {});
    let counter = || chain("count", &["a"], "UInt64", json!([{ "function": "counter" }]));
    bench.put(counter()).await;
    for value in [10_u64, 12, 15] {
        bench.ask("count", value).await;
    }
    let recorded = bench.handle.recorded(counter().inputs).await.expect("runs");
    assert_eq!(recorded.len(), 3);
    let last = |trace: mapping_engine::Trace| {
        trace.runs.last().and_then(|run| run.candidate.clone()).expect("a value")
    };
    let trace = bench.dry_run(counter(), recorded.clone(), None).await;
    assert_eq!(trace.runs.len(), 3);
    assert_eq!(last(trace).value, json!("5"));
    // As if it had run before: it goes on counting from there.
    let state: TransformState =
        serde_json::from_str(r#"[{"function":"counter","total":40,"last":14,"level":null}]"#)
            .expect("a state");
    let trace = bench.dry_run(counter(), vec![recorded[2].clone()], Some(state)).await;
    assert_eq!(last(trace).value, json!("41"));
    // Another version goes on with what was recorded.
    bench.put(chain("count", &["a"], "UInt64", json!([]))).await;
    assert_eq!(bench.handle.recorded(counter().inputs).await.expect("runs").len(), 3);
    assert!(
        bench
            .handle
            .recorded(chain("x", &["b"], "UInt64", json!([])).inputs)
            .await
            .expect("runs")
            .is_empty()
    );
    bench.stop().await;
}

#[tokio::test]
async fn what_was_recorded_outlasts_a_restart_for_dry_runs_alone() {
    let mut bench = Bench::start(&no_worker(), |_| {});
    let counter = || chain("count", &["a"], "UInt64", json!([{ "function": "counter" }]));
    bench.put(counter()).await;
    for value in [10_u64, 12, 15] {
        bench.ask("count", value).await;
    }
    assert!(bench.handle.recordings(0).await.expect("runs").is_empty());
    let recordings = bench.handle.recordings(2).await.expect("runs");
    assert_eq!(recordings.len(), 1, "one variable");
    assert_eq!(recordings[0].values.len(), 2, "its newest two");
    let before = bench.handle.recorded(counter().inputs).await.expect("runs");
    bench.stop().await;

    let mut bench = Bench::start_after(MappingEngineConfig::default(), recordings);
    assert!(bench.handle.recorded(counter().inputs).await.expect("runs").is_empty());
    bench.put(counter()).await;
    let recorded = bench.handle.recorded(counter().inputs).await.expect("runs");
    assert_eq!(recorded, before[1..]);
    // What the machine said before is not what it says: nothing came in yet.
    assert_eq!(bench.status("count").await.received, 0);
    bench.ask("count", 20_u64).await;
    assert_eq!(bench.status("count").await.received, 1);
    assert_eq!(bench.handle.recorded(counter().inputs).await.expect("runs").len(), 3);
    bench.stop().await;
}

#[tokio::test]
async fn a_mapping_is_replaced_in_place() {
    let mut bench = Bench::start(&no_worker(), |_| {});
    bench.put(chain("m", &["a"], "Int32", json!([]))).await;
    assert_eq!(bench.ask("m", 4_i32).await.value, 4_i32.into());
    let doubled = json!([{ "function": "expression", "expression": "value * 2" }]);
    bench.put(chain("m", &["a"], "Int32", doubled)).await;
    assert_eq!(
        bench.next("m").await.value.value,
        8_i32.into(),
        "it speaks at once about what is known"
    );
    assert_eq!(bench.ask("m", 5_i32).await.value, 10_i32.into());
    assert_eq!(bench.survey(None, 10).await.items.len(), 1);
    bench.stop().await;
}

#[tokio::test]
async fn debounce_and_windows_wake_by_themselves() {
    let mut bench = Bench::start(&no_worker(), |_| {});
    bench
        .put(chain("calm", &["a"], "Int32", json!([{ "function": "debounce", "quietMs": 20 }])))
        .await;
    let counting = json!([{ "function": "window", "aggregate": "count", "durationMs": 30 }]);
    bench.put(chain("count", &["a"], "Int64", counting)).await;
    assert_eq!(bench.ask("calm", 4_i32).await.value, 4_i32.into());
    assert_eq!(bench.ask("count", 4_i32).await.value, 1_i64.into());
    assert_eq!(bench.next("count").await.value.value, 0_i64.into());
    bench.stop().await;
}
