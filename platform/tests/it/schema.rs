//! The tables of the platform's database as its migrations made them, so that no test forgets a new one.

use std::path::Path;

use platform::store::Store;
use sqlx::{
    AssertSqlSafe, Connection as _, Row as _, SqliteConnection, sqlite::SqliteConnectOptions,
};

/// A column of a table.
#[derive(Debug, Clone)]
pub struct Column {
    pub name: String,
    kind: String,
    is_nullable: bool,
}

/// A table with its columns.
#[derive(Debug, Clone)]
pub struct Table {
    pub name: String,
    pub columns: Vec<Column>,
}

impl Table {
    pub fn has(&self, column: &str) -> bool {
        self.columns.iter().any(|known| known.name == column)
    }
}

/// A database beside the platform, in which rows refer to nothing.
pub struct Database {
    connection: SqliteConnection,
    pub tables: Vec<Table>,
    /// Number that no other value has.
    next: i64,
}

impl Database {
    /// Makes a database in its newest form and opens it.
    pub async fn make(path: &Path) -> Self {
        Store::open(path).await.expect("it opens").close().await;
        Self::open(path).await
    }

    pub async fn open(path: &Path) -> Self {
        let options = SqliteConnectOptions::new()
            .filename(path)
            .foreign_keys(false)
            .pragma("ignore_check_constraints", "true");
        let mut connection = SqliteConnection::connect_with(&options).await.expect("it opens");
        let names = sqlx::query(
            "SELECT name FROM sqlite_master WHERE type = 'table' AND name NOT LIKE 'sqlite_%'
             AND name <> '_sqlx_migrations' ORDER BY name",
        );
        let mut tables = Vec::new();
        for row in names.fetch_all(&mut connection).await.expect("read") {
            let name: String = row.get("name");
            let columns =
                sqlx::query("SELECT name, type, \"notnull\", pk FROM pragma_table_info($1)");
            let columns = columns.bind(&name).fetch_all(&mut connection).await.expect("read");
            let columns = columns.iter().map(|row| Column {
                name: row.get("name"),
                kind: row.get("type"),
                is_nullable: row.get::<i64, _>("notnull") == 0 && row.get::<i64, _>("pk") == 0,
            });
            let columns = columns.collect();
            tables.push(Table { name, columns });
        }
        assert!(tables.len() > 40, "{} tables", tables.len());
        Self { connection, tables, next: 1_000_000 }
    }

    pub async fn close(self) {
        self.connection.close().await.expect("closed");
    }

    /// Adds a row in which these columns have these values, and the others values of their own or none.
    pub async fn insert(&mut self, table: &Table, values: &[(&str, &str)]) {
        let mut written = Vec::new();
        for column in &table.columns {
            let value = values.iter().find(|(name, _)| *name == column.name);
            self.next += 1;
            let own = match column.kind.as_str() {
                "INTEGER" => self.next.to_string(),
                "BLOB" => format!("CAST('{}' AS BLOB)", self.next),
                _ => format!("'x{}'", self.next),
            };
            written.push(match value {
                Some((_, value)) => format!("'{value}'"),
                None if column.is_nullable => "NULL".to_owned(),
                None => own,
            });
        }
        let names: Vec<&str> = table.columns.iter().map(|column| column.name.as_str()).collect();
        let sql = format!(
            "INSERT INTO {} ({}) VALUES ({})",
            table.name,
            names.join(", "),
            written.join(", ")
        );
        let inserted = sqlx::query(AssertSqlSafe(sql.clone())).execute(&mut self.connection).await;
        inserted.unwrap_or_else(|error| panic!("{sql}: {error}"));
    }

    /// Counts the rows of a table in which a column has a value.
    pub async fn count(&mut self, table: &str, column: &str, value: &str) -> i64 {
        let sql = format!("SELECT COUNT(*) FROM {table} WHERE {column} = $1");
        let count = sqlx::query_scalar(AssertSqlSafe(sql)).bind(value.to_owned());
        count.fetch_one(&mut self.connection).await.expect("counted")
    }

    /// Returns rows and bytes that count as kept of a sender.
    pub async fn kept(&mut self, address: &str) -> (i64, i64) {
        let sql = "SELECT number, bytes FROM kept_of_sender WHERE address = $1";
        let row = sqlx::query(sql).bind(address).fetch_optional(&mut self.connection).await;
        row.expect("read").map_or((0, 0), |row| (row.get(0), row.get(1)))
    }

    /// Removes all rows of a table.
    pub async fn empty(&mut self, table: &str) {
        let sql = format!("DELETE FROM {table}");
        sqlx::query(AssertSqlSafe(sql)).execute(&mut self.connection).await.expect("removed");
    }
}
