//! Tables of the rules of form: walls between the modules of a package, packages that are pure, and
//! types of the connector that may be larger than others. Shared by the test and the program for developers.

use house_rules::{Exemption, SharedName, Wall};

/// Packages that a connector is made of, whose types have bounds.
pub const CONNECTOR: &[&str] = &[
    "factory-connector",
    "connector-state",
    "disclosure",
    "ledger",
    "twin",
    "mapping-engine",
    "mapping",
    "messaging",
    "shop-floor",
    "spool",
];

/// Types of the connector that may have more fields or methods.
pub const LARGE_TYPES: &[Exemption] = &[];

/// Packages of the tests, whose types no product code meets.
pub const TEST_PACKAGES: &[&str] =
    &["verbund-tests", "testkit", "free-ports", "house-rules", "tampering"];

const fn shared(name: &'static str, reason: &'static str) -> SharedName {
    SharedName { name, reason }
}

/// Names that several types share although a package meets both.
pub const SHARED_NAMES: &[SharedName] = &[
    shared(
        "Enumeration",
        "a DataType of OPC UA Part 3, and the function of a mapping that reads one",
    ),
    shared("Fault", "the member of a message, and the mapping's own; both are schemas of APIs"),
    shared("FaultKind", "the kinds of a script's fault are part of those of a mapping's"),
    shared(
        "NodeClass",
        "OPC UA Part 3: all classes in a NodeSet, and those that a page tells apart",
    ),
    shared("Role", "a user's role on the pages, and the role of a session, OPC UA Part 18"),
];

const fn wall(
    package: &'static str,
    from: &'static str,
    to: &'static str,
    reason: &'static str,
) -> Wall {
    Wall { package, from, to, reason }
}

/// Packages that are state machines and plain data: what they yield follows from what they are
/// given, so that tests play any time and any chance.
pub const PURE: &[&str] = &[
    "asi-model",
    "mapping",
    "disclosure",
    "ledger",
    "connector-state",
    "spool",
    "shop-floor-model",
    "transparency-log",
    "access-log",
];

const TASKS: &str = "a pure package is run by others and waits for nothing";
const ROWS: &str = "a pure package knows no database; the store writes what it yields";
const CLOCK: &str = "time is an argument";
const CHANCE: &str = "ids and salts come from the caller or a seeded source";
const MACHINE: &str = "a pure package touches no files, network, processes or environment";

/// Paths that no pure package imports. `uuid` and `time` are allowed, their clocks are not.
const IMPURE: &[(&str, &str)] = &[
    ("::tokio", TASKS),
    ("::std::thread", TASKS),
    ("::sqlx", ROWS),
    ("::rusqlite", ROWS),
    ("::std::time::SystemTime::now", CLOCK),
    ("::std::time::Instant", CLOCK),
    ("::time::OffsetDateTime::now_utc", CLOCK),
    ("::time::OffsetDateTime::now_local", CLOCK),
    ("::time::UtcDateTime::now", CLOCK),
    ("::uuid::Timestamp::now", CLOCK),
    ("::uuid::Uuid::now_v1", CLOCK),
    ("::uuid::Uuid::now_v6", CLOCK),
    ("::uuid::Uuid::now_v7", CLOCK),
    ("::uuid::Uuid::new_v4", CHANCE),
    ("::rand", CHANCE),
    ("::getrandom", CHANCE),
    ("::std::fs", MACHINE),
    ("::std::net", MACHINE),
    ("::std::process", MACHINE),
    ("::std::env", MACHINE),
];

/// Returns all walls: those of the table below and those of the pure packages.
pub fn walls() -> Vec<Wall> {
    let pure = PURE
        .iter()
        .flat_map(|&package| IMPURE.iter().map(move |&(to, reason)| wall(package, "", to, reason)));
    WALLS.iter().copied().chain(pure).collect()
}

/// Walls inside packages: the first module and those below it never import the second.
const WALLS: &[Wall] = &[
    wall("asi-model", "opcua_json", "pubsub", "values know no message"),
    wall("connector-state", "use_cases", "transaction", "a use case does not commit"),
    wall("factory-connector", "store", "api", "rows know no HTTP"),
    wall("factory-connector", "store", "coordinator", "rows know no task"),
    wall("factory-connector", "store", "link_adapter", "rows know no link"),
    wall("factory-connector", "store", "service", "rows know no program"),
    wall("factory-connector", "coordinator", "service", "the coordinator is started by it"),
    wall("factory-connector", "coordinator", "link_adapter", "adapters stand on the coordinator"),
    wall("factory-connector", "lease", "api", "the lease knows no HTTP"),
    wall("factory-connector", "coordinator", "api", "the coordinator knows no HTTP"),
    wall("factory-connector", "coordinator", "twin_adapter", "adapters stand on the coordinator"),
    wall("factory-connector", "config", "coordinator", "configuration lies below what reads it"),
    wall("factory-connector", "config", "service", "configuration lies below what reads it"),
    wall("factory-connector", "api", "link_adapter", "pages and link know the coordinator alone"),
    wall("factory-connector", "api", "twin_adapter", "pages and twin know the coordinator alone"),
    wall("factory-connector", "api", "in_flight", "the coordinator and its link share it alone"),
    wall("factory-connector", "api", "service", "HTTP is started by the program"),
    wall("broker", "core", "handle", "the handle stands on the core"),
    wall("broker", "queue", "handle", "queues know no caller"),
    wall("broker", "store", "link", "rows know no link"),
    wall("broker", "store", "connection", "rows know no connection"),
    wall("daemon", "configuration", "web", "configuration lies below what reads it"),
    wall("mapping-engine", "script", "engine", "the engine stands on its workers"),
    wall("messaging", "transport", "link", "the wire knows no supervisor"),
    wall("messaging", "config", "link", "configuration lies below what reads it"),
    wall("platform", "store", "api", "rows know no HTTP"),
    wall("platform", "ingest", "api", "messages know no HTTP"),
    wall("platform", "store", "ingest", "rows know no message"),
    wall("platform", "networks", "api", "networks know no HTTP"),
    wall("platform", "leases", "api", "leases know no HTTP"),
    wall("platform", "live", "api", "events know no HTTP"),
    wall("shop-floor", "source", "service", "a session knows no command"),
    wall("twin", "asi", "security", "nodes know no certificates"),
    wall("twin", "events", "security", "the audit trail lies below what it reports about"),
    wall("twin", "error", "security", "errors lie below what fails"),
    wall("twin", "error", "events", "errors lie below what fails"),
];
