use asi_model::{OperationNetworkId, OrganisationId, network::OperationNetwork};
use serde_json::json;

use super::*;
use crate::store::{Scope, visibility::viewers};

/// A chain of three factories as it was stored before networks had owners.
fn chain() -> serde_json::Value {
    let operation = |id: &str| json!({ "operationId": id, "operationType": "PRODUCTION", "owningFactoryId": format!("F-{id}") });
    let request = |id: &str, requester: &str| {
        json!({ "dynamicDataRequestId": id, "requesterId": requester, "recipientList": ["z"], "purpose": "p",
            "reportDataFormat": { "reportName": "r", "reportFieldList": [{ "name": "f", "type": 9 }] } })
    };
    let relation = |id: &str, from: &str, to: &str| {
        json!({ "operationRelationId": id, "relationType": "FINISH_TO_START",
            "predecessorOperationId": from, "successorOperationId": to })
    };
    let mut inspect = operation("d");
    inspect["operationType"] = json!("INSPECTION");
    inspect["inspectedOperationId"] = json!("a");
    inspect["dynamicDataRequestList"] = json!([request("of-c", "c")]);
    json!({ "operationNetworkId": "net", "operationList": [operation("a"), operation("b"), operation("c"), inspect],
        "operationRelationList": [relation("ab", "a", "b"), relation("bc", "b", "c")] })
}

async fn old_store(path: &Path) {
    let options = SqliteConnectOptions::new().filename(path).create_if_missing(true);
    let pool = SqlitePoolOptions::new().connect_with(options).await.expect("it opens");
    migrator(3).run(&pool).await.expect("the old form");
    let mut before = chain();
    before["operationList"][3]["dynamicDataRequestList"][0]["requesterId"] = json!("z");
    let mut statements = vec![
        "INSERT INTO collaboration VALUES ('k', 'k', 0)".to_owned(),
        format!(
            "INSERT INTO operation_network VALUES ('net', 'k', NULL, 2, '{}', 0, 'second', NULL)",
            chain()
        ),
        format!(
            "INSERT INTO operation_network VALUES ('other', 'k', NULL, 1, '{}', 0, 'gone', NULL)",
            json!({ "operationNetworkId": "other", "operationList": [] })
        ),
        format!("INSERT INTO operation_network_revision VALUES ('net', 1, '{before}', 0, 'first')"),
        format!(
            "INSERT INTO operation_network_revision VALUES ('net', 2, '{}', 0, 'second')",
            chain()
        ),
    ];
    for id in ["a", "b", "c", "d", "z"] {
        statements.insert(0, format!("INSERT INTO organisation VALUES ('{id}', '{id}', 0)"));
        statements.push(format!("INSERT INTO collaboration_member VALUES ('k', '{id}')"));
        if id != "z" {
            statements.push(format!(
                "INSERT INTO factory VALUES ('F-{id}', '{id}', '{id}', 0, NULL, NULL, NULL, NULL)"
            ));
            statements.push(format!("INSERT INTO collaboration_factory VALUES ('k', 'F-{id}')"));
        }
    }
    for (user, organisation) in [("first", "a"), ("second", "b")] {
        statements.push(format!(
            "INSERT INTO user_account VALUES ('{user}', '', 'PLANNER', '{organisation}', 0)"
        ));
    }
    for statement in statements {
        sqlx::query(sqlx::AssertSqlSafe(statement)).execute(&pool).await.expect("stored");
    }
    pool.close().await;
}

#[tokio::test]
async fn networks_of_before_get_the_owners_and_viewers_that_they_would_have_now() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("platform.sqlite");
    old_store(&path).await;
    let store = Store::open(&path).await.expect("it is brought to the new form");
    let mut work = store.read().await.expect("begun");
    let id: OperationNetworkId = "net".parse().expect("valid");
    let row = work.networks().lookup(&Scope::Platform, &id).await.expect("read").expect("there");
    // The first author drew it, not the last.
    assert_eq!(row.drawn_by.as_ref().map(OrganisationId::as_str), Some("a"));
    let requesters = work.ownership().requesters(&id).await.expect("read");
    assert_eq!(requesters.values().map(OrganisationId::as_str).collect::<Vec<_>>(), ["z"]);
    // The migration draws the same conclusions from a document as a new revision does.
    let network: OperationNetwork = serde_json::from_value(chain()).expect("a network");
    let mut owners = work.networks().owners(&row).await.expect("read");
    owners.drawn_by = None;
    let mut expected: Vec<_> = viewers(&network, &owners)
        .into_iter()
        .map(|(organisation, factory)| (organisation.to_string(), factory.to_string()))
        .collect();
    expected.sort();
    let rows: Vec<(String, String)> = work.ownership().stored_viewers(&id).await;
    assert_eq!(rows, expected);
    // Without a known author, only administrators own it.
    let id: OperationNetworkId = "other".parse().expect("valid");
    let other = work.networks().lookup(&Scope::Platform, &id).await.expect("read").expect("there");
    assert_eq!(other.drawn_by, None);
}

#[tokio::test]
async fn names_of_people_who_left_a_former_version_are_known_as_far_as_records_name_them() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("platform.sqlite");
    old_store(&path).await;
    let pool = SqlitePoolOptions::new()
        .connect_with(SqliteConnectOptions::new().filename(&path))
        .await
        .expect("it opens");
    migrator(43).run(&pool).await.expect("the form before");
    for statement in [
        "INSERT INTO audit_entry (recorded_at, agent_kind, agent_name, operation, subject, outcome, opaque_id)
         VALUES (0, 'USER', 'anna', 'signIn', 'users/anna/session', 'DONE', lower(hex(randomblob(16)))),
                (0, 'USER', 'first', 'signIn', 'users/first/session', 'DONE', lower(hex(randomblob(16)))),
                (0, 'TOOL', 'Scheduling', 'addDynamicDataRequest', '', 'DONE', lower(hex(randomblob(16)))),
                (0, 'USER', 'first', 'deleteUser', 'users/dora', 'DONE', lower(hex(randomblob(16)))),
                (0, 'COMMAND', 'root', 'forgetSecret', 'users/emil/second-factor', 'DONE', lower(hex(randomblob(16))))",
        "INSERT INTO comment (operation_network_id, factory_id, author_id, is_from_factory, text, created_at, opaque_id)
         VALUES ('net', 'F-a', 'bert', 0, '', 0, lower(hex(randomblob(16)))), ('net', 'F-a', 'engineer@F-a', 1, '', 0, lower(hex(randomblob(16))))",
        "INSERT INTO access_agent (factory_id, organisation_id, kind, name, agent_id)
         VALUES ('F-a', 'a', 'USER', 'carl', '1'), ('F-a', 'a', 'USER', 'second', '2'), ('F-a', 'a', 'TOOL', 'Planning', '3')",
        "UPDATE operation_network_revision SET created_by = 'tool.Planning' WHERE revision = 1",
    ] {
        sqlx::query(statement).execute(&pool).await.expect("stored");
    }
    pool.close().await;
    let store = Store::open(&path).await.expect("it is brought to the new form");
    let mut work = store.begin().await.expect("begun");
    for (name, has_left) in [
        ("anna", true),
        ("bert", true),
        // Named by who read values, by what was changed of them, and by a network.
        ("carl", true),
        ("dora", true),
        ("emil", true),
        ("gone", true),
        ("first", false),
        ("second", false),
        ("root", false),
        ("Scheduling", false),
        ("Planning", false),
        ("tool.Planning", false),
        ("engineer@F-a", false),
    ] {
        assert_eq!(work.users().has_left(name).await.expect("asked"), has_left, "{name}");
    }
    let entries = work.audit().list_after(&Scope::Platform, 0, 10).await.expect("listed");
    assert_eq!(entries.len(), 5);
    assert!(entries.iter().all(|entry| entry.detail.is_empty()), "{entries:?}");
}

#[tokio::test]
async fn reads_of_pages_leave_readers_to_sign_in_and_ingest() {
    let folder = tempfile::tempdir().expect("a folder");
    let store = Store::open(&folder.path().join("store.sqlite")).await.expect("it opens");
    let mut pages = Vec::new();
    for _ in 0..READERS_MAX {
        pages.push(store.read().await.expect("a reader"));
    }
    let soon = Duration::from_millis(200);
    assert!(tokio::time::timeout(soon, store.read()).await.is_err(), "pages hold all of theirs");
    let reserved = store.reserved_reader();
    let read = tokio::time::timeout(Duration::from_secs(2), reserved.read()).await;
    drop(read.expect("at once").expect("a reader"));
}

/// Reads for seconds, in one statement.
async fn reads_much(work: &mut Work, numbers: u64) -> Result<(), StoreError> {
    let sql =
        "WITH RECURSIVE numbers (n) AS (SELECT 1 UNION ALL SELECT n + 1 FROM numbers WHERE n < $1)
               SELECT SUM(n) FROM numbers";
    let read =
        sqlx::query(sql).bind(i64::try_from(numbers).expect("few")).fetch_all(work.connection());
    read.await.map(drop).map_err(StoreError::during("count"))
}

#[tokio::test]
async fn what_a_page_reads_for_too_long_ends_and_a_download_takes_its_time() {
    let folder = tempfile::tempdir().expect("a folder");
    let store = Store::open(&folder.path().join("store.sqlite")).await.expect("it opens");
    let pages = StoreReader { reads_max: Some(Duration::from_millis(100)), ..store.page_reader() };
    // As often as there are connections, so that each of them has been a page's.
    for _ in 0..READERS_MAX {
        let mut work = pages.read().await.expect("a reader");
        let ended = tokio::time::timeout(Duration::from_secs(20), reads_much(&mut work, 1 << 60));
        let error = ended.await.expect("it ends").expect_err("too much");
        assert!(matches!(error, StoreError::TooExpensive { action: "count" }), "{error:?}");
        let problem = daemon::web::Problem::from(error);
        assert_eq!((problem.status, &*problem.code), (503, "TOO_EXPENSIVE"));
    }
    let mut held = Vec::new();
    for _ in 0..READERS_MAX {
        let mut work = store.read().await.expect("a reader");
        tokio::time::sleep(Duration::from_millis(120)).await;
        reads_much(&mut work, 100_000).await.expect("no page's limit is left");
        held.push(work);
    }
}

#[tokio::test]
async fn whatever_the_api_reads_ends_after_seconds() {
    let folder = tempfile::tempdir().expect("a folder");
    let store = Store::open(&folder.path().join("store.sqlite")).await.expect("it opens");
    let store = crate::audit::RecordingStore::new(store, crate::clock::Clock::system());
    let mut work = store.read().await.expect("a reader");
    let ended = tokio::time::timeout(Duration::from_secs(30), reads_much(&mut work, 1 << 60));
    let error = ended.await.expect("it ends").expect_err("too much");
    assert!(matches!(error, StoreError::TooExpensive { .. }), "{error:?}");
}
