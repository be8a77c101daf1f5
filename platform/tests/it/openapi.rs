//! The committed description of the API is the one that the program gives.

use crate::harness::World;

#[test]
fn the_committed_description_is_fresh() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/openapi.json");
    let current = platform::api::openapi().to_pretty_json().expect("it serialises") + "\n";
    if std::env::var_os("UPDATE_OPENAPI").is_some() {
        std::fs::write(path, &current).expect("written");
    }
    let committed = std::fs::read_to_string(path).unwrap_or_default();
    assert!(
        committed == current,
        "platform/openapi.json is stale; run this test with UPDATE_OPENAPI=1"
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn the_description_is_served_and_unknown_routes_are_problems() {
    let world = World::start().await;
    let api = world.anonymous();
    let description = api.get("/openapi.json").await.expect_ok();
    let mut ids: Vec<String> = operation_ids(&description);
    let count = ids.len();
    ids.sort();
    ids.dedup();
    assert_eq!(ids.len(), count, "operation ids are unique");
    assert!(
        description["paths"]["/api/v1/operation-networks/{operationNetworkId}"]["put"].is_object()
    );
    api.get("/nothing").await.expect_problem(404, "UNKNOWN_ROUTE");
    api.call(reqwest::Method::PATCH, "/session", None)
        .await
        .expect_problem(405, "METHOD_NOT_ALLOWED");
}

fn operation_ids(description: &serde_json::Value) -> Vec<String> {
    let paths = description["paths"].as_object().expect("paths");
    let operations = paths
        .values()
        .filter_map(|methods| methods.as_object())
        .flat_map(|methods| methods.values());
    operations
        .map(|operation| operation["operationId"].as_str().expect("an id").to_owned())
        .collect()
}
