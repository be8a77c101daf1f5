//! Differences between two revisions of a network, with their effects on mappings and consent.
//!
//! | change | mapping | consent |
//! |---|---|---|
//! | description, plan, slower cadence, earlier end of validity | kept | kept |
//! | faster cadence, recipients, purpose, longer validity | kept, offered again | back to Pending |
//! | type, unit, array rank, semantic | re-checked, offered as a suggestion | back to Pending |
//! | field or request removed | removed | removed |

use std::{
    collections::{HashMap, HashSet},
    hash::Hash,
    time::Duration,
};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{
    ids::{FieldKey, OperationId, OperationRelationId, RequestKey},
    network::{DynamicDataRequest, Operation, OperationNetwork, ReportField},
    values::DateTime,
};

/// Differences between two revisions of a network.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "camelCase")]
pub struct NetworkDifference {
    /// The network's own name or description.
    #[serde(rename = "isDescribedAnew")]
    pub is_description_changed: bool,
    /// Operations, without regard to their requests.
    pub operations: Changes<OperationId>,
    /// Relations with their conditions.
    pub relations: Changes<OperationRelationId>,
    /// Requests, without regard to their fields.
    pub requests: Changes<RequestKey>,
    /// Every field of the old and the new network with what becomes of it; untouched ones are left
    /// out.
    pub fields: Vec<FieldDifference>,
}

/// Keys that were added, changed and removed. Added and changed ones are in the new order, removed
/// ones in the old.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "camelCase")]
pub struct Changes<T> {
    /// Elements only in the new revision.
    pub added: Vec<T>,
    /// Elements in both, but not alike.
    pub changed: Vec<T>,
    /// Elements only in the old revision.
    pub removed: Vec<T>,
}

impl<T> Default for Changes<T> {
    fn default() -> Self {
        Self { added: Vec::new(), changed: Vec::new(), removed: Vec::new() }
    }
}

impl<T> Changes<T> {
    /// True where nothing differs.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.added.is_empty() && self.changed.is_empty() && self.removed.is_empty()
    }
}

/// Difference of one field, with its effects.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "camelCase")]
pub struct FieldDifference {
    pub key: FieldKey,
    pub change: FieldChange,
    pub mapping: MappingEffect,
    pub consent: ConsentEffect,
    /// Reasons for the engineer to read; empty where the field is new or removed.
    pub reasons: Vec<ChangeReason>,
}

/// Kind of a field's difference.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum FieldChange {
    Added,
    Changed,
    Removed,
}

/// Effect of a difference on a mapping.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema,
)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum MappingEffect {
    /// The mapping runs on.
    Kept,
    /// The mapping is kept and offered to the engineer again.
    OfferedAgain,
    /// The mapping is checked again and offered as a suggestion.
    Suggested,
    /// The mapping is removed with the field.
    Removed,
}

/// Effect of a difference on the engineer's consent.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema,
)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum ConsentEffect {
    /// The decision stays in force.
    Kept,
    /// The field is undecided again (or for the first time).
    BackToPending,
    /// The decision is removed with the field; queued values are announced as a gap.
    Removed,
}

/// Aspects of a field or its request that differ.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum ChangeReason {
    Description,
    ReportName,
    SlowerCadence,
    FasterCadence,
    ShorterValidity,
    LongerValidity,
    Requester,
    Recipients,
    Purpose,
    Buffer,
    Type,
    Unit,
    ValueRank,
    Semantic,
}

impl ChangeReason {
    const fn effect(self) -> (MappingEffect, ConsentEffect) {
        match self {
            Self::Description | Self::ReportName | Self::SlowerCadence | Self::ShorterValidity => {
                (MappingEffect::Kept, ConsentEffect::Kept)
            }
            Self::FasterCadence
            | Self::LongerValidity
            | Self::Requester
            | Self::Recipients
            | Self::Purpose => (MappingEffect::OfferedAgain, ConsentEffect::BackToPending),
            Self::Buffer | Self::Type | Self::Unit | Self::ValueRank | Self::Semantic => {
                (MappingEffect::Suggested, ConsentEffect::BackToPending)
            }
        }
    }
}

impl NetworkDifference {
    /// True where nothing differs.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        !self.is_description_changed
            && self.operations.is_empty()
            && self.relations.is_empty()
            && self.requests.is_empty()
            && self.fields.is_empty()
    }
}

/// Compares two revisions of a network.
#[must_use]
pub fn difference(old: &OperationNetwork, new: &OperationNetwork) -> NetworkDifference {
    NetworkDifference {
        is_description_changed: old.name != new.name || old.description != new.description,
        operations: changes(
            old.operation_list.iter().map(|operation| (&operation.operation_id, operation)),
            new.operation_list.iter().map(|operation| (&operation.operation_id, operation)),
            is_same_operation,
        ),
        relations: changes(
            old.operation_relation_list
                .iter()
                .map(|relation| (&relation.operation_relation_id, relation)),
            new.operation_relation_list
                .iter()
                .map(|relation| (&relation.operation_relation_id, relation)),
            |old, new| old == new,
        ),
        requests: request_changes(old, new),
        fields: field_differences(old, new),
    }
}

fn changes<'n, K: Hash + Eq + Clone + 'n, T>(
    old: impl Iterator<Item = (&'n K, T)>,
    new: impl Iterator<Item = (&'n K, T)>,
    is_same: impl Fn(&T, &T) -> bool,
) -> Changes<K> {
    let old: Vec<(&K, T)> = old.collect();
    let by_key: HashMap<&K, usize> =
        old.iter().enumerate().map(|(index, (key, _))| (*key, index)).collect();
    let mut changes = Changes::default();
    let mut kept = HashSet::new();
    for (key, value) in new {
        match by_key.get(key) {
            None => changes.added.push(key.clone()),
            Some(index) => {
                kept.insert(*index);
                if !is_same(&old[*index].1, &value) {
                    changes.changed.push(key.clone());
                }
            }
        }
    }
    let removed = old.iter().enumerate().filter(|(index, _)| !kept.contains(index));
    changes.removed = removed.map(|(_, (key, _))| (*key).clone()).collect();
    changes
}

/// Alike but for their requests.
fn is_same_operation(old: &&Operation, new: &&Operation) -> bool {
    old.kind == new.kind
        && old.name == new.name
        && old.description == new.description
        && old.stub == new.stub
        && old.owning_factory_id == new.owning_factory_id
        && old.planned_start == new.planned_start
        && old.planned_end == new.planned_end
        && old.planned_quantity == new.planned_quantity
        && is_same_unit(old.quantity_unit.as_deref(), new.quantity_unit.as_deref())
        && old.equipment_requirement_list == new.equipment_requirement_list
}

fn request_changes(old: &OperationNetwork, new: &OperationNetwork) -> Changes<RequestKey> {
    let keyed = |network: &OperationNetwork| -> Vec<(RequestKey, DynamicDataRequest)> {
        network
            .requests()
            .map(|(key, _, request)| {
                let mut alone = request.clone();
                alone.report_data_format.report_field_list = Vec::new();
                (key, alone)
            })
            .collect()
    };
    let (old, new) = (keyed(old), keyed(new));
    changes(
        old.iter().map(|(key, request)| (key, request)),
        new.iter().map(|(key, request)| (key, request)),
        |a, b| a == b,
    )
}

fn field_differences(old: &OperationNetwork, new: &OperationNetwork) -> Vec<FieldDifference> {
    let before: HashMap<FieldKey, (&DynamicDataRequest, &ReportField)> =
        old.fields().map(|(key, request, field)| (key, (request, field))).collect();
    let mut differences = Vec::new();
    let mut kept = HashSet::new();
    for (key, request, field) in new.fields() {
        let Some((old_request, old_field)) = before.get(&key) else {
            differences.push(FieldDifference {
                key,
                change: FieldChange::Added,
                mapping: MappingEffect::Kept,
                consent: ConsentEffect::BackToPending,
                reasons: Vec::new(),
            });
            continue;
        };
        let mut reasons = request_reasons(old_request, request);
        field_reasons(old_field, field, &mut reasons);
        if !reasons.is_empty() {
            let effects = reasons.iter().map(|reason| reason.effect());
            differences.push(FieldDifference {
                key: key.clone(),
                change: FieldChange::Changed,
                mapping: effects
                    .clone()
                    .map(|(mapping, _)| mapping)
                    .max()
                    .unwrap_or(MappingEffect::Kept),
                consent: effects.map(|(_, consent)| consent).max().unwrap_or(ConsentEffect::Kept),
                reasons,
            });
        }
        kept.insert(key);
    }
    for (key, _, _) in old.fields().filter(|(key, _, _)| !kept.contains(key)) {
        differences.push(FieldDifference {
            key,
            change: FieldChange::Removed,
            mapping: MappingEffect::Removed,
            consent: ConsentEffect::Removed,
            reasons: Vec::new(),
        });
    }
    differences
}

fn request_reasons(old: &DynamicDataRequest, new: &DynamicDataRequest) -> Vec<ChangeReason> {
    let mut reasons = Vec::new();
    let mut note = |is_changed: bool, reason: ChangeReason| {
        if is_changed {
            reasons.push(reason);
        }
    };
    note(old.description != new.description, ChangeReason::Description);
    note(
        old.report_data_format.report_name != new.report_data_format.report_name,
        ChangeReason::ReportName,
    );
    note(old.requester_id != new.requester_id, ChangeReason::Requester);
    let recipients = |request: &DynamicDataRequest| {
        request.recipient_list.iter().cloned().collect::<HashSet<_>>()
    };
    note(recipients(old) != recipients(new), ChangeReason::Recipients);
    note(old.purpose != new.purpose, ChangeReason::Purpose);
    note(old.buffer_id != new.buffer_id, ChangeReason::Buffer);
    // A request without a frequency of its own accepts the slowest.
    let interval =
        |request: &DynamicDataRequest| request.update_interval().unwrap_or(Duration::MAX);
    note(interval(new) < interval(old), ChangeReason::FasterCadence);
    note(interval(new) > interval(old), ChangeReason::SlowerCadence);
    let from = |request: &DynamicDataRequest| request.valid_from.unwrap_or(DateTime::MIN);
    let until = |request: &DynamicDataRequest| request.valid_until.unwrap_or(DateTime::MAX);
    let is_longer = from(new) < from(old) || until(new) > until(old);
    let is_shorter = from(new) > from(old) || until(new) < until(old);
    note(is_longer, ChangeReason::LongerValidity);
    note(is_shorter, ChangeReason::ShorterValidity);
    reasons
}

fn field_reasons(old: &ReportField, new: &ReportField, reasons: &mut Vec<ChangeReason>) {
    if old.description != new.description && !reasons.contains(&ChangeReason::Description) {
        reasons.push(ChangeReason::Description);
    }
    for (is_changed, reason) in [
        (old.field_type != new.field_type, ChangeReason::Type),
        (!is_same_unit(old.unit.as_deref(), new.unit.as_deref()), ChangeReason::Unit),
        (old.value_rank != new.value_rank, ChangeReason::ValueRank),
        (old.semantic != new.semantic, ChangeReason::Semantic),
    ] {
        if is_changed {
            reasons.push(reason);
        }
    }
}

/// `PIECE` and `H87` are one unit.
fn is_same_unit(old: Option<&str>, new: Option<&str>) -> bool {
    let code = |unit: Option<&str>| unit.and_then(crate::units::lookup).map(|unit| unit.code);
    old == new || (code(old).is_some() && code(old) == code(new))
}

#[cfg(test)]
mod tests;
