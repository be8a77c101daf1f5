//! The record of who read a factory's values: each way to read leaves an entry, nothing else does,
//! only the factory's organisation sees it, and what is changed in it is found.

use std::str::FromStr;

use access_log::AccessAuditor;
use reqwest::Method;
use serde_json::{Value, json};
use sqlx::{Connection as _, SqliteConnection, sqlite::SqliteConnectOptions};

use crate::{
    connector::Peer,
    harness::{Api, World, eventually},
    story::{self, NETWORK},
};

const ACCESSES: &str = "/factories/FOR_MUC/accesses";

/// The entries, newest first.
async fn accesses(maker: &Api) -> Vec<Value> {
    let page = maker.get(ACCESSES).await.expect_ok();
    page["items"].as_array().expect("a list").clone()
}

/// Ways of the entries, oldest first.
async fn kinds(maker: &Api) -> Vec<String> {
    let entries = accesses(maker).await;
    entries.iter().rev().map(|entry| entry["access"].as_str().expect("a way").to_owned()).collect()
}

/// A value of FOR_MUC that nobody has read.
async fn unread(world: &World) -> (Api, Api, Peer) {
    let (_admin, buyer, munich, _hamburg) = story::accepted(world).await;
    let maker = story::planner(world, "frames-munich").await;
    munich.send("ua-data", &story::report("m1", 0, 3));
    eventually("the report", || async {
        let writers = maker.get("/factories/FOR_MUC/writers").await.expect_ok();
        if writers["items"][0]["received"] == 1 { Ok(()) } else { Err(writers.to_string()) }
    })
    .await;
    assert_eq!(accesses(&maker).await, [] as [Value; 0], "nobody read the value");
    (buyer, maker, munich)
}

#[tokio::test(flavor = "multi_thread")]
async fn each_way_to_read_leaves_an_entry_and_nothing_else_does() {
    let world = World::start().await;
    let (buyer, maker, munich) = unread(&world).await;
    // None of these has values, for want of rights or by their nature.
    let stranger = story::planner(&world, "stranger").await;
    let admin = world.admin().await;
    for api in [&stranger, &maker, &admin] {
        for path in [&story::network_path(), "/reports", "/reports?newest=true", "/factories"] {
            api.get(path).await;
        }
    }
    for path in ["/operation-networks", "/factories/FOR_MUC/writers", "/status"] {
        buyer.get(path).await.expect_ok();
    }
    assert_eq!(kinds(&maker).await, [] as [&str; 0]);

    let view = buyer.get(&story::network_path()).await.expect_ok();
    assert_eq!(kinds(&maker).await, ["LOOKED"]);
    buyer.get("/reports").await.expect_ok();
    assert_eq!(kinds(&maker).await, ["LOOKED", "EXPORTED"]);
    let mut live = buyer.live(view["lastEventId"].as_str()).await;
    munich.send("ua-data", &story::report("m2", 1, 4));
    live.next("value").await;
    assert_eq!(kinds(&maker).await, ["LOOKED", "EXPORTED", "STREAMED"]);
    live.next("progress").await;
    let streamed = &accesses(&maker).await[0];
    assert_eq!((&streamed["viewer"], &streamed["role"]), (&json!("acme-aero"), &json!("PLANNER")));
    assert_eq!(streamed["fields"], json!(["progressStatus"]));
    assert_eq!(streamed["valueCount"], 1);
    assert_eq!(streamed["dynamicDataRequestId"], "ReqResponse1");
    assert_eq!(streamed["valuesTo"], "2019-04-18T18:20:05Z", "{streamed}");
}

#[tokio::test(flavor = "multi_thread")]
async fn the_newest_of_the_history_is_looked_at() {
    let world = World::start().await;
    let (buyer, maker, _munich) = unread(&world).await;
    buyer.get("/reports?newest=true").await.expect_ok();
    assert_eq!(kinds(&maker).await, ["LOOKED"]);
}

#[tokio::test(flavor = "multi_thread")]
async fn progress_alone_is_an_access_to_the_fields_behind_it() {
    let world = World::start().await;
    let (buyer, maker, munich) = unread(&world).await;
    let start = maker.get(&story::network_path()).await.expect_ok();
    munich.send("ua-data", &story::report("m2", 1, 4));
    let mut live = buyer.live(start["lastEventId"].as_str()).await;
    live.next("progress").await;
    let entries = accesses(&maker).await;
    assert_eq!((entries.len(), &entries[0]["access"]), (1, &json!("STREAMED")), "{entries:?}");
}

#[tokio::test(flavor = "multi_thread")]
async fn what_a_tool_is_sent_is_an_entry_of_the_same_transaction() {
    let world = World::start().await;
    let mut network = story::network();
    network["operationList"][0]["dynamicDataRequestList"][0] =
        story::request_of_tool("ReqResponse1", "acme-aero", "Monitoring");
    let admin = story::set_up(&world).await;
    let tool =
        json!({ "toolId": "Monitoring", "organisationId": "acme-aero", "name": "Monitoring" });
    admin.post("/tools", tool).await.expect_ok();
    let credential = admin.post("/tools/Monitoring/credentials", json!({})).await.expect_ok();
    let tool = Peer::tool(&credential, "Monitoring");
    let buyer = story::planner(&world, "acme-aero").await;
    let munich = Peer::enrolled(&world, &admin, "FOR_MUC").await;
    story::put_network(&buyer, network).await;
    munich.accept(&munich.receive("operation-network", |_| true).await);
    munich.send("decision", &story::decision("MAPPED", None));
    story::state_is(&buyer, "MAPPED").await;
    munich.send("ua-data", &story::report("m1", 0, 3));
    munich.send("ua-data", &story::report("m2", 1, 4));
    tool.receive("ua-data", |message| message["MessageId"] == "m2").await;
    world.handle().application.accesses.settle().await.expect("recorded");

    let maker = story::planner(&world, "frames-munich").await;
    let entries = accesses(&maker).await;
    assert!(entries.iter().all(|entry| entry["access"] == "FORWARDED"), "{entries:?}");
    assert_eq!(
        (&entries[0]["agentKind"], &entries[0]["agentName"]),
        (&json!("TOOL"), &Value::Null)
    );
    assert_eq!(entries[0]["viewer"], "acme-aero");
    let count: u64 = entries.iter().filter_map(|entry| entry["valueCount"].as_u64()).sum();
    let fields = entries[0]["fields"].as_array().map_or(0, Vec::len) as u64;
    assert_eq!(count, 2 * fields, "{entries:?}");
}

#[tokio::test(flavor = "multi_thread")]
async fn reads_that_go_on_are_counted() {
    let world = World::start().await;
    let (buyer, maker, _munich) = unread(&world).await;
    for _ in 0..20 {
        buyer.get(&story::network_path()).await.expect_ok();
    }
    let opened = accesses(&maker).await;
    assert_eq!((opened.len(), &opened[0]["valueCount"]), (1, &json!(1)), "{opened:?}");
    world.handle().application.accesses.settle().await.expect("recorded");
    let summed = accesses(&maker).await;
    assert_eq!((summed.len(), &summed[0]["valueCount"]), (2, &json!(19)), "{summed:?}");
    assert_eq!(summed[0]["agentId"], summed[1]["agentId"]);
}

#[tokio::test(flavor = "multi_thread")]
async fn the_factory_sees_who_read_and_names_only_of_its_own() {
    let world = World::start().await;
    let (buyer, maker, munich) = unread(&world).await;
    buyer.get(&story::network_path()).await.expect_ok();
    // The maker asks its own factory as well.
    let path = format!("/operation-networks/{NETWORK}/operations/MakeFrame1/requests");
    maker.post(&path, story::request("Own", "frames-munich")).await.expect_ok();
    munich.accept(&munich.receive("operation-network", |part| part["revision"] == 2).await);
    let mut report = story::report_to(&["frames-munich"], "m3", 0, 3);
    report["Messages"][0]["DataSetWriterId"] = json!(3);
    report["Messages"][0]["Payload"]["dynamicDataRequestId"]["Body"] = json!("Own");
    munich.send("ua-data", &report);
    eventually("the own report", || async {
        let reports = maker.get("/reports").await.expect_ok();
        if reports["items"][0].is_object() { Ok(()) } else { Err(reports.to_string()) }
    })
    .await;
    let entries = accesses(&maker).await;
    let names: Vec<_> =
        entries.iter().map(|entry| (&entry["viewer"], &entry["agentName"])).collect();
    let own = json!("frames-munich-planner");
    assert_eq!(names, [(&json!("frames-munich"), &own), (&json!("acme-aero"), &Value::Null)]);
    assert!(!entries[1].to_string().contains("planner"), "{entries:?}");

    for (filter, count) in [
        ("viewer=acme-aero", 1),
        ("request=Own", 1),
        ("network=other", 0),
        ("cursor=2", 1),
        ("limit=1", 1),
    ] {
        let page = maker.get(&format!("{ACCESSES}?{filter}")).await.expect_ok();
        assert_eq!(page["items"].as_array().map(Vec::len), Some(count), "{filter}: {page}");
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn nobody_else_learns_of_an_access() {
    let world = World::start().await;
    let (buyer, maker, _munich) = unread(&world).await;
    buyer.get(&story::network_path()).await.expect_ok();
    let viewer = world.sign_in("frames-munich-viewer", crate::harness::PASSWORD).await;
    assert_eq!(accesses(&viewer).await, accesses(&maker).await);
    let admin = world.admin().await;
    let hamburg = story::planner(&world, "inspect-hamburg").await;
    let stranger = story::planner(&world, "stranger").await;
    for api in [&buyer, &admin, &hamburg, &stranger] {
        for path in ["", "/checkpoint", "/audit", "?viewer=acme-aero"] {
            api.get(&format!("{ACCESSES}{path}")).await.expect_problem(404, "NOT_FOUND");
        }
    }
    // A factory without an access looks the same to them.
    hamburg.get("/factories/INS_HAM/accesses").await.expect_ok();
    buyer.get("/factories/INS_HAM/accesses").await.expect_problem(404, "NOT_FOUND");
}

/// Audits the export against a checkpoint; the number of entries proven, or the faults.
async fn audit(maker: &Api, checkpoint: &Value) -> Result<u64, String> {
    let path = format!("/api/v1{ACCESSES}/audit");
    let file = maker.client.call(Method::GET, &path, None).await.expect("an answer").text;
    let mut lines = file.lines();
    let text = |name: &str| checkpoint[name].as_str().expect("a text").to_owned();
    let key = text("verifierKey").parse().expect("a key");
    let first = lines.next().expect("a line");
    let mut auditor =
        AccessAuditor::new(&text("checkpoint"), &key, first).map_err(|error| error.to_string())?;
    lines.for_each(|line| auditor.take(line));
    let audit = auditor.finish();
    if audit.is_intact() { Ok(audit.entries_proven) } else { Err(format!("{audit:?}")) }
}

async fn checkpoint(world: &World, maker: &Api) -> Value {
    world.handle().application.accesses.settle().await.expect("signed");
    maker.get(&format!("{ACCESSES}/checkpoint")).await.expect_ok()
}

#[tokio::test(flavor = "multi_thread")]
async fn the_log_goes_on_after_a_restart_and_what_is_changed_is_found() {
    let mut world = World::start().await;
    let (buyer, maker, _munich) = unread(&world).await;
    let before = maker.get(&format!("{ACCESSES}/checkpoint")).await.expect_ok();
    assert_eq!(before["checkpoint"], Value::Null);
    buyer.get(&story::network_path()).await.expect_ok();
    buyer.get("/reports").await.expect_ok();
    let kept = checkpoint(&world, &maker).await;
    assert_eq!(audit(&maker, &kept).await, Ok(2));

    world.restart().await;
    let buyer = story::planner(&world, "acme-aero").await;
    let maker = story::planner(&world, "frames-munich").await;
    buyer.get("/reports").await.expect_ok();
    let later = checkpoint(&world, &maker).await;
    assert_eq!(later["verifierKey"], kept["verifierKey"]);
    assert_eq!(audit(&maker, &kept).await, Ok(2), "a part is proven by the older one");
    assert_eq!(audit(&maker, &later).await, Ok(3));

    let path = world.handle().application.config.database_path();
    for change in [
        "UPDATE access_entry SET content = replace(content, 'acme-aero', 'acme-aero2') WHERE number = 1",
        "UPDATE access_entry SET content = replace(content, 'LOOKED', 'STREAMED') WHERE number = 1",
        "DELETE FROM access_entry WHERE number = 3;
         UPDATE access_log SET last_number = 2, edge = (SELECT edge FROM former)",
        "UPDATE access_log SET start = replace(start, 'logId\":\"', 'logId\":\"0')",
        "UPDATE access_entry SET content = replace(content, '\"valueCount\":1', '\"valueCount\":0') WHERE number = 2",
    ] {
        world.stop().await;
        let backup = path.with_extension("backup");
        std::fs::copy(&path, &backup).expect("copied");
        tamper(&path, change).await;
        world.restart().await;
        let maker = story::planner(&world, "frames-munich").await;
        let found = audit(&maker, &later).await;
        assert!(found.is_err(), "{change}: {found:?}");
        world.stop().await;
        std::fs::copy(&backup, &path).expect("copied back");
    }
}

async fn tamper(path: &std::path::Path, change: &str) {
    let options = SqliteConnectOptions::from_str(&format!("sqlite://{}", path.display()));
    let options = options.expect("a path").foreign_keys(false);
    let mut connection = SqliteConnection::connect_with(&options).await.expect("a file");
    // Any edge of a log of two entries: what is exported follows from the entries.
    let former = "CREATE TEMP TABLE former AS SELECT randomblob(64) AS edge;";
    let statements = format!("{former}{change}");
    sqlx::raw_sql(sqlx::AssertSqlSafe(statements)).execute(&mut connection).await.expect("changed");
    connection.close().await.expect("closed");
}

/// Each table of values is read in one module, whose functions withhold them.
#[test]
fn values_are_read_in_no_other_module() {
    let tables = [
        // Releases of the past read the sets of recipients alone.
        // `report_history.rs` makes the statement that `reports.rs` runs.
        ("report", &["reports.rs", "report_history.rs", "past_releases.rs"][..]),
        // Decisions remove values; the summary of networks has the time of the last one alone.
        ("field_value", &["fields.rs", "decisions.rs", "networks.rs"]),
        // What was left behind is removed without being looked at.
        ("inbox_message", &["inbox.rs", "left_behind.rs"]),
    ];
    let mut folders = vec![std::path::PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/src"))];
    let mut count = 0;
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            let text = std::fs::read_to_string(&path).expect("a text");
            let words: Vec<&str> = text.split(|c: char| !c.is_alphanumeric() && c != '_').collect();
            for (table, modules) in tables {
                let is_read = words
                    .windows(2)
                    .any(|pair| ["FROM", "JOIN"].contains(&pair[0]) && pair[1] == table);
                let name = path.file_name().and_then(|name| name.to_str()).expect("a name");
                assert!(!is_read || modules.contains(&name), "{} reads {table}", path.display());
                count += usize::from(is_read);
            }
        }
    }
    assert!(count >= 4, "only {count} modules read values");
}

#[tokio::test(flavor = "multi_thread")]
async fn more_than_anybody_looks_at_is_exported() {
    let world = World::start().await;
    let (buyer, maker, _munich) = unread(&world).await;
    buyer.get("/reports?newest=true&limit=300").await.expect_ok();
    assert_eq!(kinds(&maker).await, ["LOOKED"]);
    buyer.get("/reports?newest=true&limit=1000").await.expect_ok();
    assert_eq!(kinds(&maker).await, ["LOOKED", "EXPORTED"]);
}
