//! The statements of one transaction, in few trips to the connection's thread.
//!
//! Each trip costs two changes of thread, which would dominate a transaction of small rows: so what a transaction writes
//! is collected, and goes there in texts of several statements. Rows go in blocks. Texts that come again are prepared
//! once: blocks have few sizes, and large ones a text of their own.

use sqlx::{Arguments as _, AssertSqlSafe, Encode, Sqlite, SqliteConnection, Type, sqlite::SqliteArguments};

use super::StoreError;

const BLOCK_SIZES: [usize; 8] = [200, 100, 40, 20, 10, 5, 2, 1];
/// Rows from which on a block has a text of its own.
const LARGE: usize = 100;
/// Rows of one text at most, where blocks are small.
const ROWS_MAX: usize = 150;

/// What one transaction writes.
pub(super) struct Batch {
    texts: Vec<Text>,
}

/// Statements, and the values of their parameters.
#[derive(Default)]
struct Text {
    sql: String,
    arguments: SqliteArguments,
    rows: usize,
    is_full: bool,
}

/// A row that is being written.
pub(super) struct Row<'t> {
    text: &'t mut Text,
    is_begun: bool,
}

/// The values of a statement's parameters, in their order.
pub(super) struct Values<'t>(&'t mut Text);

impl Text {
    fn add<'v>(&mut self, value: impl Encode<'v, Sqlite> + Type<Sqlite>) {
        self.arguments.add(value).expect("numbers, texts and bytes encode");
    }
}

impl Row<'_> {
    /// The next value.
    pub(super) fn push_bind<'v>(&mut self, value: impl Encode<'v, Sqlite> + Type<Sqlite>) {
        self.text.sql.push_str(if self.is_begun { ", ?" } else { "?" });
        self.is_begun = true;
        self.text.add(value);
    }
}

impl Values<'_> {
    /// The next value.
    pub(super) fn bind<'v>(self, value: impl Encode<'v, Sqlite> + Type<Sqlite>) -> Self {
        self.0.add(value);
        self
    }
}

impl Batch {
    /// A transaction that is yet to begin.
    pub(super) fn transaction() -> Self {
        Self { texts: vec![Text { sql: "BEGIN IMMEDIATE;\n".to_owned(), ..Text::default() }] }
    }

    /// Writes rows: `head VALUES (row), (row), ... tail`.
    pub(super) fn insert<T>(
        &mut self,
        head: &'static str,
        tail: &'static str,
        rows: &[T],
        bind: impl Fn(&mut Row<'_>, &T),
    ) {
        let mut rest = rows;
        while !rest.is_empty() {
            let size = BLOCK_SIZES.into_iter().find(|size| *size <= rest.len()).unwrap_or(1);
            let (block, further) = rest.split_at(size);
            rest = further;
            let text = self.text(size);
            text.sql.push_str(head);
            for (place, row) in block.iter().enumerate() {
                text.sql.push_str(if place == 0 { " VALUES (" } else { "), (" });
                bind(&mut Row { text, is_begun: false }, row);
            }
            text.sql.push(')');
            text.sql.push_str(tail);
            text.sql.push_str(";\n");
        }
    }

    /// One statement, whose parameters are `?` each.
    pub(super) fn run(&mut self, statement: &'static str) -> Values<'_> {
        debug_assert!(!statement.contains("?1"), "numbers of parameters would count from the beginning of the text");
        let text = self.text(1);
        text.sql.push_str(statement);
        text.sql.push_str(";\n");
        Values(text)
    }

    /// The text for so many rows more.
    fn text(&mut self, rows: usize) -> &mut Text {
        let is_large = rows >= LARGE;
        let fits = |text: &Text| if is_large { text.rows == 0 } else { text.rows + rows <= ROWS_MAX };
        let has_room = |text: &Text| !text.is_full && fits(text);
        if !self.texts.last().is_some_and(has_room) {
            self.texts.push(Text::default());
        }
        let last = self.texts.len() - 1;
        let text = &mut self.texts[last];
        text.rows += rows;
        text.is_full |= is_large;
        text
    }

    /// Writes everything or nothing. After an error or when this is not awaited to its end, the connection is of no more
    /// use: the transaction ends with it.
    pub(super) async fn commit(mut self, connection: &mut SqliteConnection) -> Result<(), StoreError> {
        self.run("COMMIT");
        for Text { sql, arguments, .. } in self.texts {
            sqlx::query_with(AssertSqlSafe(sql), arguments)
                .execute(&mut *connection)
                .await
                .map_err(StoreError::while_doing("write a transaction"))?;
        }
        Ok(())
    }
}

/// Row numbers as one JSON parameter for `IN (SELECT value FROM json_each(?))`.
pub(super) fn id_list<I: Into<i64> + Copy>(ids: &[I]) -> String {
    let ids: Vec<i64> = ids.iter().map(|id| (*id).into()).collect();
    serde_json::to_string(&ids).expect("numbers serialise")
}

#[cfg(test)]
mod tests {
    use sqlx::{Connection as _, Row as _};

    use super::*;

    fn numbers(batch: &mut Batch, numbers: std::ops::Range<i64>) {
        let rows: Vec<i64> = numbers.collect();
        batch.insert("INSERT INTO number (value, text)", " ON CONFLICT DO NOTHING", &rows, |row, value| {
            row.push_bind(*value);
            row.push_bind(format!("n{value}"));
        });
    }

    async fn table() -> SqliteConnection {
        let mut connection = SqliteConnection::connect("sqlite::memory:").await.expect("a database");
        sqlx::query("CREATE TABLE number (value INTEGER PRIMARY KEY, text TEXT)")
            .execute(&mut connection)
            .await
            .expect("a table");
        connection
    }

    #[tokio::test]
    async fn rows_of_any_number_are_written_with_their_own_values() {
        for count in [0, 1, 3, 39, 40, 99, 100, 149, 151, 345, 1_000] {
            let mut connection = table().await;
            let mut batch = Batch::transaction();
            numbers(&mut batch, 0..7);
            numbers(&mut batch, 7..7 + count);
            batch.run("UPDATE number SET text = ? WHERE value = ?").bind("changed").bind(3_i64);
            numbers(&mut batch, 7 + count..9 + count);
            batch.commit(&mut connection).await.expect("committed");
            let rows = sqlx::query("SELECT value, text FROM number ORDER BY value").fetch_all(&mut connection).await;
            let rows: Vec<(i64, String)> = rows.expect("rows").iter().map(|row| (row.get(0), row.get(1))).collect();
            let expected = |value| (value, if value == 3 { "changed".to_owned() } else { format!("n{value}") });
            assert_eq!(rows, (0..9 + count).map(expected).collect::<Vec<_>>());
        }
    }

    #[tokio::test]
    async fn few_texts_carry_much() {
        let mut batch = Batch::transaction();
        numbers(&mut batch, 0..200);
        numbers(&mut batch, 200..220);
        numbers(&mut batch, 220..263);
        batch.run("UPDATE number SET text = ?").bind("changed");
        assert_eq!(batch.texts.len(), 2, "begun with the large block; the small ones together");
        numbers(&mut batch, 300..600);
        numbers(&mut batch, 600..601);
        assert_eq!(batch.texts.len(), 5, "large blocks have texts of their own");
    }

    #[tokio::test]
    async fn a_fault_leaves_nothing() {
        let folder = tempfile::tempdir().expect("a folder");
        let url = format!("sqlite://{}?mode=rwc", folder.path().join("test.db").display());
        let mut connection = SqliteConnection::connect(&url).await.expect("a database");
        let create = "CREATE TABLE number (value INTEGER PRIMARY KEY, text TEXT)";
        sqlx::query(create).execute(&mut connection).await.expect("a table");
        let mut batch = Batch::transaction();
        numbers(&mut batch, 0..300);
        batch.run("INSERT INTO number (value) VALUES (?)").bind(5_i64);
        let problem = batch.commit(&mut connection).await.expect_err("the number is taken");
        assert!(std::error::Error::source(&problem).is_some_and(|cause| cause.to_string().contains("UNIQUE")));
        drop(connection);
        let mut connection = SqliteConnection::connect(&url).await.expect("a database");
        let row = sqlx::query("SELECT count(*) FROM number").fetch_one(&mut connection).await.expect("a row");
        assert_eq!(row.get::<i64, _>(0), 0);
    }
}
