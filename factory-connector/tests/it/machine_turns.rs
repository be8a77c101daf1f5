//! Requests of people to machines: few at a time, and each person's by themselves.

use futures::future::{join, join_all};
use reqwest::Method;
use serde_json::json;

use crate::plant::Plant;

const PASSWORD: &str = "vera looks at machines";

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn who_browses_without_end_is_refused_and_others_go_on() {
    let plant = Plant::start(json!([{ "name": "progressStatus", "type": 9 }])).await;
    plant.put("/users/vera", json!({ "role": "VIEWER", "password": PASSWORD })).await;
    let vera = plant.signed_in("vera", PASSWORD).await.expect("vera may come in");
    let nodes = "/sources/Mill1/nodes";
    let search = "/sources/Mill1/search?text=identification%20model";
    plant.until("the variables are listed", search, |page| page["isComplete"] == true).await;
    let flood = (0..100).map(|number| {
        let path = if number % 2 == 0 { nodes } else { search };
        vera.call(Method::GET, path, None)
    });
    let others = async {
        let mut answers = Vec::new();
        for _ in 0..5 {
            answers.push(plant.call(Method::GET, nodes, None).await.0.as_u16());
        }
        answers
    };
    let (answers, others) = join(join_all(flood), others).await;
    let count = |wanted| answers.iter().filter(|(status, _)| status.as_u16() == wanted).count();
    assert_eq!(count(200) + count(429), 100, "{answers:?}");
    assert!(count(200) >= 4 && count(429) >= 20, "{} answered", count(200));
    assert_eq!(others, [200; 5]);
    // A refusal is over with the requests that caused it.
    assert_eq!(vera.call(Method::GET, "/sources/Belt1/nodes", None).await.0.as_u16(), 200);
}
