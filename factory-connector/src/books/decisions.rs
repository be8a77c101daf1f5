//! Decisions of the factory's engineer, and what a changed request does to them.

use disclosure::DecisionBasis;
use std::sync::Arc;

use asi_model::{
    DateTime, FieldKey, StatusCode,
    messages::{Decision, DecisionTarget, FactoryMessage, GapCause, MappingState, ValueSource},
};
use mapping_engine::Mapping;

use super::{Books, MappingWork, Traffic, TwinWork, new_message_id};
use crate::store::ConsentRow;
use disclosure::{DisclosurePolicy, DocumentId, PolicyFault};
use ledger::Event;

/// Why a field is undecided again.
const REQUEST_CHANGED: &str = "The partner changed the request.";

/// What is decided about a field.
#[derive(Debug, Clone, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "one at a time, moved once")]
pub enum Verdict {
    /// Values flow from a source, coarsened.
    Map {
        /// The source; [`ValueSource::Mapping`] needs a mapping.
        value_source: ValueSource,
        /// From local variables to the field.
        mapping: Option<Box<Mapping>>,
        /// How values are coarsened.
        policy: DisclosurePolicy,
    },
    /// Not yet decided.
    LeavePending,
    /// No values.
    Refuse,
}

/// Why a decision cannot be taken.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum DecisionError {
    /// There is no such field.
    #[error("there is no such field")]
    UnknownField,
    /// A mapped field needs a mapping.
    #[error("a field with the source MAPPING needs a mapping")]
    NoMapping,
    /// A refusal is told to the partner with its reason.
    #[error("a refusal needs a reason for the partner")]
    NoReason,
    /// The request does not ask for values any more.
    #[error("the request's validity has ended; the partner must ask again")]
    Ended,
    /// There is no such policy, or it is retired.
    #[error("there is no policy {0} that could be applied")]
    UnknownPolicy(DocumentId),
    /// Something else was decided since.
    #[error("something else was decided about the field since; look at it before you change it")]
    DecidedSince,
    /// Nothing is mapped.
    #[error("none of these fields is mapped, so there is no consent to end")]
    NothingToRevoke,
    /// The policy does not fit the field.
    #[error("the disclosure policy does not fit the field")]
    Policy(Vec<PolicyFault>),
}

impl Books {
    /// Decides about a field, tells the partner, and lets values flow or stop.
    ///
    /// # Errors
    /// [`DecisionError`]; then nothing is changed.
    pub fn decide(
        &mut self,
        key: &FieldKey,
        verdict: Verdict,
        reason: Option<String>,
        decided_by: &str,
        now: DateTime,
    ) -> Result<(), DecisionError> {
        self.decide_on(key, verdict, reason, decided_by, DecisionBasis::default(), now)
    }

    /// As [`Self::decide`], on the grounds of a named policy or of rules.
    ///
    /// # Errors
    /// [`DecisionError`]; then nothing is changed.
    pub fn decide_on(
        &mut self,
        key: &FieldKey,
        verdict: Verdict,
        reason: Option<String>,
        decided_by: &str,
        grounds: DecisionBasis,
        now: DateTime,
    ) -> Result<(), DecisionError> {
        let reason = reason.filter(|reason| !reason.trim().is_empty());
        if let Some(id) = grounds.policy_id.as_ref().filter(|id| self.named_policy(id).is_none()) {
            return Err(DecisionError::UnknownPolicy(id.clone()));
        }
        if let Verdict::Map { policy, .. } = &verdict {
            let faults = self.withholding_faults(key, policy);
            if self.fields.contains_key(key) && !faults.is_empty() {
                return Err(DecisionError::Policy(faults));
            }
        }
        let known = self.fields.get(key).ok_or(DecisionError::UnknownField)?;
        if matches!(verdict, Verdict::Map { .. }) && known.validity.has_ended(now) {
            return Err(DecisionError::Ended);
        }
        let effective = match &verdict {
            Verdict::Map { policy, .. } => {
                self.effective_policy(key, known, policy, grounds.policy_id.as_ref()).0
            }
            Verdict::LeavePending | Verdict::Refuse => Arc::clone(known.gate.policy()),
        };
        let Self { fields, shared, .. } = self;
        let field = fields.get_mut(key).ok_or(DecisionError::UnknownField)?;
        let was_mapped = field.decision.is_mapped();
        let had_source = field.decision.value_source;
        let mapping_id = field.mapping_id();
        let decision = &mut field.decision;
        match verdict {
            Verdict::Map { value_source, mapping, policy } => {
                if value_source == ValueSource::Mapping && mapping.is_none() {
                    return Err(DecisionError::NoMapping);
                }
                let faults =
                    policy.faults(field.definition.field_type.0, field.definition.value_rank >= 0);
                if !faults.is_empty() {
                    return Err(DecisionError::Policy(faults));
                }
                let is_other_source = had_source != Some(value_source)
                    || decision.mapping.as_deref() != mapping.as_deref();
                if is_other_source {
                    // A counter goes on through a correction, but does not tell what went on while
                    // nothing was open.
                    let (before, after) = (decision.mapping.as_deref(), mapping.as_deref());
                    let steps = before.zip(after).filter(|_| was_mapped);
                    field.transform = steps.and_then(|(before, after)| {
                        Some(field.transform.as_ref()?.carried_over(&before.steps, &after.steps))
                    });
                }
                field.shelf.is_recorded &=
                    mapping.is_none() || decision.mapping.as_deref() == mapping.as_deref();
                decision.mapping_state = MappingState::Mapped;
                decision.value_source = Some(value_source);
                let mapping = mapping.map(|mut mapping| {
                    shared.share(&mut mapping, &field.key);
                    Arc::new(*mapping)
                });
                decision.mapping = mapping.or_else(|| decision.mapping.take());
                decision.policy = shared.one_policy(Arc::new(policy), field.gate.policy());
                let effective = shared.one_policy(effective, &decision.policy);
                if !was_mapped {
                    field.gate.close();
                    field.traffic = Traffic::new(now);
                }
                field.gate.change_policy(effective, now);
                if is_other_source {
                    field.newest = None;
                }
                if value_source == ValueSource::Mapping {
                    self.aftermath
                        .mappings
                        .extend(field.published().filter(|_| is_other_source || !was_mapped));
                } else if had_source == Some(ValueSource::Mapping) {
                    self.aftermath.mappings.push(MappingWork::Remove(mapping_id));
                }
            }
            Verdict::LeavePending | Verdict::Refuse => {
                if verdict == Verdict::Refuse && reason.is_none() {
                    return Err(DecisionError::NoReason);
                }
                decision.mapping_state = if verdict == Verdict::Refuse {
                    MappingState::Refused
                } else {
                    MappingState::Pending
                };
                decision.value_source = None;
                field.newest = None;
                field.gate.close();
                if had_source == Some(ValueSource::Mapping) {
                    self.aftermath.mappings.push(MappingWork::Remove(mapping_id));
                }
            }
        }
        field.decision.reason = reason;
        field.decision.grounds = grounds;
        field.decision.decided_by = Some(decided_by.to_owned());
        field.decision.decided_at = Some(now);
        field.decision.version += 1;
        let is_mapped = field.decision.is_mapped();
        let (writer, version, reason) =
            (field.writer, field.decision.version, field.decision.reason.clone());
        let has_mapping = field.decision.is_open_for(ValueSource::Mapping);
        if was_mapped && !is_mapped {
            self.consent_ends(
                key,
                version - 1,
                GapCause::Revoked,
                reason.as_deref(),
                Some(decided_by),
            );
        }
        if has_mapping {
            self.record_version(key, Some(decided_by.to_owned()), None, now);
        }
        self.watch(key, now);
        self.tell_watchers(key, now);
        self.note_expiry(key);
        self.told_and_kept(key, now);
        if was_mapped && !is_mapped {
            self.purges.insert(writer, GapCause::Revoked);
        }
        if was_mapped != is_mapped || is_mapped {
            self.refresh_writer(writer, now);
        }
        Ok(())
    }

    /// The request changed in a way that the consent does not cover: the field is undecided again,
    /// its mapping is kept and offered.
    pub(super) fn reopen(&mut self, key: &FieldKey, now: DateTime) {
        let Some(field) = self.fields.get(key) else { return };
        let (was_mapped, writer) = (field.decision.is_mapped(), field.writer);
        if was_mapped {
            let version = field.decision.version;
            self.consent_ends(key, version, GapCause::Revoked, Some(REQUEST_CHANGED), None);
        }
        let Some(field) = self.fields.get_mut(key) else { return };
        if field.decision.is_open_for(ValueSource::Mapping) {
            self.aftermath.mappings.push(MappingWork::Remove(field.mapping_id()));
        }
        field.gate.close();
        field.newest = None;
        field.decision.mapping_state = MappingState::Pending;
        field.decision.value_source = None;
        field.decision.grounds = DecisionBasis::default();
        field.decision.reason = Some(REQUEST_CHANGED.to_owned());
        field.decision.decided_by = None;
        field.decision.decided_at = Some(now);
        field.decision.version += 1;
        self.tell_watchers(key, now);
        self.told_and_kept(key, now);
        if was_mapped {
            self.purges.insert(writer, GapCause::Revoked);
        }
    }

    /// The partner hears of the decision, the ledger and the store keep it, twin and pages show it.
    pub(super) fn told_and_kept(&mut self, key: &FieldKey, now: DateTime) {
        let Some(field) = self.fields.get(key) else { return };
        let decision = &field.decision;
        let (_, policies) = self.effective_policy(
            key,
            field,
            &decision.policy,
            decision.grounds.policy_id.as_ref(),
        );
        let grounds = DecisionBasis { policies, ..decision.grounds.clone() };
        let policy = field.gate.policy();
        let message = Decision {
            message_id: new_message_id(),
            factory_id: self.config.factory_id.clone(),
            target: DecisionTarget::Field {
                operation_network_id: key.request.operation_network_id.clone(),
                operation_id: key.request.operation_id.clone(),
                dynamic_data_request_id: key.request.dynamic_data_request_id.clone(),
                field_name: key.field_name.clone(),
            },
            mapping_state: decision.mapping_state,
            reason: decision.reason.clone(),
            decided_at: now,
            disclosure: field.statement().map(Box::new),
        };
        let consent = ConsentRow {
            field: key.to_string(),
            version: decision.version,
            mapping_state: decision.mapping_state,
            value_source: decision.value_source,
            policy: serde_json::to_string(&**policy)
                .expect("policies have text keys and finite numbers"),
            grounds: (!grounds.is_empty()).then(|| {
                serde_json::to_string(&grounds).expect("grounds have text keys and whole numbers")
            }),
            reason: decision.reason.clone(),
            decided_by: decision.decided_by.clone(),
            decided_at: now,
        };
        let event = Event::Consent {
            field: key.clone(),
            version: decision.version,
            mapping_state: decision.mapping_state,
            value_source: decision.value_source,
            policy: (**policy).clone(),
            decided_by: decision.decided_by.clone(),
            basis: Some(grounds).filter(|basis| !basis.is_empty()),
        };
        self.changes.consents.push(consent);
        self.send(&FactoryMessage::Decision(message), None, now);
        let recipients = self.recipients(&key.request);
        self.record(&recipients, now, None, &event);
        self.store_field(key);
        self.note_due(key);
        self.aftermath.twin.push(TwinWork::Decision(key.clone()));
        self.aftermath.decisions.count += 1;
        self.tell_pages(key);
    }

    /// Why a value of this source is not taken for a field; `None` where it is.
    #[must_use]
    pub fn refusal(
        &self,
        key: &FieldKey,
        source: ValueSource,
        now: DateTime,
    ) -> Option<StatusCode> {
        match self.fields.get(key) {
            None => Some(StatusCode::BAD_NODE_ID_UNKNOWN),
            Some(field) if !field.validity.contains(now) => Some(StatusCode::BAD_INVALID_STATE),
            Some(field) if field.decision.is_open_for(source) => None,
            Some(_) => Some(StatusCode::BAD_NOT_WRITABLE),
        }
    }
}
