//! States of one field in which nothing of another leaves.

use std::{collections::BTreeSet, sync::Arc};

use asi_model::{DataValue, DateTime, FieldKey, FieldName, messages::ValueSource};

use super::{Books, Field};
use disclosure::{DisclosurePolicy, Gate, GateState, PolicyFault};

impl Books {
    /// At the start: whose state decides about whose values. What machines said before is not known
    /// any more; what people and OPC UA clients said still holds, since only this connector takes
    /// it.
    pub(super) fn watch_after_load(&mut self, now: DateTime) {
        let watching: Vec<(FieldKey, BTreeSet<FieldName>)> = self
            .fields
            .iter()
            .map(|field| {
                (field.key.clone(), others(field.gate.policy()).cloned().collect::<BTreeSet<_>>())
            })
            .filter(|(_, others)| !others.is_empty())
            .collect();
        for (key, others) in watching {
            for other in others {
                let watched = key.request.field(other.clone());
                let is_from_machine = self.fields.get(&watched).is_none_or(|field| {
                    !field.decision.is_mapped() || field.decision.is_open_for(ValueSource::Mapping)
                });
                if let Some(field) = self.fields.get_mut(&key).filter(|_| is_from_machine) {
                    field.gate.on_state(now, &other, None);
                }
                self.watchers.entry(watched).or_default().insert(key.clone());
            }
            self.note_due(&key);
        }
    }

    /// Notes which fields' states this field's policy looks at, and tells its gate how they stand.
    pub(super) fn watch(&mut self, key: &FieldKey, now: DateTime) {
        self.unwatch(key);
        let Some(field) = self.fields.get(key) else { return };
        let policy = Arc::clone(field.gate.policy());
        let others: BTreeSet<FieldName> = others(&policy).cloned().collect();
        for other in others {
            let watched = key.request.field(other.clone());
            let is_withheld =
                self.fields.get(&watched).and_then(|field| is_withheld_by(field, &other, &policy));
            self.watchers.entry(watched).or_default().insert(key.clone());
            if let Some(field) = self.fields.get_mut(key) {
                field.gate.on_state(now, &other, is_withheld);
            }
        }
        self.mark_dirty(key);
    }

    /// A gate for trying a policy on a field: it knows how the states stand that the policy looks
    /// at.
    #[must_use]
    pub fn trial_gate(
        &self,
        key: &FieldKey,
        policy: Arc<DisclosurePolicy>,
        now: DateTime,
    ) -> Option<Gate> {
        let field = self.fields.get(key)?;
        let mut gate = Gate::new(
            Arc::clone(&policy),
            field.definition.field_type.0,
            GateState::default(),
            now,
        );
        for other in others(&policy) {
            let watched = self.fields.get(&key.request.field(other.clone()));
            gate.on_state(
                now,
                other,
                watched.and_then(|field| is_withheld_by(field, other, &policy)),
            );
        }
        Some(gate)
    }

    /// The field is gone or its policy looks at no other field any more.
    pub(super) fn unwatch(&mut self, key: &FieldKey) {
        self.watchers.retain(|_, watchers| {
            watchers.remove(key);
            !watchers.is_empty()
        });
    }

    /// A field has another value, or none any more: tells the gates that look at it.
    pub(super) fn tell_watchers(&mut self, key: &FieldKey, now: DateTime) {
        let Some(watchers) = self.watchers.get(key).cloned() else { return };
        for watcher in watchers {
            let Some(policy) =
                self.fields.get(&watcher).map(|field| Arc::clone(field.gate.policy()))
            else {
                continue;
            };
            let is_withheld = self
                .fields
                .get(key)
                .and_then(|field| is_withheld_by(field, &key.field_name, &policy));
            let Some(field) = self.fields.get_mut(&watcher) else { continue };
            if field.gate.on_state(now, &key.field_name, is_withheld) {
                self.after_gate(&watcher, now);
            }
        }
    }

    /// What is wrong with the states that a policy looks at: they must be fields of the same
    /// request.
    pub(super) fn withholding_faults(
        &self,
        key: &FieldKey,
        policy: &DisclosurePolicy,
    ) -> Vec<PolicyFault> {
        others(policy)
            .filter(|other| !self.fields.contains_key(&key.request.field((*other).clone())))
            .map(|other| PolicyFault {
                member: "withholdWhile",
                message: format!("the request has no field {other}; name one of its fields, or none for the own value"),
            })
            .collect()
    }
}

fn others(policy: &DisclosurePolicy) -> impl Iterator<Item = &FieldName> {
    policy.withhold_while.iter().filter_map(|condition| condition.field.as_ref())
}

/// Whether the value of `field`, called `name`, keeps back what a policy withholds; `None` where
/// that is not known.
fn is_withheld_by(field: &Field, name: &FieldName, policy: &DisclosurePolicy) -> Option<bool> {
    let value: &DataValue = field.newest.as_ref().filter(|_| field.decision.is_mapped())?;
    let mut is_any = false;
    for condition in
        policy.withhold_while.iter().filter(|condition| condition.field.as_ref() == Some(name))
    {
        is_any |= condition.is_met_by(value)?;
    }
    Some(is_any)
}
