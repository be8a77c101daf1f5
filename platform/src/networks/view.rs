//! A network as one viewer sees it.

use asi_model::{
    DateTime, FactoryId, FieldKey, OperationNetworkId, OrganisationId,
    messages::{DisclosureStatement, Fault, MappingState},
    network::OperationNetwork,
};
use serde::Serialize;
use utoipa::ToSchema;

use crate::{
    accesses::Withheld,
    progress::{OperationProgress, progress},
    store::{FieldRow, NetworkRow, PartState, Scope, SeenPart, StoreError, Work},
};

/// A network with its parts, progress and fields.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct NetworkView {
    /// The collaboration it belongs to.
    pub collaboration_id: asi_model::CollaborationId,
    /// The last revision that changed what the viewer sees.
    pub revision: u64,
    /// Time of that revision.
    pub updated_at: DateTime,
    /// The user or tool that made it, for its own organisation and administrators. Others are shown
    /// the organisation; absent where that is none.
    pub updated_by: Option<String>,
    /// Time of the withdrawal; absent while in effect.
    pub withdrawn_at: Option<DateTime>,
    /// The organisation that drew the network; absent where only administrators own it.
    pub drawn_by: Option<OrganisationId>,
    /// The network as the viewer sees it (wire contract `operation-network`): neighbours'
    /// operations are stubs with plan times. Put back with changes, it leaves what is hidden as it
    /// is.
    pub network: OperationNetwork,
    /// Parts as sent to the factories of whose operations the viewer sees any.
    pub parts: Vec<PartView>,
    /// Progress of each operation, derived from the viewer's fields.
    pub operations: Vec<OperationProgress>,
    /// The fields that concern the viewer.
    pub fields: Vec<FieldView>,
    /// The live event that this view includes: `GET /live` with it as `Last-Event-ID` misses
    /// nothing.
    pub last_event_id: String,
}

/// Part of a network as sent to a factory, with evidence of the factory's life.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct PartView {
    pub factory_id: FactoryId,
    pub organisation_id: Option<OrganisationId>,
    /// Name for people.
    pub factory_name: Option<String>,
    /// The revision in which its part changed last; like the faults, the times and the count below,
    /// for the factory's own organisation and the drawer of the network.
    pub revision: Option<u64>,
    /// True where the part ends the network at the factory.
    pub is_withdrawal: bool,
    /// State at the factory.
    pub state: PartState,
    /// Faults for which it was rejected.
    pub fault_list: Vec<Fault>,
    /// Time of the last transmission.
    pub sent_at: Option<DateTime>,
    /// Number of transmissions.
    pub sent_count: Option<u32>,
    /// Time of the acknowledgement.
    pub answered_at: Option<DateTime>,
    /// Last arrival from the factory; for others than its own organisation the minute of the last
    /// sign that does not follow values.
    pub last_seen_at: Option<DateTime>,
}

/// A field with its decision and newest value.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct FieldView {
    pub key: FieldKey,
    /// The factory that is asked.
    pub factory_id: FactoryId,
    /// `PENDING`, `MAPPED` or `REFUSED`.
    pub mapping_state: MappingState,
    pub reason: Option<String>,
    /// The precision that recipients get.
    pub disclosure: Option<DisclosureStatement>,
    /// Time of the decision.
    pub decided_at: Option<DateTime>,
    /// The newest value; 64-bit integers are texts.
    #[schema(value_type = asi_model::openapi::PlainValue, required = false)]
    pub value: Option<serde_json::Value>,
    /// Its OPC UA built-in type, by name.
    pub value_type: Option<String>,
    /// Its quality, by the standard's name.
    pub status: Option<String>,
    /// Source timestamp: time of the measurement.
    pub source_timestamp: Option<DateTime>,
    /// Time of the report at the connector.
    pub report_timestamp: Option<DateTime>,
    /// Time of arrival at the platform.
    pub received_at: Option<DateTime>,
    /// The writer's epoch.
    pub epoch: Option<u32>,
    /// The report's sequence number.
    pub sequence: Option<u32>,
}

/// Returns a network as the viewer sees it; `None` where it is none of the viewer's.
///
/// # Errors
/// [`StoreError`].
pub async fn view(
    work: &mut Work,
    scope: &Scope,
    id: &OperationNetworkId,
    last_event_id: String,
) -> Result<Option<Withheld<NetworkView>>, StoreError> {
    let Some(row) = work.networks().lookup(scope, id).await? else { return Ok(None) };
    let updated_by = author_shown(scope, &row);
    let fields = work.fields().list(scope, id).await?;
    let parts = work.parts().seen(scope, id).await?;
    let factories = work.factories().list(scope).await?;
    let part_views = parts
        .into_iter()
        .map(|seen| {
            let id = &seen.part.factory_id;
            let factory = factories.iter().find(|factory| factory.factory_id == *id);
            part_view(seen, factory)
        })
        .collect();
    let shown = (row, updated_by, part_views, last_event_id);
    Ok(Some(fields.map_with(shown, |(row, updated_by, parts, last_event_id), fields| {
        network_view(row, updated_by, parts, last_event_id, fields)
    })))
}

fn network_view(
    row: NetworkRow,
    updated_by: Option<String>,
    parts: Vec<PartView>,
    last_event_id: String,
    fields: Vec<FieldRow>,
) -> NetworkView {
    NetworkView {
        collaboration_id: row.collaboration_id,
        revision: row.revision,
        updated_at: row.updated_at,
        updated_by,
        withdrawn_at: row.withdrawn_at,
        drawn_by: row.drawn_by,
        operations: progress(&row.network, &fields),
        network: row.network,
        parts,
        fields: fields.into_iter().map(field_view).collect(),
        last_event_id,
    }
}

/// Returns the author of a revision as a viewer may know it: users and tools are known in their own
/// organisation.
fn author_shown(scope: &Scope, row: &NetworkRow) -> Option<String> {
    match (scope, &row.author_organisation) {
        (Scope::Organisation(viewer), author) if author.as_ref() != Some(viewer) => {
            author.as_ref().map(OrganisationId::to_string)
        }
        _ => Some(row.updated_by.clone()),
    }
}

fn part_view(seen: SeenPart, factory: Option<&crate::store::Factory>) -> PartView {
    let SeenPart { part, is_whole } = seen;
    PartView {
        factory_id: part.factory_id,
        organisation_id: factory.map(|factory| factory.organisation_id.clone()),
        factory_name: factory.map(|factory| factory.name.clone()),
        revision: is_whole.then_some(part.revision),
        is_withdrawal: part.is_withdrawal,
        state: part.state,
        fault_list: if is_whole { part.fault_list } else { Vec::new() },
        sent_at: is_whole.then_some(part.sent_at),
        sent_count: is_whole.then_some(part.sent_count),
        answered_at: part.acknowledged_at.filter(|_| is_whole),
        last_seen_at: factory.and_then(|factory| factory.last_seen_at),
    }
}

fn field_view(row: FieldRow) -> FieldView {
    let current = row.current;
    FieldView {
        key: row.key,
        factory_id: row.factory_id,
        mapping_state: row.mapping_state,
        reason: row.reason,
        disclosure: row.disclosure,
        decided_at: row.decided_at,
        value_type: current
            .as_ref()
            .and_then(|current| asi_model::BuiltInType::from_id(current.built_in_type.into()))
            .map(|built_in_type| built_in_type.name().to_owned()),
        status: current.as_ref().map(|current| current.status.to_string()),
        source_timestamp: current.as_ref().and_then(|current| current.source_timestamp),
        report_timestamp: current.as_ref().and_then(|current| current.report_timestamp),
        received_at: current.as_ref().map(|current| current.received_at),
        epoch: current.as_ref().map(|current| current.epoch),
        sequence: current.as_ref().map(|current| current.sequence),
        value: current.map(|current| current.value),
    }
}
