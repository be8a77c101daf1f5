//! Way from the shop floor to the mappings, also when nobody takes what they yield.

use std::{collections::HashMap, time::Duration};

use asi_model::{DataValue, DateTime, StatusCode};
use mapping_engine::{MappingEngine, MappingEngineConfig};
use serde_json::json;
use shop_floor::{InputChange, ShopFloor};
use tokio::time::timeout;
use tokio_util::sync::CancellationToken;

use crate::{
    bench::{Bench, PATIENCE, published},
    publishing::{chain, no_worker},
};

#[tokio::test]
async fn mappings_share_a_variable_and_late_comers_get_its_last_value() {
    let mut bench = Bench::start(&no_worker(), |_| {});
    let mut first = chain("first", &["a"], "Int32", json!([]));
    let mut second =
        chain("second", &["a"], "Int32", json!([{ "function": "scale", "factor": 2 }]));
    second.inputs[0].node_id = first.inputs[0].node_id.clone();
    first.mapping_id = mapping_engine::MappingId::new("first").expect("an id");
    bench.put(first).await;
    assert_eq!(bench.ask("first", 4_i32).await.value, 4_i32.into());
    bench.put(second).await;
    assert_eq!(bench.next("second").await.value.value, 8_i32.into(), "without a new change");
    bench.feed("first", "a", 5_i32).await;
    assert_eq!(bench.next("first").await.value.value, 5_i32.into());
    assert_eq!(bench.next("second").await.value.value, 10_i32.into());
    bench.remove("first").await;
    bench.stop().await;
}

#[tokio::test]
async fn a_stalled_consumer_stops_intake_and_loses_nothing() {
    let config = MappingEngineConfig {
        waiting_candidates_max: 100,
        waiting_batches_max: 1,
        ..Default::default()
    };
    let mut bench = Bench::start_with(config);
    bench.put(chain("m", &["a"], "Int32", json!([]))).await;
    let (changes, input) = (bench.changes(), bench.key("m", "a"));
    let change = |value: i32| InputChange {
        input,
        value: DataValue::good(value, DateTime::from_unix_micros(value.into())),
    };
    // Nobody takes, so the engine stops taking too and the channel fills.
    let mut fed = 0;
    while let Ok(sent) =
        timeout(Duration::from_millis(200), changes.send((fed..fed + 50).map(change).collect()))
            .await
    {
        sent.expect("the engine runs");
        fed += 50;
        assert!(fed < 10_000, "the engine takes without bound");
    }
    // It still answers, and what it took comes out in order.
    assert_eq!(bench.survey(None, 10).await.items.len(), 1);
    for expected in 0..fed {
        assert_eq!(bench.next("m").await.value.value, expected.into());
    }
    bench.stop().await;
}

#[tokio::test]
async fn many_mappings_are_put_at_once() {
    let mut bench = Bench::start(&no_worker(), |_| {});
    let count = 20_000;
    let begun = std::time::Instant::now();
    let mappings =
        (0..count).map(|n| published(chain(&format!("m{n}"), &["a"], "Int32", json!([]))));
    let put = bench.handle.put_many(mappings.collect()).await.expect("runs");
    assert!(put.iter().all(Result::is_ok));
    assert!(begun.elapsed() < Duration::from_secs(20), "{:?}", begun.elapsed());
    for n in [0, count / 2, count - 1] {
        assert_eq!(bench.ask(&format!("m{n}"), n).await.value, n.into());
    }
    bench.stop().await;
}

/// Runs on the real shop floor: a source that is not there is a status, not a silence.
#[tokio::test]
async fn a_source_that_is_not_there_is_said() {
    let folder = tempfile::tempdir().expect("a folder");
    let (shop_floor, floor, changes) =
        ShopFloor::new(shop_floor::Config::new(folder.path(), "test", "urn:test"));
    let (engine, handle, mut candidates) =
        MappingEngine::new(MappingEngineConfig::default(), floor, changes);
    let shutdown = CancellationToken::new();
    let running = [
        tokio::spawn(shop_floor.run(shutdown.clone())),
        tokio::spawn(engine.run(shutdown.clone())),
    ];
    let mappings = ["x", "y"].map(|id| published(chain(id, &["a"], "Int32", json!([]))));
    handle.put_many(mappings.into()).await.expect("runs");
    let mut statuses = HashMap::new();
    while statuses.len() < 2 {
        for candidate in
            timeout(PATIENCE, candidates.recv()).await.expect("in time").expect("the engine runs")
        {
            statuses.insert(candidate.target, candidate.value.status);
        }
    }
    assert!(
        statuses.values().all(|status| *status == StatusCode::BAD_NOT_CONNECTED),
        "{statuses:?}"
    );
    shutdown.cancel();
    for task in running {
        timeout(PATIENCE, task).await.expect("in time").expect("without a panic");
    }
}
