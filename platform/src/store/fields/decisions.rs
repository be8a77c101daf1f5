//! Decisions of factories about the fields that are asked for.

use asi_model::{
    DynamicDataRequestId, FactoryId, FieldKey, OperationNetworkId, OrganisationId,
    messages::{Decision, MappingState},
};

use super::{Fields, state_name};
use crate::store::{
    error::StoreError,
    row::{Columns, document},
};

/// Effect of a decision at the platform.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DecisionEffect {
    /// None: a later decision is stored, or the factory is not asked for the field.
    Ignored,
    /// The decision was stored, about a field that was open before or is not open now.
    Changed,
    /// The same decision was stored before.
    Repeated,
    /// The field was opened: values from before do not belong to this consent.
    Opened,
}

/// Organisations that may know of a decision, by id.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DecisionAudience {
    /// The factory's organisation and those for whom the decision was made: with reason and
    /// precision.
    pub whole: Vec<OrganisationId>,
    /// Recipients of whom the factory may not have known: the bare state.
    pub others: Vec<OrganisationId>,
}

impl Fields<'_> {
    /// Stores a decision about a field of this factory, unless a later one is stored. Says whether
    /// it took effect. A decision that does not open the field, or opens it again, ends the current
    /// value of before.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn decide(
        &mut self,
        key: &FieldKey,
        decision: &Decision,
    ) -> Result<DecisionEffect, StoreError> {
        let sql = "SELECT mapping_state, (decided_at IS $7 AND mapping_state = $4 AND reason IS $5 AND disclosure IS $6)
                       AS is_repeat FROM request_field
                   WHERE operation_network_id = $1 AND dynamic_data_request_id = $2 AND field_name = $3";
        let former = sqlx::query(sql)
            .bind(key.request.operation_network_id.as_str())
            .bind(key.request.dynamic_data_request_id.as_str())
            .bind(key.field_name.as_str())
            .bind(state_name(decision.mapping_state))
            .bind(decision.reason.as_deref())
            .bind(decision.disclosure.as_ref().map(document))
            .bind(decision.decided_at.ticks())
            .fetch_optional(&mut *self.0)
            .await
            .map_err(StoreError::during("read the state before a decision"))?;
        let is_repeat = former.as_ref().map(|row| row.unsigned::<u8>("is_repeat")).transpose()?;
        let former: Option<String> =
            former.as_ref().map(|row| row.column("mapping_state")).transpose()?;
        let sql = "DELETE FROM field_value
                   WHERE operation_network_id = $1 AND dynamic_data_request_id = $2 AND field_name = $3
                     AND ($5 <> 'MAPPED' OR report_timestamp IS NULL OR report_timestamp < $6)
                     AND EXISTS (SELECT 1 FROM request_field f WHERE f.operation_network_id = $1
                         AND f.dynamic_data_request_id = $2 AND f.field_name = $3 AND f.factory_id = $4
                         AND ($5 <> 'MAPPED' OR f.mapping_state <> 'MAPPED')
                         AND (f.decided_at IS NULL OR f.decided_at <= $6))";
        sqlx::query(sql)
            .bind(key.request.operation_network_id.as_str())
            .bind(key.request.dynamic_data_request_id.as_str())
            .bind(key.field_name.as_str())
            .bind(decision.factory_id.as_str())
            .bind(state_name(decision.mapping_state))
            .bind(decision.decided_at.ticks())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("remove the value of before a decision"))?;
        let sql = "UPDATE request_field SET mapping_state = $5, reason = $6, disclosure = $7, decided_at = $8
                   WHERE operation_network_id = $1 AND dynamic_data_request_id = $2 AND field_name = $3
                     AND factory_id = $4 AND (decided_at IS NULL OR decided_at <= $8)";
        let result = sqlx::query(sql)
            .bind(key.request.operation_network_id.as_str())
            .bind(key.request.dynamic_data_request_id.as_str())
            .bind(key.field_name.as_str())
            .bind(decision.factory_id.as_str())
            .bind(state_name(decision.mapping_state))
            .bind(decision.reason.as_deref())
            .bind(decision.disclosure.as_ref().map(document))
            .bind(decision.decided_at.ticks())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("store a decision"))?;
        Ok(if result.rows_affected() == 0 {
            DecisionEffect::Ignored
        } else if is_repeat == Some(1) {
            DecisionEffect::Repeated
        } else if decision.mapping_state == MappingState::Mapped
            && former.as_deref() != Some(state_name(MappingState::Mapped))
        {
            DecisionEffect::Opened
        } else {
            DecisionEffect::Changed
        })
    }

    /// Returns the organisations that may know of a factory's decision about a request's field: its
    /// recipients and the owner of the factory.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn audience(
        &mut self,
        network: &OperationNetworkId,
        request: &DynamicDataRequestId,
        factory: &FactoryId,
    ) -> Result<DecisionAudience, StoreError> {
        let sql = concat!(
            "SELECT organisation_id, MAX(is_whole) AS is_whole FROM (
                 SELECT r.organisation_id, (CASE WHEN ",
            known_to_factory!("$3"),
            " THEN 1 ELSE 0 END) AS is_whole FROM request_recipient r
                 WHERE r.operation_network_id = $1 AND r.dynamic_data_request_id = $2
                 UNION ALL SELECT o.organisation_id, 1 FROM request_field f
                 JOIN factory o ON o.factory_id = f.factory_id
                 WHERE f.operation_network_id = $1 AND f.dynamic_data_request_id = $2) c
             GROUP BY organisation_id ORDER BY organisation_id"
        );
        let rows = sqlx::query(sql)
            .bind(network.as_str())
            .bind(request.as_str())
            .bind(factory.as_str())
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during("list who may know of a decision"))?;
        let mut audience = DecisionAudience { whole: Vec::new(), others: Vec::new() };
        for row in &rows {
            let is_whole = row.unsigned::<u8>("is_whole")? != 0;
            let readers = if is_whole { &mut audience.whole } else { &mut audience.others };
            readers.push(row.parsed("organisation_id")?);
        }
        Ok(audience)
    }
}
