//! Lists that a factory makes long come in pages, for all who may read them.

use serde_json::{Value, json};

use crate::{
    harness::{Api, World, eventually},
    story,
    witness::countersigned_epochs,
};

/// Reads a list to its end, so many entries a page; the pages.
async fn pages(api: &Api, path: &str, limit: usize) -> Vec<Vec<Value>> {
    let mut found = Vec::new();
    let mut cursor = String::new();
    loop {
        let page = api.get(&format!("{path}?limit={limit}{cursor}")).await.expect_ok();
        found.push(page["items"].as_array().expect("items").clone());
        let Some(next) = page["nextCursor"].as_str() else { return found };
        cursor = format!("&cursor={next}");
        assert!(found.len() < 1_000, "a list ends");
    }
}

fn writers(pages: &[Vec<Value>]) -> Vec<u64> {
    let writers = pages.iter().flatten().map(|item| item["dataSetWriterId"].as_u64());
    writers.map(|id| id.expect("an id")).collect()
}

#[tokio::test(flavor = "multi_thread")]
async fn the_writers_of_a_factory_come_in_pages() {
    let world = World::start().await;
    let (admin, buyer, munich, _hamburg) = story::accepted(&world).await;
    // More writers than a page may have, one of them with more gaps than it shows.
    let gap = |writer: u32, first: u32| {
        json!({ "messageType": "gap", "messageId": format!("gap-{writer}-{first}"), "factoryId": "FOR_MUC",
            "dataSetWriterId": writer, "epoch": 608_926_829, "firstSequence": first, "lastSequence": first,
            "cause": "COALESCED" })
    };
    for writer in 1..=101 {
        munich.send("gap", &gap(writer, 0));
    }
    for first in 1..=150 {
        munich.send("gap", &gap(101, 2 * first));
    }
    // Of three writers something is released to the buyer.
    for writer in [3, 5, 8] {
        let mut report = story::report(&format!("of-{writer}"), 1, writer);
        report["Messages"][0]["DataSetWriterId"] = json!(writer);
        munich.send("ua-data", &report);
    }
    let path = "/factories/FOR_MUC/writers";
    eventually("all has come", || async {
        let all = pages(&admin, path, 1_000).await;
        let count = all.last().and_then(|page| page.last()).map(|last| last["gapCount"].clone());
        let seen = buyer.get(path).await.expect_ok()["items"].as_array().map(Vec::len);
        if (&count, seen) == (&Some(json!(151)), Some(3)) {
            Ok(())
        } else {
            Err(format!("{count:?} {seen:?}"))
        }
    })
    .await;

    let whole = pages(&admin, path, 1_000).await;
    assert_eq!(whole.iter().map(Vec::len).collect::<Vec<_>>(), [100, 1], "however many are wanted");
    let gaps = whole[1][0]["gaps"].as_array().expect("gaps");
    let ends = [gaps.first(), gaps.last()].map(|gap| gap.expect("a gap")["firstSequence"].clone());
    assert_eq!((gaps.len(), ends), (100, [json!(102), json!(300)]), "the newest");
    let maker = story::planner(&world, "frames-munich").await;
    let few = pages(&maker, path, 7).await;
    assert!(few.iter().all(|page| page.len() <= 7));
    assert_eq!(writers(&few), (1..=101).collect::<Vec<_>>());
    let released = pages(&buyer, path, 2).await;
    assert_eq!(writers(&released), [3, 5, 8]);
    assert_eq!(released[0].len(), 2);
}

#[tokio::test(flavor = "multi_thread")]
async fn the_logs_of_a_ledger_come_in_pages() {
    let world = World::start().await;
    let (_, buyer, munich, _hamburg) = story::accepted(&world).await;
    countersigned_epochs(&munich, 1..=3).await;
    let found = pages(&buyer, "/factories/FOR_MUC/ledger-logs", 2).await;
    let epochs = found.iter().flatten().map(|item| item["epoch"].as_u64().expect("a number"));
    assert_eq!(epochs.collect::<Vec<_>>(), [1, 2, 3]);
    assert_eq!(found[0].len(), 2);
}
