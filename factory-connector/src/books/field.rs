//! Requested fields: the decision about each, and its gate.

use disclosure::{DecisionBasis, disclosure_statement, gate_from_json, gate_to_json};
use std::{collections::BTreeSet, sync::Arc};

use asi_model::{
    DateTime, FieldKey, FieldName, RequestKey, StatusCode,
    messages::{DisclosureStatement, MappingState, ValueSource},
    network::{DynamicDataRequest, ReportField},
};
use mapping_engine::{Mapping, MappingId, Published, TargetKey, TransformState};
use twin::FieldRecord;

use super::{Aftermath, Books, MappingWork, Shelf, Traffic, TwinWork, Validity};
use crate::store::{FieldRow, FieldValueRow, StoreError};
use disclosure::{DisclosurePolicy, Gate, GateState};

/// A requested field.
#[derive(Debug, Clone)]
pub struct Field {
    /// Its key.
    pub key: FieldKey,
    /// Our number for it.
    pub id: i64,
    /// As requested.
    pub definition: ReportField,
    /// What was decided.
    pub decision: FieldDecision,
    /// What of its values leaves.
    pub gate: Gate,
    /// How many values come and leave.
    pub traffic: Traffic,
    /// From when and until when its request asks for values.
    pub validity: Validity,
    /// What came last, before its gate; not kept over restarts.
    pub newest: Option<asi_model::DataValue>,
    /// What its mapping's functions remember.
    pub transform: Option<TransformState>,
    /// Versions and shadow of its mapping.
    pub shelf: Shelf,
    /// The writer of its request.
    pub writer: u16,
    /// When its gate is noted to be asked again.
    pub noted_due: Option<DateTime>,
    /// What the transaction that is being made holds of it already.
    pub marks: Marks,
}

/// Where a transaction holds something about a field, so that it holds the newest only. A place may
/// be of a former transaction: what stands there tells.
#[derive(Debug, Clone, Copy, Default)]
pub struct Marks {
    /// Its state is to be written.
    pub is_dirty: bool,
    /// A value of it has left its gate.
    pub has_left: bool,
    /// Its place among the events.
    pub told: usize,
}

/// What the engineer decided about a field.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FieldDecision {
    /// Pending, mapped or refused.
    pub mapping_state: MappingState,
    /// Where values come from; present exactly while mapped.
    pub value_source: Option<ValueSource>,
    /// Why.
    pub reason: Option<String>,
    /// Who.
    pub decided_by: Option<String>,
    /// When.
    pub decided_at: Option<DateTime>,
    /// The mapping in force, or the one to offer again.
    pub mapping: Option<Arc<Mapping>>,
    /// How values are coarsened at least: what was consented to. The gate's policy is what holds.
    pub policy: Arc<DisclosurePolicy>,
    /// On what the decision rests beside the engineer's words.
    pub grounds: DecisionBasis,
    /// Counts the consents.
    pub version: u32,
}

impl FieldDecision {
    /// Values flow.
    #[must_use]
    pub fn is_mapped(&self) -> bool {
        self.mapping_state == MappingState::Mapped
    }

    /// Values flow from this source.
    #[must_use]
    pub fn is_open_for(&self, source: ValueSource) -> bool {
        self.is_mapped() && self.value_source == Some(source)
    }
}

impl Field {
    /// The mapping's id in the engine.
    #[must_use]
    pub fn mapping_id(&self) -> MappingId {
        mapping_id(self.id)
    }

    /// Neither rules nor an engineer have said anything about it since it came or changed.
    #[must_use]
    pub fn is_undecided(&self) -> bool {
        self.decision.mapping_state == MappingState::Pending && self.decision.decided_by.is_none()
    }

    /// What the partner is told about its precision, while the field is mapped.
    #[must_use]
    pub fn statement(&self) -> Option<DisclosureStatement> {
        self.decision
            .is_mapped()
            .then(|| disclosure_statement(self.gate.policy(), self.definition.unit.as_deref()))
    }

    /// What the twin shows.
    #[must_use]
    pub fn record(&self) -> FieldRecord {
        let decision = &self.decision;
        FieldRecord {
            mapping_state: decision.mapping_state,
            value_source: decision.value_source,
            value: self
                .gate
                .disclosed()
                .cloned()
                .unwrap_or_else(|| waiting_value(decision.decided_at)),
            disclosure: self.statement().map(|statement| Arc::from(statement.description)),
            reason: decision.reason.as_deref().map(Arc::from),
            decided_by: decision.decided_by.as_deref().map(Arc::from),
            decision_time: decision.decided_at,
        }
    }

    /// Work for the mapping engine: the mapping in force, which goes on from what its functions
    /// remember.
    pub(super) fn published(&self) -> Option<MappingWork> {
        let published =
            Published::new(Arc::clone(self.decision.mapping.as_ref()?), TargetKey(self.id));
        Some(MappingWork::Put(Published { state: self.transform.clone(), ..published }))
    }

    /// Its gate or transform state has to be written.
    pub(super) fn mark_dirty(&mut self, dirty: &mut Vec<i64>) {
        if !std::mem::replace(&mut self.marks.is_dirty, true) {
            dirty.push(self.id);
        }
    }

    /// Notes when its gate wants to be asked again.
    pub(super) fn note_due(&mut self, all: &mut BTreeSet<(DateTime, i64)>) {
        let due = self.gate.due();
        if due != self.noted_due {
            if let Some(noted) = self.noted_due {
                all.remove(&(noted, self.id));
            }
            if let Some(due) = due {
                all.insert((due, self.id));
            }
            self.noted_due = due;
        }
    }

    /// Open pages hear how it stands.
    pub(super) fn tell_pages(&mut self, aftermath: &mut Aftermath) {
        let news = aftermath.news_of(&mut self.marks.told, &self.key);
        news.mapping_state = self.decision.mapping_state;
        news.consent_version = self.decision.version;
        news.is_withheld = self.decision.is_mapped() && self.gate.is_withheld();
        match (&mut news.value, self.gate.disclosed()) {
            (Some(older), Some(value)) => older.clone_from(value),
            (older, value) => *older = value.cloned(),
        }
    }

    /// As stored.
    pub(crate) fn row(&self) -> FieldRow {
        let decision = &self.decision;
        FieldRow {
            id: self.id,
            key: self.key.clone(),
            mapping_state: decision.mapping_state,
            value_source: decision.value_source,
            reason: decision.reason.clone(),
            decided_by: decision.decided_by.clone(),
            decided_at: decision.decided_at,
            mapping: decision.mapping.as_ref().map(|mapping| {
                serde_json::to_string(&**mapping)
                    .expect("mappings have text keys and finite numbers")
            }),
            policy: serde_json::to_string(&*decision.policy)
                .expect("policies have text keys and finite numbers"),
            grounds: (!decision.grounds.is_empty()).then(|| {
                serde_json::to_string(&decision.grounds)
                    .expect("grounds have text keys and whole numbers")
            }),
            consent_version: decision.version,
        }
    }

    /// Where its values stand, as stored.
    pub(crate) fn value_row(&self) -> FieldValueRow {
        FieldValueRow {
            gate: gate_to_json(&self.gate.state()),
            transform: self.transform.as_ref().map(|state| {
                serde_json::to_string(state)
                    .expect("transform states have text keys and finite numbers")
            }),
        }
    }
}

/// The id of a field's mapping in the engine.
pub(crate) fn mapping_id(field_id: i64) -> MappingId {
    MappingId::new(format!("field-{field_id}")).expect("short and without control characters")
}

/// What a mapped field shows before its first value.
pub(crate) fn waiting_value(since: Option<DateTime>) -> asi_model::DataValue {
    asi_model::DataValue::status_only(StatusCode::BAD_WAITING_FOR_INITIAL_DATA, since)
}

impl Books {
    /// A field, as requested and decided.
    #[must_use]
    pub fn field(&self, key: &FieldKey) -> Option<&Field> {
        self.fields.get(key)
    }

    /// The fields of a request whose document is at hand, in payload order.
    pub fn fields_in<'b>(
        &'b self,
        key: &'b RequestKey,
        request: &'b DynamicDataRequest,
    ) -> impl Iterator<Item = (FieldKey, &'b Field)> {
        request.report_data_format.report_field_list.iter().filter_map(move |definition| {
            let key = key.field(definition.name.clone());
            self.fields.get(&key).map(|field| (key, field))
        })
    }

    /// The fields of a request, in payload order.
    pub fn fields_of<'b>(
        &'b self,
        request: &'b RequestKey,
    ) -> impl Iterator<Item = (FieldKey, &'b Field)> {
        self.request(request).into_iter().flat_map(move |(_, document)| {
            document.report_data_format.report_field_list.iter().filter_map(move |definition| {
                let key = request.field(definition.name.clone());
                self.fields.get(&key).map(|field| (key, field))
            })
        })
    }

    pub(super) fn load_field(
        &mut self,
        row: FieldRow,
        value: Option<FieldValueRow>,
        now: DateTime,
    ) -> Result<(), StoreError> {
        self.last_field = self.last_field.max(row.id);
        let (Some(definition), Some((request, writer))) = (
            self.definition(&row.key.request, &row.key.field_name),
            self.writer_of.get_key_value(&row.key.request),
        ) else {
            // A field without its request cannot be: both are written in one transaction.
            return Err(StoreError::Unreadable {
                what: "field",
                reason: format!("{} has no request", row.key),
            });
        };
        // The fields of a request share its texts.
        let (key, writer) = (request.field(definition.name.clone()), *writer);
        let unreadable = |what| {
            move |error: serde_json::Error| StoreError::Unreadable {
                what,
                reason: error.to_string(),
            }
        };
        let policy = self.shared.policy(row.policy).map_err(unreadable("policy"))?;
        let mapping: Option<Mapping> = row
            .mapping
            .as_deref()
            .map(serde_json::from_str)
            .transpose()
            .map_err(unreadable("mapping"))?;
        let mapping = mapping.map(|mut mapping| {
            self.shared.share(&mut mapping, &key);
            Arc::new(mapping)
        });
        let (gate, transform) = match value {
            None => (GateState::default(), None),
            Some(value) => (
                gate_from_json(&value.gate)
                    .map_err(|reason| StoreError::Unreadable { what: "value", reason })?,
                value
                    .transform
                    .as_deref()
                    .map(serde_json::from_str)
                    .transpose()
                    .map_err(unreadable("transform's state"))?,
            ),
        };
        let grounds: DecisionBasis = row
            .grounds
            .as_deref()
            .map(serde_json::from_str)
            .transpose()
            .map_err(unreadable("grounds"))?
            .unwrap_or_default();
        let validity = self.validity_of(&key);
        let mut field = Field {
            key,
            id: row.id,
            gate: Gate::new(
                Arc::clone(&policy),
                definition.field_type.0,
                GateState::default(),
                now,
            ),
            definition,
            decision: FieldDecision {
                mapping_state: row.mapping_state,
                value_source: row.value_source,
                reason: row.reason,
                decided_by: row.decided_by,
                decided_at: row.decided_at,
                mapping,
                policy,
                grounds,
                version: row.consent_version,
            },
            traffic: Traffic::new(now),
            validity,
            newest: None,
            transform,
            shelf: Shelf::default(),
            writer,
            noted_due: None,
            marks: Marks::default(),
        };
        let decision = &field.decision;
        let policy_id = decision.grounds.policy_id.as_ref();
        let (effective, _) = self.effective_policy(&field.key, &field, &decision.policy, policy_id);
        let effective = self.shared.one_policy(effective, &decision.policy);
        field.gate = Gate::new(effective, field.definition.field_type.0, gate, now);
        field.note_due(&mut self.due);
        let key = field.key.clone();
        self.fields.insert(field);
        self.note_expiry(&key);
        Ok(())
    }

    fn definition(&self, request: &RequestKey, name: &FieldName) -> Option<ReportField> {
        let (_, document) = self.request(request)?;
        document
            .report_data_format
            .report_field_list
            .iter()
            .find(|field| field.name == *name)
            .cloned()
    }

    /// Puts a field's decision among the changes.
    pub(crate) fn store_field(&mut self, key: &FieldKey) {
        if let Some(field) = self.fields.get(key) {
            self.changes.fields.insert(field.id, field.row());
        }
        self.mark_dirty(key);
    }

    /// A field's gate or transform state has to be written.
    pub(super) fn mark_dirty(&mut self, key: &FieldKey) {
        if let Some(field) = self.fields.get_mut(key) {
            field.mark_dirty(&mut self.dirty_fields);
        }
    }

    /// Notes when a field's gate wants to be asked again.
    pub(crate) fn note_due(&mut self, key: &FieldKey) {
        if let Some(field) = self.fields.get_mut(key) {
            field.note_due(&mut self.due);
        }
    }

    /// Open pages hear how a field stands.
    pub(super) fn tell_pages(&mut self, key: &FieldKey) {
        if let Some(field) = self.fields.get_mut(key) {
            field.tell_pages(&mut self.aftermath);
        }
    }

    /// At the start: everything that the twin shows and the engine runs.
    pub(super) fn show_everything(&mut self) {
        for (id, network) in &self.networks {
            if network.message.is_some() {
                self.aftermath.twin.push(TwinWork::Apply(id.clone()));
            }
        }
        let open =
            self.fields.iter().filter(|field| field.decision.is_open_for(ValueSource::Mapping));
        self.aftermath.mappings.extend(open.filter_map(Field::published));
        let with_shadow = self.fields.iter().filter(|field| field.shelf.shadow.is_some());
        for key in with_shadow.map(|field| field.key.clone()).collect::<Vec<_>>() {
            self.show_shadow(&key);
        }
    }
}
