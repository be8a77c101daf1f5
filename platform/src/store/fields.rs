//! The fields that are asked for: what was decided about them, and their current values.

/// Condition on a row `r` of `request_recipient`: the factory consented to the recipient before, or
/// has answered the newest revision, so that what it decides is meant for the recipient, too.
macro_rules! known_to_factory {
    ($factory:literal) => {
        concat!(
            "(r.consented_at IS NOT NULL OR EXISTS (SELECT 1 FROM network_part p
                 WHERE p.operation_network_id = r.operation_network_id AND p.factory_id = ",
            $factory,
            " AND p.state IN ('ACCEPTED', 'UNCHANGED')))"
        )
    };
}

mod decisions;

use asi_model::{
    DateTime, DynamicDataRequestId, FactoryId, FieldKey, FieldName, OperationId,
    OperationNetworkId, RequestKey, StatusCode,
    messages::{DisclosureStatement, MappingState},
};
pub use decisions::{DecisionAudience, DecisionEffect};
use sqlx::QueryBuilder;

use super::{
    database::{Connection, Database},
    error::StoreError,
    recipient_sets::RecipientSetId,
    row::{Columns, DatabaseRow, document},
    scope::Scope,
};
use crate::accesses::{Contents, Values, Withheld};

/// A field that a revision asks for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NewField {
    pub key: FieldKey,
    /// The factory that is asked.
    pub factory_id: FactoryId,
    /// Its place in the network's document.
    pub position: u32,
}

/// The newest value of a field.
#[derive(Debug, Clone, PartialEq)]
pub struct CurrentValue {
    pub key: FieldKey,
    /// The epoch of the report it came in.
    pub epoch: u32,
    /// The sequence number of the report it came in.
    pub sequence: u32,
    /// The value as the API shows it.
    pub value: serde_json::Value,
    /// The id of its built-in type; 0 where there is no value.
    pub built_in_type: u8,
    pub status: StatusCode,
    /// Source timestamp: time of the measurement.
    pub source_timestamp: Option<DateTime>,
    /// Time of the report at the connector.
    pub report_timestamp: Option<DateTime>,
    /// Time of arrival at the platform.
    pub received_at: DateTime,
    /// The organisations that may read it; none where nobody may.
    pub recipient_set: Option<RecipientSetId>,
}

/// A field with its decision and, for its recipients, its value.
#[derive(Debug, Clone, PartialEq)]
pub struct FieldRow {
    pub key: FieldKey,
    /// The factory that is asked.
    pub factory_id: FactoryId,
    pub mapping_state: MappingState,
    /// The engineer's reason; absent for whom the decision was not made.
    pub reason: Option<String>,
    /// The precision that recipients get; absent for whom the decision was not made.
    pub disclosure: Option<DisclosureStatement>,
    /// Time of the decision.
    pub decided_at: Option<DateTime>,
    /// The newest value with its times; none before the first report.
    pub current: Option<CurrentValue>,
}

impl Values for Vec<FieldRow> {
    fn contents(&self) -> Vec<Contents> {
        Contents::gather(self.iter().filter_map(|field| {
            let current = field.current.as_ref()?;
            let at = current.source_timestamp.or(current.report_timestamp);
            Some((&field.factory_id, &field.key.request, field.key.field_name.as_str(), at))
        }))
    }
}

/// Repository of requested fields.
pub struct Fields<'w>(pub(super) &'w mut Connection);

/// A field of a request that is in effect.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AskedField {
    /// The factory that is asked.
    pub factory_id: FactoryId,
    /// The operation that the request is about.
    pub operation_id: OperationId,
    pub field_name: FieldName,
    /// True while the field is open: only then it has a current value.
    pub is_mapped: bool,
}

/// Rows of one statement; thirteen parameters each stay far under every database's limit.
const ROWS_PER_STATEMENT: usize = 200;

impl Fields<'_> {
    /// Makes these the fields that the network asks for. Decisions about fields that stay are retained;
    /// those about fields that are gone go. Fields that are gone or not open lose their current values.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn replace(
        &mut self,
        network: &OperationNetworkId,
        fields: &[NewField],
    ) -> Result<(), StoreError> {
        // A position below zero marks what the new revision has not named again.
        sqlx::query("UPDATE request_field SET position = -1 WHERE operation_network_id = $1")
            .bind(network.as_str())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("mark fields"))?;
        for field in fields {
            let sql = "INSERT INTO request_field (operation_network_id, operation_id, dynamic_data_request_id,
                           field_name, factory_id, position, mapping_state)
                       VALUES ($1, $2, $3, $4, $5, $6, 'PENDING')
                       ON CONFLICT (operation_network_id, dynamic_data_request_id, field_name) DO UPDATE SET
                           operation_id = excluded.operation_id, factory_id = excluded.factory_id,
                           position = excluded.position";
            sqlx::query(sql)
                .bind(network.as_str())
                .bind(field.key.request.operation_id.as_str())
                .bind(field.key.request.dynamic_data_request_id.as_str())
                .bind(field.key.field_name.as_str())
                .bind(field.factory_id.as_str())
                .bind(i64::from(field.position))
                .execute(&mut *self.0)
                .await
                .map_err(StoreError::during("store a field"))?;
        }
        let sql = "DELETE FROM field_value WHERE operation_network_id = $1 AND NOT EXISTS (
                       SELECT 1 FROM request_field f WHERE f.operation_network_id = field_value.operation_network_id
                       AND f.dynamic_data_request_id = field_value.dynamic_data_request_id
                       AND f.field_name = field_value.field_name AND f.position >= 0
                       AND f.mapping_state = 'MAPPED')";
        sqlx::query(sql)
            .bind(network.as_str())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("remove values of fields that are not open"))?;
        sqlx::query("DELETE FROM request_field WHERE operation_network_id = $1 AND position < 0")
            .bind(network.as_str())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("remove fields that are gone"))?;
        Ok(())
    }

    /// Sets a field back to pending, without a decision.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn reopen(&mut self, key: &FieldKey) -> Result<(), StoreError> {
        let sql = "UPDATE request_field SET mapping_state = 'PENDING', reason = NULL, disclosure = NULL,
                       decided_at = NULL
                   WHERE operation_network_id = $1 AND dynamic_data_request_id = $2 AND field_name = $3";
        sqlx::query(sql)
            .bind(key.request.operation_network_id.as_str())
            .bind(key.request.dynamic_data_request_id.as_str())
            .bind(key.field_name.as_str())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("reopen a field"))?;
        Ok(())
    }

    /// Returns the fields of a request that is in effect.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn asked(
        &mut self,
        network: &OperationNetworkId,
        request: &DynamicDataRequestId,
    ) -> Result<Vec<AskedField>, StoreError> {
        let sql = "SELECT factory_id, operation_id, field_name, mapping_state FROM request_field
                   WHERE operation_network_id = $1 AND dynamic_data_request_id = $2";
        let rows = sqlx::query(sql)
            .bind(network.as_str())
            .bind(request.as_str())
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during("find what is asked"))?;
        rows.iter()
            .map(|row| {
                let state: String = row.column("mapping_state")?;
                Ok(AskedField {
                    factory_id: row.parsed("factory_id")?,
                    operation_id: row.parsed("operation_id")?,
                    field_name: row.parsed("field_name")?,
                    is_mapped: state == state_name(MappingState::Mapped),
                })
            })
            .collect()
    }

    /// Stores values, each only where it is newer than the one held.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn put_values(&mut self, values: &[CurrentValue]) -> Result<(), StoreError> {
        for chunk in values.chunks(ROWS_PER_STATEMENT) {
            let mut query = QueryBuilder::<Database>::new(
                "INSERT INTO field_value (operation_network_id, dynamic_data_request_id, field_name, operation_id,
                     epoch, sequence, value, built_in_type, status, source_timestamp, report_timestamp, received_at,
                     recipient_set_id) ",
            );
            query.push_values(chunk, |mut row, value| {
                row.push_bind(value.key.request.operation_network_id.as_str())
                    .push_bind(value.key.request.dynamic_data_request_id.as_str())
                    .push_bind(value.key.field_name.as_str())
                    .push_bind(value.key.request.operation_id.as_str())
                    .push_bind(i64::from(value.epoch))
                    .push_bind(i64::from(value.sequence))
                    .push_bind(document(&value.value))
                    .push_bind(i64::from(value.built_in_type))
                    .push_bind(i64::from(value.status.0))
                    .push_bind(value.source_timestamp.map(DateTime::ticks))
                    .push_bind(value.report_timestamp.map(DateTime::ticks))
                    .push_bind(value.received_at.ticks())
                    .push_bind(value.recipient_set.map(|set| set.0));
            });
            query.push(
                " ON CONFLICT (operation_network_id, dynamic_data_request_id, field_name) DO UPDATE SET
                      operation_id = excluded.operation_id, epoch = excluded.epoch, sequence = excluded.sequence,
                      value = excluded.value, built_in_type = excluded.built_in_type, status = excluded.status,
                      source_timestamp = excluded.source_timestamp, report_timestamp = excluded.report_timestamp,
                      received_at = excluded.received_at, recipient_set_id = excluded.recipient_set_id
                  WHERE (excluded.epoch, excluded.sequence) > (field_value.epoch, field_value.sequence)",
            );
            query
                .build()
                .execute(&mut *self.0)
                .await
                .map_err(StoreError::during("store values"))?;
        }
        Ok(())
    }

    /// The fields of a network that concern the viewer: as recipient, those that are open with the
    /// values that were released to it; as owner of the factory that is asked without. Reason and
    /// precision of a decision are withheld from recipients to whom the factory has not consented
    /// and of whom it has not confirmed to know: the decision may be to a former revision, which did
    /// not name them. In the order of the document.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn list(
        &mut self,
        scope: &Scope,
        network: &OperationNetworkId,
    ) -> Result<Withheld<Vec<FieldRow>>, StoreError> {
        let sql = concat!(
            "SELECT f.*, v.epoch, v.sequence, v.value, v.built_in_type, v.status, v.source_timestamp,
                       v.report_timestamp, v.received_at, v.recipient_set_id
                   FROM (SELECT f.*, (CASE WHEN CAST($2 AS TEXT) IS NULL OR EXISTS (
                             SELECT 1 FROM request_recipient r WHERE r.operation_network_id = f.operation_network_id
                             AND r.dynamic_data_request_id = f.dynamic_data_request_id AND r.organisation_id = $2)
                             THEN 1 ELSE 0 END) AS is_recipient,
                         (CASE WHEN EXISTS (SELECT 1 FROM factory o WHERE o.factory_id = f.factory_id
                             AND o.organisation_id = $2) THEN 1 ELSE 0 END) AS is_owner,
                         (CASE WHEN CAST($2 AS TEXT) IS NULL OR EXISTS (
                             SELECT 1 FROM request_recipient r WHERE r.operation_network_id = f.operation_network_id
                             AND r.dynamic_data_request_id = f.dynamic_data_request_id AND r.organisation_id = $2
                             AND ",
            known_to_factory!("f.factory_id"),
            ") THEN 1 ELSE 0 END) AS is_known
                         FROM request_field f WHERE f.operation_network_id = $1) f
                   LEFT JOIN field_value v ON f.is_recipient = 1 AND f.mapping_state = 'MAPPED'
                       AND (CAST($2 AS TEXT) IS NULL OR EXISTS (SELECT 1 FROM recipient_set_member m
                            WHERE m.recipient_set_id = v.recipient_set_id AND m.organisation_id = $2))
                       AND v.operation_network_id = f.operation_network_id
                       AND v.dynamic_data_request_id = f.dynamic_data_request_id AND v.field_name = f.field_name
                   WHERE f.is_recipient = 1 OR f.is_owner = 1 ORDER BY f.position"
        );
        let rows = sqlx::query(sql)
            .bind(network.as_str())
            .bind(scope.recipient())
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during("list fields"))?;
        let fields: Result<Vec<FieldRow>, StoreError> = rows.iter().map(read).collect();
        fields.map(Withheld::new)
    }
}

/// Returns the name of a state in the store and in the API.
#[must_use]
pub const fn state_name(state: MappingState) -> &'static str {
    match state {
        MappingState::Pending => "PENDING",
        MappingState::Mapped => "MAPPED",
        MappingState::Refused => "REFUSED",
    }
}

fn read(row: &DatabaseRow) -> Result<FieldRow, StoreError> {
    let request = RequestKey {
        operation_network_id: row.parsed("operation_network_id")?,
        operation_id: row.parsed("operation_id")?,
        dynamic_data_request_id: row.parsed("dynamic_data_request_id")?,
    };
    let key = request.field(row.parsed::<FieldName>("field_name")?);
    let epoch: Option<i64> = row.column("epoch")?;
    let current = match epoch {
        None => None,
        Some(_) => Some(CurrentValue {
            key: key.clone(),
            epoch: row.unsigned("epoch")?,
            sequence: row.unsigned("sequence")?,
            value: row.json("value")?,
            built_in_type: row.unsigned("built_in_type")?,
            status: StatusCode(row.unsigned("status")?),
            source_timestamp: row.time_option("source_timestamp")?,
            report_timestamp: row.time_option("report_timestamp")?,
            received_at: row.time("received_at")?,
            recipient_set: row.column::<Option<i64>>("recipient_set_id")?.map(RecipientSetId),
        }),
    };
    let state: String = row.column("mapping_state")?;
    let is_shown = row.unsigned::<u8>("is_owner")? != 0 || row.unsigned::<u8>("is_known")? != 0;
    let reason: Option<String> = row.column("reason")?;
    let disclosure: Option<String> = row.column("disclosure")?;
    Ok(FieldRow {
        key,
        factory_id: row.parsed("factory_id")?,
        mapping_state: match state.as_str() {
            "MAPPED" => MappingState::Mapped,
            "REFUSED" => MappingState::Refused,
            _ => MappingState::Pending,
        },
        reason: reason.filter(|_| is_shown),
        disclosure: disclosure.filter(|_| is_shown).map(|_| row.json("disclosure")).transpose()?,
        decided_at: row.time_option("decided_at")?,
        current,
    })
}
