//! Removals leave nothing but what others have a right to. The tables are those of the database itself: a new one
//! fails here until it is said what becomes of its rows.

use std::collections::{BTreeMap, BTreeSet};

use asi_model::DateTime;
use platform::store::{
    Leaver,
    RemainingRecords::{
        self, Accesses, Audit, Comments, LedgerLogs, Networks, Reports, Revocations,
    },
    Store,
};

use crate::schema::{Database, Table};

/// Columns that say whose a row is, with what they say in these tables; without any in all.
type Traces = &'static [Trace];
/// Columns of rows that stay, with the kind of records that the answer names; none where nothing of what happened stays.
type Kept = &'static [(&'static str, Option<RemainingRecords>)];

/// A leaver, and what is checked of it.
struct Case {
    leaver: Leaver,
    traces: Traces,
    /// Tables with what is in force, which has to be ended first.
    in_force: &'static [&'static str],
    kept: Kept,
}

fn id<T: std::str::FromStr<Err: std::fmt::Debug>>(text: &str) -> T {
    text.parse().expect("valid")
}

fn factory() -> Case {
    Case {
        leaver: Leaver::Factory(id("F")),
        traces: &[
            ("factory_id", "F", &[]),
            ("holder_id", "F", &[]),
            ("address", "factory.F.ingress", &["dead_letter", "inbox_message", "kept_of_sender"]),
            ("address", "factory.F.requests", &["dead_letter", "outbox"]),
            ("address", "factory.F.leases", &["dead_letter", "outbox"]),
            ("user_name", "factory.F", &["revoked_access"]),
            ("agent_name", "F", &[]),
        ],
        in_force: &["collaboration_factory"],
        kept: &[
            // Its id, which is never given again.
            ("factory.factory_id", None),
            // Numbers of what is kept.
            ("kept_of_sender.address", None),
            ("report.factory_id", Some(Reports)),
            ("former_report_recipients.factory_id", Some(Reports)),
            ("asked_request.factory_id", Some(Networks)),
            ("network_part.factory_id", Some(Networks)),
            ("network_viewer.factory_id", Some(Networks)),
            ("request_field.factory_id", Some(Networks)),
            ("comment.factory_id", Some(Comments)),
            ("revocation.factory_id", Some(Revocations)),
            ("ledger_log.factory_id", Some(LedgerLogs)),
            ("access_agent.factory_id", Some(Accesses)),
            ("access_entry.factory_id", Some(Accesses)),
            ("access_log.factory_id", Some(Accesses)),
            ("audit_entry.agent_name", Some(Audit)),
        ],
    }
}

fn tool() -> Case {
    Case {
        leaver: Leaver::Tool(id("T")),
        traces: &[
            ("tool_id", "T", &[]),
            ("holder_id", "T", &[]),
            ("address", "tool.T.requests", &["dead_letter", "inbox_message", "kept_of_sender"]),
            ("address", "tool.T.reports", &["dead_letter", "outbox"]),
            ("user_name", "tool.T", &["revoked_access"]),
            ("agent_name", "T", &[]),
        ],
        in_force: &[],
        kept: &[("tool.tool_id", None), ("audit_entry.agent_name", Some(Audit))],
    }
}

fn person() -> Case {
    Case {
        leaver: Leaver::User("U".to_owned()),
        traces: &[
            ("user_name", "U", &[]),
            ("agent_name", "U", &[]),
            ("author_id", "U", &[]),
            ("updated_by", "U", &[]),
            ("created_by", "U", &[]),
        ],
        in_force: &[],
        kept: &[
            // Accounts of the broker, which are no people.
            ("revoked_access.user_name", None),
            // Its name, which is never given again.
            ("former_user.user_name", None),
            ("audit_entry.agent_name", Some(Audit)),
            ("comment.author_id", Some(Comments)),
            ("operation_network.updated_by", Some(Networks)),
            ("operation_network_revision.created_by", Some(Networks)),
            ("seen_revision.updated_by", Some(Networks)),
        ],
    }
}

fn organisation() -> Case {
    Case {
        leaver: Leaver::Organisation(id("O")),
        traces: &[
            ("organisation_id", "O", &[]),
            ("author_organisation", "O", &[]),
            ("concerned_id", "O", &[]),
            ("share", "O", &[]),
            ("drawn_by", "O", &[]),
            ("requester_id", "O", &[]),
            ("viewer_id", "O", &[]),
        ],
        in_force: &["collaboration_member", "factory", "tool"],
        kept: &[
            ("organisation.organisation_id", None),
            ("recipient_set_member.organisation_id", Some(Reports)),
            // The releases of a factory to it.
            ("past_release.organisation_id", Some(Reports)),
            ("named_recipient.organisation_id", Some(Networks)),
            ("operation_drawer.organisation_id", Some(Networks)),
            ("operation_network.author_organisation", Some(Networks)),
            ("operation_network.drawn_by", Some(Networks)),
            ("request_recipient.organisation_id", Some(Networks)),
            ("request_requester.requester_id", Some(Networks)),
            // What it changed of what others see.
            ("seen_revision.author_organisation", Some(Networks)),
            ("ledger_log.organisation_id", Some(LedgerLogs)),
            ("access_agent.organisation_id", Some(Accesses)),
            ("access_entry.viewer_id", Some(Accesses)),
            ("audit_entry.concerned_id", Some(Audit)),
            ("audit_entry.organisation_id", Some(Audit)),
            ("audit_entry.share", Some(Audit)),
        ],
    }
}

/// Rows of a table in which a trace is.
type Found = BTreeMap<(String, &'static str, &'static str), i64>;

type Trace = (&'static str, &'static str, &'static [&'static str]);

fn traces_in(case: &Case, table: &Table) -> Vec<Trace> {
    let is_there = |(column, _, tables): &Trace| {
        table.has(column) && (tables.is_empty() || tables.contains(&table.name.as_str()))
    };
    case.traces.iter().copied().filter(is_there).collect()
}

async fn found(database: &mut Database, case: &Case) -> Found {
    let mut found = Found::new();
    for table in database.tables.clone() {
        for (column, value, _) in traces_in(case, &table) {
            let count = database.count(&table.name, column, value).await;
            found.insert((table.name.clone(), column, value), count);
        }
    }
    found
}

async fn check(case: Case) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("store.sqlite");
    let mut database = Database::make(&path).await;
    let kind = if matches!(case.leaver, Leaver::Tool(_)) { "TOOL" } else { "FACTORY" };
    for table in database.tables.clone() {
        // Triggers count what is kept.
        if case.in_force.contains(&table.name.as_str()) || table.name == "kept_of_sender" {
            continue;
        }
        for (column, value, _) in traces_in(&case, &table) {
            let values = [(column, value), ("holder_kind", kind), ("state", "SENT")];
            database.insert(&table, &values).await;
        }
    }
    let before = found(&mut database, &case).await;
    assert!(before.values().filter(|count| **count > 0).count() > 5, "{before:?}");
    database.close().await;

    let store = Store::open(&path).await.expect("it opens");
    let mut work = store.begin().await.expect("begun");
    work.removals().leave(&case.leaver, DateTime::from_ticks(7)).await.expect("it leaves");
    while work.removals().clear(1).await.expect("cleared") > 0 {}
    if let Leaver::Factory(_) = case.leaver {
        let overdue = work.parts().overdue(DateTime::from_ticks(i64::MAX), 10).await;
        assert_eq!(overdue.expect("read"), [], "nothing is sent to it again");
    }
    work.commit().await.expect("committed");
    store.close().await;

    let mut database = Database::open(&path).await;
    let left: BTreeSet<String> = found(&mut database, &case)
        .await
        .into_iter()
        .filter(|(_, count)| *count > 0)
        .map(|((table, column, _), _)| format!("{table}.{column}"))
        .collect();
    let expected = case.kept.iter().map(|(column, _)| (*column).to_owned()).collect();
    assert_eq!(left, expected, "of {:?}", case.leaver);
    let said = case.leaver.remaining_records();
    for kind in case.kept.iter().filter_map(|(_, kind)| *kind) {
        assert!(said.contains(&kind), "{kind:?} of {:?}", case.leaver);
    }
}

#[tokio::test]
async fn a_factory_leaves_nothing_but_what_others_have_a_right_to() {
    check(factory()).await;
}

#[tokio::test]
async fn a_tool_leaves_nothing_but_what_others_have_a_right_to() {
    check(tool()).await;
}

#[tokio::test]
async fn a_person_leaves_nothing_but_what_others_have_a_right_to() {
    check(person()).await;
}

#[tokio::test]
async fn an_organisation_leaves_nothing_but_what_others_have_a_right_to() {
    check(organisation()).await;
}

/// A column by another name would not be looked at above.
#[tokio::test]
async fn whose_a_row_is_says_a_column_that_is_looked_at() {
    let folder = tempfile::tempdir().expect("a folder");
    let database = Database::make(&folder.path().join("store.sqlite")).await;
    let cases = [factory(), tool(), person(), organisation()];
    let others = [
        // Kind of a holder, its lease as a document, and which side of a comment speaks.
        "broker_credential.holder_kind",
        "comment.is_from_factory",
        "lease.holder",
        // Places of a browser, and what it and an authenticator call themselves and the person.
        "passkey.user_handle",
        "session.address",
        "session.user_agent",
    ];
    let words = ["factory", "tool", "organisation", "user", "holder", "address", "author"];
    for table in &database.tables {
        for column in &table.columns {
            let name = column.name.as_str();
            let is_whose = words.iter().any(|word| name.contains(word));
            let is_looked_at = cases
                .iter()
                .any(|case| traces_in(case, table).iter().any(|(column, ..)| *column == name));
            let is_other = others.contains(&format!("{}.{name}", table.name).as_str());
            assert!(!is_whose || is_looked_at || is_other, "{}.{name} is in no case", table.name);
        }
    }
}

/// Tables whose rows count against the room of the sender in the store.
const COUNTED: [&str; 6] =
    ["inbox_message", "ledger_log", "outbox", "past_release", "report", "sequence_gap"];
/// Tables of what a factory or tool sends or makes grow whose rows do not, since a quota of their own keeps them
/// small, or since each needs a row that counts.
const BOUNDED: [&str; 18] = [
    // By quotas of docs/fair-shares.md.
    "asset_offer",
    "comment",
    "data_set_writer",
    "dead_letter",
    "revocation",
    "writer_meta_data",
    // One row of a report each, at most.
    "former_report_recipients",
    "writer_recipient_set",
    // What members and administrators make.
    "asked_request",
    "collaboration_factory",
    "enrolment_token",
    "factory",
    "network_part",
    "network_viewer",
    "request_field",
    // One row, or few.
    "access_log",
    "lease",
    "signing_key",
];
/// Tables about who reads, which have a bound of their own; the count itself; and the places of sign-ins.
const OTHERS: [&str; 4] = ["access_agent", "access_entry", "kept_of_sender", "session"];

#[tokio::test]
async fn what_a_sender_makes_grow_counts_against_its_room_or_has_a_quota() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut database = Database::make(&folder.path().join("store.sqlite")).await;
    let mut counted = Vec::new();
    for table in database.tables.clone() {
        let is_of_sender = table.has("factory_id") || table.has("address");
        if !is_of_sender || OTHERS.contains(&table.name.as_str()) {
            continue;
        }
        let values = [
            ("factory_id", "F"),
            (
                "address",
                if table.name == "outbox" { "factory.F.requests" } else { "factory.F.ingress" },
            ),
            ("correlation_id", "c"),
        ];
        database.insert(&table, &values).await;
        let (number, bytes) = database.kept("factory.F.ingress").await;
        if number == 0 {
            assert!(BOUNDED.contains(&table.name.as_str()), "{} has no bound", table.name);
            continue;
        }
        assert!(number == 1 && bytes >= 200, "{}: {bytes} bytes", table.name);
        counted.push(table.name.clone());
        database.empty(&table.name).await;
        assert_eq!(database.kept("factory.F.ingress").await, (0, 0), "{}", table.name);
    }
    assert_eq!(counted, COUNTED);
}

#[tokio::test]
async fn answers_that_wait_count_for_who_asked() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut database = Database::make(&folder.path().join("store.sqlite")).await;
    let messages =
        database.tables.iter().find(|table| table.name == "outbox").expect("one").clone();
    for (to, of) in [
        ("factory.F_1.requests", "factory.F_1.ingress"),
        ("factory.F_1.leases", "factory.F_1.ingress"),
        ("tool.T-1.reports", "tool.T-1.requests"),
    ] {
        database.insert(&messages, &[("address", to), ("correlation_id", "c")]).await;
        assert_eq!(database.kept(of).await.0, 1, "{to}");
        // What is no answer is nothing that it asked for.
        database.insert(&messages, &[("address", to)]).await;
        assert_eq!(database.kept(of).await.0, 1, "{to}");
        database.empty("outbox").await;
        assert_eq!(database.kept(of).await, (0, 0), "{to}");
    }
}
