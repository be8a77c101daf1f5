//! Surveys of all mappings, the worst first.

use asi_model::{DataValue, DateTime, StatusCode};
use mapping_engine::{HealthCounts, MappingHealth, MappingId, PublishRequest};
use serde_json::json;

use crate::{
    bench::{Bench, published},
    publishing::{chain, no_worker},
};

impl Bench {
    async fn ids(&self, wanted: Option<MappingHealth>, most: usize) -> Vec<String> {
        let survey = self.survey(wanted, most).await;
        survey.items.into_iter().map(|item| item.status.mapping_id.to_string()).collect()
    }
}

/// Seven mappings: one for each way of doing but that of scripts, and two more that do well.
async fn seven() -> Bench {
    let mut bench = Bench::start(&no_worker(), |_| {});
    let parse = json!([{ "function": "parse", "to": "Double" }]);
    for id in ["well-1", "well-2", "failing", "often", "doubtful", "ahead"] {
        bench.put(chain(id, &["a"], "Double", parse.clone())).await;
    }
    bench
        .put(chain(
            "waiting",
            &["a", "b"],
            "Double",
            json!([{ "function": "expression", "expression": "a + b" }]),
        ))
        .await;
    for (id, texts) in
        [("well-1", vec!["1"]), ("well-2", vec!["x", "2"]), ("failing", vec!["3", "x"])]
    {
        for text in texts {
            bench.ask(id, text).await;
        }
    }
    for text in ["x", "4", "x", "5", "y"] {
        bench.ask("often", text).await;
    }
    let uncertain = DataValue {
        status: StatusCode::UNCERTAIN,
        ..DataValue::good("6", DateTime::from_unix_micros(1))
    };
    bench.send("doubtful", "a", vec![uncertain]).await;
    bench.next("doubtful").await;
    let tomorrow =
        DateTime::from(std::time::SystemTime::now() + std::time::Duration::from_secs(86_400));
    bench.send("ahead", "a", vec![DataValue::good("7", tomorrow)]).await;
    bench.next("ahead").await;
    bench.feed("waiting", "a", 8.0).await;
    bench
}

#[tokio::test]
async fn the_worst_come_first() {
    let bench = seven().await;
    let survey = bench.survey(None, 100).await;
    let counts = HealthCounts {
        failing: 2,
        waiting: 1,
        doubtful: 1,
        clock_ahead: 1,
        well: 2,
        ..HealthCounts::default()
    };
    assert_eq!(survey.counts, counts);
    assert_eq!(
        bench.ids(None, 100).await,
        ["often", "failing", "waiting", "doubtful", "ahead", "well-2", "well-1"],
        "and of two alike the one with more faults"
    );
    assert_eq!(survey.items[0].status, bench.status("often").await);
    for id in ["often", "waiting", "ahead"] {
        let known = survey
            .items
            .iter()
            .find(|item| item.status.mapping_id.as_str() == id)
            .expect("it is there");
        assert_eq!(bench.health(id).await, known.health);
    }
    bench.stop().await;
}

#[tokio::test]
async fn a_survey_returns_at_most_as_many_as_asked_for() {
    let bench = seven().await;
    assert_eq!(bench.ids(None, 3).await, ["often", "failing", "waiting"]);
    assert_eq!(bench.ids(Some(MappingHealth::Well), 1).await, ["well-2"]);
    assert_eq!(bench.ids(Some(MappingHealth::CircuitOpen), 9).await, Vec::<String>::new());
    let none = bench.survey(Some(MappingHealth::Failing), 0).await;
    assert_eq!((none.items.len(), none.counts.failing), (0, 2), "all are counted nevertheless");
    bench.stop().await;
}

#[tokio::test]
async fn a_mapping_is_well_again_after_a_fault_and_shadow_mappings_are_left_out() {
    let mut bench = seven().await;
    assert_eq!(bench.ask("failing", "9").await.value, 9.0.into());
    assert_eq!(bench.health("failing").await, MappingHealth::Well);
    // Both in one batch, at one time: what came last counts.
    bench.feed_all("well-1", "a", ["x", "2"].map(asi_model::Variant::from)).await;
    assert_eq!(bench.next("well-1").await.value.status, StatusCode::BAD_DECODING_ERROR);
    assert_eq!(bench.next("well-1").await.value.value, 2.0.into());
    assert_eq!(bench.health("well-1").await, MappingHealth::Well);
    bench.feed_all("well-1", "a", ["3", "x"].map(asi_model::Variant::from)).await;
    assert_eq!(bench.next("well-1").await.value.value, 3.0.into());
    bench.next("well-1").await;
    assert_eq!(bench.health("well-1").await, MappingHealth::Failing);

    let mut shadow = chain("often", &["a"], "Double", json!([]));
    shadow.mapping_id = MappingId::new("often.shadow").expect("an id");
    bench.publish(PublishRequest { is_shadow: true, ..published(shadow) }).await;
    assert_eq!(bench.ids(None, 100).await.len(), 7);
    bench.stop().await;
}
