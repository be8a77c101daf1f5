//! Loading: the state as it was stored.

use std::sync::Arc;

use asi_model::{DateTime, FieldKey, messages::ValueSource};
use disclosure::{DecisionBasis, DisclosurePolicy, GateState, gate_from_json};
use mapping::{Mapping, TransformState};

use crate::{
    ChangeSet, ConnectorState, Field, FieldDecision, FieldRegistry, FormerDisclosureRegistry,
    IdSource, JournalRegistry, LedgerChains, LogRecord, MappingVersions, Network, NetworkRegistry,
    PastDecisionRegistry, ShadowMapping, Snapshot, StateConfig, WriterRegistry, dependencies,
    effects::{EngineCommand, TwinUpdate},
    fields::StoredField,
    keep_alive_schedule::schedule_keep_alive,
    queries::effective_policy,
    snapshot::StoredMappings,
    transaction::begin_epoch,
    use_cases::{caps::hold_back, retain::state_former},
    writes::{FieldRow, FieldValueRow, ShadowRow},
};

/// A stored document that cannot be understood.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("the stored {what} cannot be read: {reason}")]
pub struct UnreadableState {
    /// Kind of the document.
    pub what: &'static str,
    pub reason: String,
}

impl UnreadableState {
    fn because<E: ToString>(what: &'static str) -> impl Fn(E) -> Self {
        move |error| Self { what, reason: error.to_string() }
    }
}

impl ConnectorState {
    /// Loads the state, and returns with it what the twin and the engine have to show and run. A
    /// restored, moved or copied store begins new epochs: an older copy may have continued.
    ///
    /// # Errors
    /// [`UnreadableState`].
    pub fn load(
        config: StateConfig,
        snapshot: Snapshot,
        ids: IdSource,
        is_restored: bool,
        now: DateTime,
    ) -> Result<(Self, ChangeSet), UnreadableState> {
        let former = FormerDisclosureRegistry::load(&snapshot.former_disclosures, now)
            .map_err(UnreadableState::because("former disclosure"))?;
        let mut state = Self {
            networks: NetworkRegistry::default(),
            fields: FieldRegistry::after(snapshot.last_field.max(former.last_field())),
            writers: WriterRegistry::default(),
            policies: snapshot.policies.into(),
            budgets: snapshot.budgets.into(),
            journals: JournalRegistry::default(),
            ledger: LedgerChains::new(
                config.factory_id.clone(),
                snapshot.ledger.heads,
                snapshot.ledger.logs,
                snapshot.ledger.last_checkpoint,
            ),
            past: PastDecisionRegistry::new(snapshot.ledger.past_decisions),
            former,
            config,
            ids,
            last_row: snapshot.last_row,
        };
        for stored in snapshot.networks {
            let message = stored.message.map(Arc::new);
            let network = Network::new(stored.revision, message, stored.received_at);
            state.networks.put(stored.operation_network_id, network);
        }
        for entry in snapshot.operator_entries {
            state.journals.insert(entry);
        }
        for (id, row) in snapshot.writers {
            state.writers.load(id, row);
        }
        let mut mappings = snapshot.mappings;
        for (row, value) in snapshot.fields {
            let field = load_field(&mut state, row, value, &mut mappings, now)?;
            state.fields.insert(field);
        }
        dependencies::restore(&mut state, now);
        for id in state.writers.active().collect::<Vec<_>>() {
            schedule_keep_alive(&mut state, id);
        }
        let mut changes = ChangeSet::default();
        if let Some(former) = snapshot.ledger.former_retention {
            changes.merge(state_former(&mut state, former, now));
        }
        if is_restored {
            begin_epochs(&mut state, &mut changes, now);
        }
        publish_everything(&state, &mut changes);
        // Another version of the program may count more than the former one.
        hold_back(&mut state, &mut changes, now);
        Ok((state, changes))
    }
}

fn begin_epochs(state: &mut ConnectorState, changes: &mut ChangeSet, now: DateTime) {
    changes.effects.log.push(LogRecord::EpochsBegun);
    changes.writes.writers.are_epochs_begun = true;
    for id in state.writers.active().collect::<Vec<_>>() {
        begin_epoch(state, changes, id, now);
    }
}

fn publish_everything(state: &ConnectorState, changes: &mut ChangeSet) {
    let effects = &mut changes.effects;
    for message in state.networks.active() {
        let id = message.operation_network.operation_network_id.clone();
        effects.twin.push(TwinUpdate::Apply(id));
    }
    // By number: the registry hands its fields out in the order of its hashes, another one each time.
    let mut fields: Vec<&Field> = state.fields.iter().collect();
    fields.sort_unstable_by_key(|field| field.id());
    let open = fields.iter().filter(|field| field.decision().is_open_for(ValueSource::Mapping));
    let published = open.filter_map(|field| field.publish_mapping());
    let with_shadow = fields.iter().filter(|field| field.versions().shadow.is_some());
    let shadows = with_shadow.map(|field| field.publish_shadow());
    // After a failed transaction the engine is ahead of the store: candidates that it yielded meanwhile are on their way,
    // and a state that went back to what is stored would yield the same again after them.
    effects.engine.extend(published.chain(shadows).map(EngineCommand::going_on));
}

fn load_field(
    state: &mut ConnectorState,
    row: FieldRow,
    value: Option<FieldValueRow>,
    mappings: &mut StoredMappings,
    now: DateTime,
) -> Result<Field, UnreadableState> {
    let known = state.networks.request(&row.key.request).map(|(_, request)| request);
    let definition = state.networks.definition(&row.key);
    let (Some(request), Some(definition), Some((request_key, writer))) =
        (known, definition, state.writers.key_of(&row.key.request))
    else {
        // A field without its request cannot be: both are written in one transaction.
        return Err(UnreadableState {
            what: "field",
            reason: format!("{} has no request", row.key),
        });
    };
    let id_and_key = (row.id, request_key.field(definition.name.clone()));
    let field = Field::new(id_and_key, definition.clone(), request.into(), writer, now);
    let versions = mappings.newest_versions.remove(&row.id);
    let shadow = mappings.shadows.remove(&row.id);
    let decision = load_decision(state, row, field.key())?;
    let versions = load_versions(versions, decision.mapping.as_deref(), shadow)?;
    let policy = policy_in_force(state, &field, &decision);
    let (gate, transform) = load_value(value)?;
    Ok(field.with_stored(StoredField { decision, versions, policy, gate, transform }, now))
}

fn load_decision(
    state: &mut ConnectorState,
    row: FieldRow,
    key: &FieldKey,
) -> Result<FieldDecision, UnreadableState> {
    let policy =
        state.fields.parse_policy(row.policy).map_err(UnreadableState::because("policy"))?;
    let mapping = row.mapping.as_deref().map(parse_mapping).transpose()?.map(|mut mapping| {
        state.fields.share_mapping(&mut mapping, key);
        Arc::new(mapping)
    });
    let basis: Option<DecisionBasis> = row
        .basis
        .as_deref()
        .map(serde_json::from_str)
        .transpose()
        .map_err(UnreadableState::because("basis of a decision"))?;
    Ok(FieldDecision {
        mapping_state: row.mapping_state,
        value_source: row.value_source,
        reason: row.reason,
        decided_by: row.decided_by,
        decided_at: row.decided_at,
        mapping,
        policy,
        basis: basis.unwrap_or_default(),
        version: row.consent_version,
    })
}

fn policy_in_force(
    state: &mut ConnectorState,
    field: &Field,
    decision: &FieldDecision,
) -> Arc<DisclosurePolicy> {
    let policy_id = decision.basis.policy_id.as_ref();
    let (policy, _) = effective_policy(state, field, &decision.policy, policy_id);
    state.fields.share_policy(policy, &decision.policy)
}

fn load_value(
    value: Option<FieldValueRow>,
) -> Result<(GateState, Option<TransformState>), UnreadableState> {
    let Some(FieldValueRow { gate, transform }) = value else {
        return Ok((GateState::default(), None));
    };
    let gate = gate_from_json(&gate).map_err(UnreadableState::because("value"))?;
    let transform = transform.as_deref().map(serde_json::from_str).transpose();
    Ok((gate, transform.map_err(UnreadableState::because("transform's state"))?))
}

fn load_versions(
    newest: Option<(u32, Option<String>)>,
    mapping: Option<&Mapping>,
    shadow: Option<ShadowRow>,
) -> Result<MappingVersions, UnreadableState> {
    let is_recorded = match (&newest, mapping) {
        (Some((_, Some(recorded))), Some(mapping)) => parse_mapping(recorded)? == *mapping,
        (newest, mapping) => newest.is_some() && mapping.is_some(),
    };
    let shadow = shadow.map(|row| {
        let mapping = parse_mapping(&row.mapping)?;
        let shadow = ShadowMapping { mapping, author: row.author, started_at: row.started_at };
        Ok::<_, UnreadableState>(Box::new(shadow))
    });
    Ok(MappingVersions {
        newest: newest.map(|(version, _)| version).unwrap_or_default(),
        is_recorded,
        shadow: shadow.transpose()?,
    })
}

fn parse_mapping(json: &str) -> Result<Mapping, UnreadableState> {
    serde_json::from_str(json).map_err(UnreadableState::because("mapping"))
}
