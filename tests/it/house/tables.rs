//! Tables of the rules of form: walls between the modules of a package, and types of the connector
//! that may be larger than others. Shared by the test and the program for developers.

use house_rules::{Exemption, Wall};

/// Packages of the connector, whose types have bounds.
pub const CONNECTOR: &[&str] = &["factory-connector", "connector-state", "disclosure", "ledger"];

/// Types of the connector that may have more fields or methods.
pub const LARGE_TYPES: &[Exemption] = &[];

const fn wall(
    package: &'static str,
    from: &'static str,
    to: &'static str,
    reason: &'static str,
) -> Wall {
    Wall { package, from, to, reason }
}

/// Walls inside packages: the first module and those below it never import the second.
pub const WALLS: &[Wall] = &[
    wall("asi-model", "", "::std::time::SystemTime::now", "the shared language knows no clock"),
    wall("mapping", "", "::std::time::SystemTime::now", "time is an argument"),
    wall("mapping", "", "::tokio", "a transform is a state machine"),
    wall("disclosure", "", "::tokio", "the gate is a state machine"),
    wall("disclosure", "", "::sqlx", "the gate knows no rows"),
    wall("disclosure", "", "::std::time::SystemTime::now", "time is an argument"),
    wall("ledger", "", "::tokio", "the chains are pure; the store writes what they yield"),
    wall("ledger", "", "::sqlx", "the chains know no rows"),
    wall("ledger", "", "::std::time::SystemTime::now", "time is an argument"),
    wall("spool", "", "::tokio", "decisions about the spool are pure"),
    wall("spool", "", "::sqlx", "the owner of the spool writes its rows"),
    wall("connector-state", "", "::tokio", "use cases are functions; the coordinator runs them"),
    wall("connector-state", "", "::sqlx", "the state knows no database"),
    wall("connector-state", "", "::rusqlite", "the state knows no database"),
    wall("connector-state", "", "::std::time::SystemTime::now", "time is an argument"),
    wall("connector-state", "", "::std::time::Instant::now", "time is an argument"),
    wall("connector-state", "", "::uuid::Uuid::now_v7", "ids come from a seeded source"),
    wall("connector-state", "", "::uuid::Uuid::new_v4", "ids come from a seeded source"),
    wall("disclosure", "", "::std::time::Instant::now", "time is an argument"),
    wall("ledger", "", "::std::time::Instant::now", "time is an argument"),
    wall("spool", "", "::time::OffsetDateTime::now_utc", "time is an argument"),
    wall("connector-state", "use_cases", "transaction", "a use case does not commit"),
    wall("shop-floor-model", "", "::tokio", "plain data"),
    wall("factory-connector", "store", "api", "rows know no HTTP"),
    wall("factory-connector", "store", "coordinator", "rows know no task"),
    wall("factory-connector", "store", "link_adapter", "rows know no link"),
    wall("factory-connector", "coordinator", "api", "the coordinator knows no HTTP"),
    wall("factory-connector", "coordinator", "twin_adapter", "adapters stand on the coordinator"),
    wall("factory-connector", "config", "coordinator", "configuration lies below what reads it"),
    wall("factory-connector", "config", "service", "configuration lies below what reads it"),
    wall("messaging", "transport", "link", "the wire knows no supervisor"),
    wall("messaging", "config", "link", "configuration lies below what reads it"),
    wall("platform", "store", "api", "rows know no HTTP"),
    wall("platform", "ingest", "api", "messages know no HTTP"),
    wall("twin", "asi", "security", "nodes know no certificates"),
];
