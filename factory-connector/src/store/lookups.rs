//! What pages and commands look up beside the desk's memory.

use asi_model::{DateTime, OperationNetworkId};
use sqlx::{Row as _, SqliteConnection, SqlitePool};

use super::{StoreError, load::get};

/// How to reach the platform's broker, as enrolment told.
#[derive(Clone, PartialEq, Eq)]
pub struct Enrolment {
    /// The factory that was enrolled.
    pub factory_id: String,
    /// The broker.
    pub broker_url: String,
    /// How addresses are mapped there.
    pub profile: String,
    /// Our user.
    pub user_name: String,
    /// Its password.
    pub password: String,
    /// The root that the broker's certificate must come from; the system's roots without it.
    pub root_certificate_pem: Option<String>,
}

impl std::fmt::Debug for Enrolment {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Enrolment")
            .field("factory_id", &self.factory_id)
            .field("broker_url", &self.broker_url)
            .field("user_name", &self.user_name)
            .finish_non_exhaustive()
    }
}

/// The enrolment, if there was one.
///
/// # Errors
/// [`StoreError`] where the table cannot be read.
pub async fn enrolment(connection: &mut SqliteConnection) -> Result<Option<Enrolment>, StoreError> {
    let row = sqlx::query(
        "SELECT factory_id, broker_url, profile, user_name, password, root_certificate_pem FROM enrolment WHERE id = 1",
    )
    .fetch_optional(connection)
    .await
    .map_err(StoreError::while_doing("read the enrolment"))?;
    row.map(|row| {
        Ok(Enrolment {
            factory_id: get(&row, 0)?,
            broker_url: get(&row, 1)?,
            profile: get(&row, 2)?,
            user_name: get(&row, 3)?,
            password: get(&row, 4)?,
            root_certificate_pem: get(&row, 5)?,
        })
    })
    .transpose()
}

/// Keeps an enrolment in place of the one before.
///
/// # Errors
/// [`StoreError`] where the table cannot be written.
pub async fn put_enrolment(
    connection: &mut SqliteConnection,
    enrolment: &Enrolment,
    now: DateTime,
) -> Result<(), StoreError> {
    sqlx::query(
        "INSERT INTO enrolment (id, factory_id, broker_url, profile, user_name, password, root_certificate_pem, \
         enrolled_at) VALUES (1, ?, ?, ?, ?, ?, ?, ?) ON CONFLICT (id) DO UPDATE SET factory_id = excluded.factory_id, \
         broker_url = excluded.broker_url, profile = excluded.profile, user_name = excluded.user_name, \
         password = excluded.password, root_certificate_pem = excluded.root_certificate_pem, \
         enrolled_at = excluded.enrolled_at",
    )
    .bind(&enrolment.factory_id)
    .bind(&enrolment.broker_url)
    .bind(&enrolment.profile)
    .bind(&enrolment.user_name)
    .bind(&enrolment.password)
    .bind(&enrolment.root_certificate_pem)
    .bind(now.unix_micros())
    .execute(connection)
    .await
    .map_err(StoreError::while_doing("keep the enrolment"))?;
    Ok(())
}

/// A message that was received or sent and rejected.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct DeadLetter {
    /// Its number, as text.
    pub id: String,
    /// `RECEIVED` or `SENT`.
    pub direction: String,
    /// Its id, where it has one.
    pub message_id: Option<String>,
    /// Its type, as far as it is known.
    pub subject: String,
    /// Why, as a code.
    pub code: String,
    /// Why, in words.
    pub reason: String,
    /// When.
    #[schema(value_type = String, format = "date-time")]
    pub at: DateTime,
    /// Its size, in bytes.
    pub bytes: i64,
}

/// Dead letters, newest first.
///
/// # Errors
/// [`StoreError`] where the table cannot be read.
pub async fn dead_letters(
    readers: &SqlitePool,
    before: i64,
    limit: u32,
) -> Result<Vec<DeadLetter>, StoreError> {
    let rows = sqlx::query(
        "SELECT id, direction, message_id, subject, code, reason, occurred_at, length(body) FROM dead_letter \
         WHERE id < ? ORDER BY id DESC LIMIT ?",
    )
    .bind(before)
    .bind(i64::from(limit))
    .fetch_all(readers)
    .await
    .map_err(StoreError::while_doing("read the dead letters"))?;
    rows.iter()
        .map(|row| {
            Ok(DeadLetter {
                id: get::<i64>(row, 0)?.to_string(),
                direction: get(row, 1)?,
                message_id: get(row, 2)?,
                subject: get(row, 3)?,
                code: get(row, 4)?,
                reason: get(row, 5)?,
                at: DateTime::from_unix_micros(get(row, 6)?),
                bytes: get(row, 7)?,
            })
        })
        .collect()
}

/// A remark as it was made.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct StoredComment {
    /// Its number.
    pub id: i64,
    /// The request talked about, if one.
    pub dynamic_data_request_id: Option<String>,
    /// The field talked about, if one.
    pub field_name: Option<String>,
    /// Who says it.
    pub author_id: String,
    /// Said by this factory.
    pub is_own: bool,
    /// What is said.
    pub text: String,
    /// When.
    #[schema(value_type = String, format = "date-time")]
    pub written_at: DateTime,
}

/// The talk about a network, oldest first, at most the last thousand remarks.
///
/// # Errors
/// [`StoreError`] where the table cannot be read.
pub async fn comments(
    readers: &SqlitePool,
    network: &OperationNetworkId,
) -> Result<Vec<StoredComment>, StoreError> {
    let rows = sqlx::query(
        "SELECT id, dynamic_data_request_id, field_name, author_id, is_own, text, written_at FROM (SELECT * FROM \
         comment WHERE operation_network_id = ? ORDER BY id DESC LIMIT 1000) ORDER BY id",
    )
    .bind(network.as_str())
    .fetch_all(readers)
    .await
    .map_err(StoreError::while_doing("read the comments"))?;
    rows.iter()
        .map(|row| {
            Ok(StoredComment {
                id: get(row, 0)?,
                dynamic_data_request_id: get(row, 1)?,
                field_name: get(row, 2)?,
                author_id: get(row, 3)?,
                is_own: row
                    .try_get::<i64, _>(4)
                    .map_err(StoreError::while_doing("read a column"))?
                    != 0,
                text: get(row, 5)?,
                written_at: DateTime::from_unix_micros(get(row, 6)?),
            })
        })
        .collect()
}

/// The sources as stored.
///
/// # Errors
/// [`StoreError`] where the table cannot be read.
pub async fn sources(readers: &SqlitePool) -> Result<Vec<super::SourceRow>, StoreError> {
    let rows = sqlx::query("SELECT source_id, config, password FROM source ORDER BY source_id")
        .fetch_all(readers)
        .await
        .map_err(StoreError::while_doing("read the sources"))?;
    rows.iter()
        .map(|row| {
            Ok(super::SourceRow {
                source_id: get(row, 0)?,
                config: get(row, 1)?,
                password: get(row, 2)?,
            })
        })
        .collect()
}
