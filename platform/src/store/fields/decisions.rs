//! Decisions of factories about the fields that are asked for.

use asi_model::{
    FieldKey,
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
    /// The field was opened: values from before do not belong to this consent.
    Opened,
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
        let sql = "SELECT mapping_state FROM request_field
                   WHERE operation_network_id = $1 AND dynamic_data_request_id = $2 AND field_name = $3";
        let former = sqlx::query(sql)
            .bind(key.request.operation_network_id.as_str())
            .bind(key.request.dynamic_data_request_id.as_str())
            .bind(key.field_name.as_str())
            .fetch_optional(&mut *self.0)
            .await
            .map_err(StoreError::during("read the state before a decision"))?;
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
        } else if decision.mapping_state == MappingState::Mapped
            && former.as_deref() != Some(state_name(MappingState::Mapped))
        {
            DecisionEffect::Opened
        } else {
            DecisionEffect::Changed
        })
    }
}
