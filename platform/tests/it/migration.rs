//! Stores of before reports said to whom they were released.

use std::{path::Path, str::FromStr};

use access_log::{
    AccessAudit, AccessAuditor, AccessKind, AccessLogKey, AccessRetentionRule, access_log_verifier,
    audit::{AccessAuditLine, AccessAuditStart},
};
use asi_model::{DateTime, FactoryId, OperationNetworkId, RequestKey};
use platform::{
    accesses::{AccessStorage as _, Contents, Reading},
    store::{
        AccessQuery, AccessesKept, NewReport, ReportQuery, Scope, SeenWriter, Store,
        StoredAccessLog, Work, WritersWanted,
    },
};
use serde_json::json;
use sqlx::{
    Connection as _, SqlSafeStr as _, SqliteConnection,
    migrate::{Migration, MigrationType, Migrator},
    sqlite::SqliteConnectOptions,
};

use crate::harness::{opened, reader};

const BEFORE: [&str; 3] = [
    include_str!("../../migrations/sqlite/0001_house.sql"),
    include_str!("../../migrations/sqlite/0002_tools_by_publisher.sql"),
    include_str!("../../migrations/sqlite/0003_leases.sql"),
];

/// Organisation a asks F for two fields, one of which is open; b is a member, too. G was never
/// asked and reported all the same.
const ROWS: &str = "
    INSERT INTO organisation VALUES ('a', 'a', 0), ('b', 'b', 0);
    INSERT INTO factory (factory_id, organisation_id, name, created_at) VALUES ('F', 'b', 'F', 0), ('G', 'b', 'G', 0);
    INSERT INTO collaboration VALUES ('c', 'c', 0);
    INSERT INTO collaboration_member VALUES ('c', 'a'), ('c', 'b');
    INSERT INTO operation_network VALUES ('net', 'c', NULL, 1, '{network}', 0, 'u', NULL);
    INSERT INTO operation_network_revision VALUES ('net', 1, '{network}', 0, 'u');
    INSERT INTO network_part VALUES ('net', 'F', 1, 0, '{}', 'm', 'ACCEPTED', '[]', 0, 1, 0, 0);
    INSERT INTO request_field VALUES ('net', 'op', 'req', 'open', 'F', 0, 'MAPPED', NULL, NULL, 10),
        ('net', 'op', 'req', 'closed', 'F', 1, 'PENDING', NULL, NULL, 11);
    INSERT INTO request_recipient VALUES ('net', 'req', 'a');
    INSERT INTO report (factory_id, data_set_writer_id, epoch, sequence, operation_network_id, operation_id,
            dynamic_data_request_id, report_name, received_at, is_replay, fields)
        VALUES ('F', 1, 1, 7, 'net', 'op', 'req', 'r', 0, 0, '{}'), ('G', 1, 1, 8, 'net', 'op', 'req', 'r', 0, 0, '{}');
    INSERT INTO data_set_writer VALUES ('F', 1, 1, 7, '[]', 1, 0, 'net', 'req', 0, NULL, 0),
        ('G', 1, 1, 8, '[]', 1, 0, 'net', 'req', 0, NULL, 0);
    INSERT INTO writer_meta_data (factory_id, data_set_writer_id, received_at, body)
        VALUES ('F', 1, 5, '{\"Fields\":[{\"Name\":\"recipientList\"}]}'), ('G', 1, 6, '{\"Fields\":[]}');
    INSERT INTO field_value
        VALUES ('net', 'req', 'open', 'op', 1, 7, '1', 7, 0, NULL, NULL, 0),
            ('net', 'req', 'closed', 'op', 1, 7, '2', 7, 0, NULL, NULL, 0);";

async fn make_former_store(path: &Path) {
    let options = SqliteConnectOptions::from_str(&format!("sqlite://{}", path.display()))
        .expect("a path")
        .create_if_missing(true);
    let mut connection = SqliteConnection::connect_with(&options).await.expect("a file");
    let names = ["initial", "tools by publisher", "leases"];
    let migrations = (1..).zip(names).zip(BEFORE).map(|((version, name), sql)| {
        Migration::new(version, name.into(), MigrationType::Simple, sql.into_sql_str(), false)
    });
    Migrator::with_migrations(migrations.collect()).run(&mut connection).await.expect("migrated");
    let network = json!({ "operationNetworkId": "net", "operationList": [ { "operationId": "op",
        "operationType": "PRODUCTION", "owningFactoryId": "F", "dynamicDataRequestList": [
            { "dynamicDataRequestId": "req", "requesterId": "a", "recipientList": ["a"], "purpose": "p",
              "reportDataFormat": { "reportName": "r", "reportFieldList": [
                { "name": "open", "type": 7 }, { "name": "closed", "type": 7 } ] } } ] } ] });
    let rows = ROWS.replace("{network}", &network.to_string());
    sqlx::raw_sql(sqlx::AssertSqlSafe(rows)).execute(&mut connection).await.expect("stored");
    connection.close().await.expect("closed");
}

fn organisation(id: &str) -> Scope {
    Scope::Organisation(id.parse().expect("an id"))
}

async fn sequences(work: &mut Work, scope: &Scope) -> Vec<u32> {
    let query = ReportQuery { limit: 10, ..ReportQuery::default() };
    let reports = work.reports().list(scope, &query).await.expect("read");
    let reports = opened(reports).await;
    reports.iter().map(|report| report.sequence).collect()
}

#[tokio::test]
async fn what_was_stored_stays_with_those_who_could_read_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("store.sqlite");
    make_former_store(&path).await;
    let store = Store::open(&path).await.expect("it opens");
    let mut work = store.read().await.expect("begun");

    assert_eq!(sequences(&mut work, &organisation("a")).await, [7], "G was never asked");
    assert_eq!(sequences(&mut work, &organisation("b")).await, Vec::<u32>::new());
    let net: OperationNetworkId = "net".parse().expect("an id");
    let fields = work.fields().list(&organisation("a"), &net).await.expect("read");
    let fields = opened(fields).await;
    let values: Vec<_> =
        fields.iter().map(|field| field.current.as_ref().map(|value| &value.value)).collect();
    assert_eq!(values, [Some(&json!(1)), None], "a pending field has no value");

    let request = "req".parse().expect("an id");
    let recipients = work.recipients().of_request(&net, &request).await.expect("read");
    assert_eq!(recipients[0].consented_at, Some(DateTime::from_ticks(10)));
    for (factory, is_asked) in [("F", true), ("G", false)] {
        let factory: FactoryId = factory.parse().expect("an id");
        let found = work.asked_requests().is_asked(&net, &request, &factory).await.expect("read");
        assert_eq!(found, is_asked, "{factory}");
        // The metadata of one describes the member that names recipients.
        let names = work.factories().names_recipients(&factory).await.expect("read");
        assert_eq!(names, is_asked, "{factory}");
        let first = WritersWanted { after: None, limit: 100 };
        let writers =
            work.writers().of_factory(&organisation("a"), &factory, first).await.expect("read");
        assert_eq!(writers.len(), usize::from(is_asked), "{factory}");
        for SeenWriter { writer, is_whole, .. } in writers {
            let stated = (writer.sequences.through(), writer.received, is_whole);
            assert_eq!(stated, (Some(7), 1, false));
        }
    }
}

/// A report for nobody looks like one of before, but for its number.
#[tokio::test]
async fn what_is_for_nobody_later_stays_so() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("store.sqlite");
    make_former_store(&path).await;
    let store = Store::open(&path).await.expect("it opens");
    let mut work = store.begin().await.expect("begun");
    let report = NewReport {
        factory_id: "F".parse().expect("an id"),
        data_set_writer_id: 1,
        epoch: 1,
        sequence: 9,
        request: RequestKey {
            operation_network_id: "net".parse().expect("an id"),
            operation_id: "op".parse().expect("an id"),
            dynamic_data_request_id: "req".parse().expect("an id"),
        },
        report_name: "r".to_owned(),
        shopfloor_timestamp: None,
        report_timestamp: None,
        received_at: DateTime::from_ticks(20),
        is_replay: false,
        recipient_set: None,
        fields: Default::default(),
    };
    work.reports().add(&[report]).await.expect("stored");
    assert_eq!(sequences(&mut work, &organisation("a")).await, [7]);
    assert_eq!(sequences(&mut work, &Scope::Platform).await, [7, 8, 9]);
}

fn reading(at: i64) -> Reading {
    let request = RequestKey {
        operation_network_id: "net".parse().expect("an id"),
        operation_id: "op".parse().expect("an id"),
        dynamic_data_request_id: "req".parse().expect("an id"),
    };
    let factory = "F".parse().expect("an id");
    Reading {
        reader: reader("u"),
        kind: AccessKind::Looked,
        contents: Contents::gather([(&factory, &request, "open", None)]).remove(0),
        since: DateTime::from_ticks(at),
    }
}

/// Returns the numbers of F's accesses as an organisation sees them, newest first. F belongs to b.
async fn accesses(store: &Store, scope: &str) -> Vec<u64> {
    let mut work = store.read().await.expect("begun");
    let (factory, query) =
        ("F".parse().expect("an id"), AccessQuery { limit: 9, ..Default::default() });
    let listed = work.accesses().list(&organisation(scope), &factory, &query).await.expect("read");
    listed.iter().map(|listed| listed.entry.number).collect()
}

#[tokio::test]
async fn an_old_store_begins_to_record_accesses() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("store.sqlite");
    make_former_store(&path).await;
    let store = Store::open(&path).await.expect("it opens");
    assert_eq!(accesses(&store, "b").await, [] as [u64; 0]);
    store.append(&[reading(1)], DateTime::from_ticks(1)).await.expect("recorded");
    store.close().await;
    let store = Store::open(&path).await.expect("it opens again");
    store.append(&[reading(2)], DateTime::from_ticks(2)).await.expect("recorded");
    assert_eq!(accesses(&store, "b").await, [2, 1]);
    assert_eq!(accesses(&store, "a").await, [] as [u64; 0], "the log is the factory's");
}

#[tokio::test]
async fn old_accesses_are_forgotten_and_the_rest_still_follows_from_them() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("store.sqlite");
    make_former_store(&path).await;
    let store = Store::open(&path).await.expect("it opens");
    for at in 1..=6 {
        store.append(&[reading(at)], DateTime::from_ticks(at)).await.expect("recorded");
    }
    let factory: FactoryId = "F".parse().expect("an id");
    for (before, kept, limit, left) in [
        (1, 9, 10, &[6, 5, 4, 3, 2, 1][..]),
        (3, 9, 10, &[6, 5, 4, 3]),
        (9, 9, 1, &[6, 5, 4]),
        (1, 5, 10, &[6, 5, 4]),
        (1, 4, 10, &[6]),
        (1, 4, 10, &[6]),
        (9, 9, 10, &[]),
        (11, 9, 10, &[]),
    ] {
        let mut work = store.begin().await.expect("begun");
        let kept = AccessesKept { since: DateTime::from_ticks(before), count: kept };
        work.accesses().forget(kept, limit, DateTime::from_ticks(10)).await.expect("forgotten");
        work.commit().await.expect("committed");
        assert_eq!(accesses(&store, "b").await, left);
        let mut work = store.read().await.expect("begun");
        let stored = work.accesses().lookup(&factory).await.expect("read").expect("a log");
        let after = stored.removed.last_number();
        let texts = work.accesses().texts(&organisation("b"), &factory, after, 9).await;
        let audit = audit(&stored, texts.expect("read").into_iter().map(|(_, text)| text));
        assert!(audit.is_intact(), "{audit:?}");
        assert_eq!(audit.entries_removed, after);
    }
}

fn audit(stored: &StoredAccessLog, entries: impl Iterator<Item = String>) -> AccessAudit {
    let key = AccessLogKey::from_secret(&[1; 32]);
    let verifier = access_log_verifier(&"F".parse().expect("an id"), &key.public());
    let first = AccessAuditStart::of(&stored.log, &stored.removed, &key).line();
    let note = stored.log.sign_checkpoint(&key);
    let verifier = verifier.expect("a key");
    let mut auditor = AccessAuditor::new(&note, &verifier, &first).expect("it begins");
    entries.for_each(|entry| auditor.take(&AccessAuditLine { entry }.line()));
    auditor.finish()
}

/// A former version removed accesses and did not state it.
#[tokio::test]
async fn what_a_former_version_removed_is_stated_at_the_first_round() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("store.sqlite");
    make_former_store(&path).await;
    let store = Store::open(&path).await.expect("it opens");
    for at in 1..=3 {
        store.append(&[reading(at)], DateTime::from_ticks(at)).await.expect("recorded");
    }
    let factory: FactoryId = "F".parse().expect("an id");
    let kept = |since| AccessesKept { since: DateTime::from_ticks(since), count: 9 };
    let whole = store.read().await.expect("begun").accesses().lookup(&factory).await.expect("read");
    let mut work = store.begin().await.expect("begun");
    work.accesses().forget(kept(3), 9, DateTime::from_ticks(4)).await.expect("forgotten");
    work.commit().await.expect("committed");
    store.close().await;
    // As the former version left it: the statement is taken back.
    let options = SqliteConnectOptions::from_str(&format!("sqlite://{}", path.display()));
    let options = options.expect("a path");
    let mut connection = SqliteConnection::connect_with(&options).await.expect("a file");
    sqlx::query("UPDATE access_log SET last_number = 3, edge = ?")
        .bind(whole.expect("a log").log.edge())
        .execute(&mut connection)
        .await
        .expect("taken back");
    let statement = "DELETE FROM access_entry WHERE viewer_id = ''";
    sqlx::query(statement).execute(&mut connection).await.expect("taken back");
    connection.close().await.expect("closed");
    let store = Store::open(&path).await.expect("it opens");
    for _ in 0..2 {
        let mut work = store.begin().await.expect("begun");
        work.accesses().forget(kept(1), 9, DateTime::from_ticks(5)).await.expect("forgotten");
        work.commit().await.expect("committed");
        let mut work = store.read().await.expect("begun");
        let stored = work.accesses().lookup(&factory).await.expect("read").expect("a log");
        assert_eq!((stored.removed.last_number(), stored.log.last_number()), (2, 4));
        let texts = work.accesses().texts(&organisation("b"), &factory, 2, 9).await.expect("read");
        let audit = audit(&stored, texts.into_iter().map(|(_, text)| text));
        assert!(audit.is_intact(), "{audit:?}");
        let rule = audit.retention.map(|entry| entry.retention.rule);
        assert_eq!(rule, Some(AccessRetentionRule::FormerVersion));
    }
}
