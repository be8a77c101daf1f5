//! Decisions about fields: map, leave pending, refuse.

use std::sync::Arc;

use asi_model::{
    DateTime, FieldKey,
    messages::{GapCause, MappingState, ValueSource},
};
use disclosure::{CapExcess, CapUsage, DecisionBasis, DisclosurePolicy, DocumentId, PolicyFault};
use mapping::Mapping;

use crate::{
    ChangeSet, ConnectorState, Field,
    change_set::Ending,
    consents, dependencies,
    effects::EngineCommand,
    endings,
    gates::through_gate,
    queries::{cap_usage, effective_policy, opening, shown_tag, variables_of, withholding_faults},
    writes::PreviewRow,
};

/// A decision about a field.
#[derive(Debug, Clone, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "one at a time, moved once")]
pub enum DecisionCommand {
    /// Values flow from a source, coarsened.
    Map {
        /// The source; [`ValueSource::Mapping`] needs a mapping.
        value_source: ValueSource,
        /// Mapping from local variables to the field.
        mapping: Option<Box<Mapping>>,
        policy: DisclosurePolicy,
    },
    /// The field waits for a later decision.
    LeavePending,
    /// The partner gets no values, and a reason.
    Refuse,
}

/// A decision with its reason, its author and its basis.
#[derive(Debug, Clone, PartialEq)]
pub struct DecisionRequest {
    pub command: DecisionCommand,
    /// Reason for the partner; a refusal needs one.
    pub reason: Option<String>,
    /// Name of the user, or of the standing rules.
    pub decided_by: String,
    /// Named policy and rules that the decision rests on.
    pub basis: DecisionBasis,
    /// The preview that the author saw; the consent names its hash.
    pub preview: Option<SeenPreview>,
}

/// A preview that the author of a decision saw.
#[derive(Debug, Clone, PartialEq)]
pub struct SeenPreview {
    pub row: PreviewRow,
    /// The precision that it shows, by the draft and the policies of that time.
    pub effective: Arc<DisclosurePolicy>,
}

/// Reason for which a decision is not taken.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum DecisionError {
    /// No request has this field.
    #[error("there is no such field")]
    UnknownField,
    /// A mapped field needs a mapping.
    #[error("a field with the source MAPPING needs a mapping")]
    NoMapping,
    /// The partner reads the reason of a refusal.
    #[error("a refusal needs a reason for the partner")]
    NoReason,
    /// The request does not ask for values any more.
    #[error("the request's validity has ended; the partner must ask again")]
    Ended,
    /// No such policy exists, or it is retired.
    #[error("there is no policy {0} that could be applied")]
    UnknownPolicy(DocumentId),
    /// Another decision was taken since, or the request was changed.
    #[error("the field is not as it was shown any more; look at it before you decide")]
    DecidedSince,
    /// A policy that contributes to the precision was changed since the preview was shown.
    #[error("the preview shows another precision than would be decided; look at the preview again")]
    AnotherPreview,
    /// No field is mapped.
    #[error("none of these fields is mapped, so there is no consent to end")]
    NothingToRevoke,
    /// The policy does not fit the field.
    #[error("the disclosure policy does not fit the field")]
    Policy(Vec<PolicyFault>),
    /// Partners would get more information than caps allow.
    #[error("partners would get more information than a cap allows: {}", list(.0))]
    OverCap(Vec<CapExcess>),
}

fn list(excesses: &[CapExcess]) -> String {
    excesses.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ")
}

/// Circumstances that several decisions of one use case share.
pub(super) struct Course {
    /// Decisions that end consents share one receipt.
    is_joint: bool,
    /// Sums under the caps, of which each decision takes its share.
    usage: CapUsage,
}

impl Course {
    /// Begins with the fields that are disclosed at present.
    pub(super) fn new(state: &ConnectorState, now: DateTime) -> Self {
        Self { is_joint: false, usage: cap_usage(state, now) }
    }

    /// Begins decisions that end consents and open none.
    pub(super) fn of_ending() -> Self {
        Self { is_joint: true, usage: CapUsage::default() }
    }
}

/// Decides about a field: lets values flow or stop, and notifies the partner.
///
/// # Errors
/// [`DecisionError`].
pub fn decide(
    state: &mut ConnectorState,
    key: &FieldKey,
    request: DecisionRequest,
    now: DateTime,
) -> Result<ChangeSet, DecisionError> {
    let mut changes = ChangeSet::default();
    let mut course = Course::new(state, now);
    decide_in(state, &mut changes, key, request, &mut course, now)?;
    Ok(changes)
}

/// Decides about a field provided that it still is as it was shown to the person who decides, by its
/// [`shown_tag`]; without a tag as it is.
///
/// # Errors
/// [`DecisionError`].
pub fn decide_as_shown(
    state: &mut ConnectorState,
    key: &FieldKey,
    tag: Option<&str>,
    request: DecisionRequest,
    now: DateTime,
) -> Result<ChangeSet, DecisionError> {
    let present = shown_tag(state, key).ok_or(DecisionError::UnknownField)?;
    if tag.is_some_and(|tag| tag != present) {
        return Err(DecisionError::DecidedSince);
    }
    decide(state, key, request, now)
}

/// Decides within a larger use case.
pub(super) fn decide_in(
    state: &mut ConnectorState,
    changes: &mut ChangeSet,
    key: &FieldKey,
    request: DecisionRequest,
    course: &mut Course,
    now: DateTime,
) -> Result<(), DecisionError> {
    let may_end = !matches!(request.command, DecisionCommand::Map { .. });
    let before = endings::disclosed(state, may_end.then_some(key).into_iter(), now);
    take(state, changes, key, request, course, now)?;
    endings::note(state, changes, before, now);
    Ok(())
}

fn take(
    state: &mut ConnectorState,
    changes: &mut ChangeSet,
    key: &FieldKey,
    mut request: DecisionRequest,
    course: &mut Course,
    now: DateTime,
) -> Result<(), DecisionError> {
    request.reason = request.reason.filter(|reason| !reason.trim().is_empty());
    check(state, key, &request, now)?;
    // Last of what can refuse: a share of a cap that was taken is not given back.
    admit(state, key, &request, &mut course.usage)?;
    let Some(field) = state.field(key) else { return Err(DecisionError::UnknownField) };
    let (was_mapped, writer, version) =
        (field.decision().is_mapped(), field.writer(), field.decision().version);
    let DecisionRequest { command, reason, decided_by, mut basis, preview } = request;
    basis.preview = preview.as_ref().map(|preview| preview.row.hash.clone());
    changes.writes.fields.previews.extend(preview.map(|preview| preview.row));
    let policy_id = basis.policy_id.clone();
    match command {
        DecisionCommand::Map { value_source, mapping, policy } => {
            let opening = Opening { value_source, mapping, policy, policy_id };
            open(state, changes, key, opening, now);
        }
        DecisionCommand::LeavePending => close(state, changes, key, MappingState::Pending, now),
        DecisionCommand::Refuse => close(state, changes, key, MappingState::Refused, now),
    }
    let Some(mut field) = state.fields.get_mut(key) else { return Ok(()) };
    let (is_mapped, has_mapping) = field.change_decision(|decision| {
        decision.reason.clone_from(&reason);
        decision.basis = basis;
        decision.decided_by = Some(decided_by.clone());
        // Also one that repeats the last: ledger and partner name each decision by its number.
        decision.follow(now);
        (decision.is_mapped(), decision.is_open_for(ValueSource::Mapping))
    });
    if was_mapped && !is_mapped {
        let ending = Ending {
            cause: GapCause::Revoked,
            reason: reason.as_deref(),
            revoked_by: Some(&decided_by),
            is_joint: course.is_joint,
        };
        // The number of the consent that ends, not of the decision that ends it.
        consents::end(state, changes, key, version, ending);
        // Reports that wait were made under that consent, and must not leave after the receipt that
        // says what had left.
        changes.purge(writer, GapCause::Revoked);
    }
    if has_mapping {
        consents::record_version(state, changes, key, (Some(decided_by), None), now);
    }
    dependencies::update(state, key, now);
    dependencies::notify(state, key, now);
    consents::record(state, changes, key, now);
    // Any other field is in no data set, before or after.
    if was_mapped || is_mapped {
        changes.to_refresh.insert(writer, now);
    }
    Ok(())
}

/// Checks everything that can forbid a decision, before anything is changed.
fn check(
    state: &ConnectorState,
    key: &FieldKey,
    request: &DecisionRequest,
    now: DateTime,
) -> Result<(), DecisionError> {
    let named = request.basis.policy_id.as_ref();
    if let Some(id) = named.filter(|id| state.policies.applicable(id).is_none()) {
        return Err(DecisionError::UnknownPolicy(id.clone()));
    }
    let field = state.field(key).ok_or(DecisionError::UnknownField)?;
    match &request.command {
        DecisionCommand::Map { value_source, mapping, policy } => {
            let mut faults = withholding_faults(state, key, policy);
            faults.extend(policy.faults(field.definition().field_type.0, field.is_array()));
            if !faults.is_empty() {
                return Err(DecisionError::Policy(faults));
            }
            if field.validity().has_ended(now) {
                return Err(DecisionError::Ended);
            }
            if *value_source == ValueSource::Mapping && mapping.is_none() {
                return Err(DecisionError::NoMapping);
            }
            let shows_another = |preview: &SeenPreview| {
                preview.effective != effective_policy(state, field, policy, named).0
            };
            if request.preview.as_ref().is_some_and(shows_another) {
                return Err(DecisionError::AnotherPreview);
            }
            Ok(())
        }
        DecisionCommand::Refuse if request.reason.is_none() => Err(DecisionError::NoReason),
        DecisionCommand::Refuse | DecisionCommand::LeavePending => Ok(()),
    }
}

/// Checks that a decision keeps within all caps, and takes its share of them.
fn admit(
    state: &ConnectorState,
    key: &FieldKey,
    request: &DecisionRequest,
    usage: &mut CapUsage,
) -> Result<(), DecisionError> {
    let DecisionCommand::Map { value_source, mapping, policy } = &request.command else {
        return Ok(());
    };
    let Some(field) = state.field(key).filter(|_| !usage.is_empty()) else { return Ok(()) };
    let mapping = mapping.as_deref().filter(|_| *value_source == ValueSource::Mapping);
    let variables = mapping.map(|mapping| variables_of(&mapping.inputs)).unwrap_or_default();
    let (policy, _) = effective_policy(state, field, policy, request.basis.policy_id.as_ref());
    let changes = opening(state, key, policy, variables);
    usage.exchange(&changes).map_err(DecisionError::OverCap)
}

/// A decision to let values flow.
struct Opening {
    value_source: ValueSource,
    mapping: Option<Box<Mapping>>,
    policy: DisclosurePolicy,
    policy_id: Option<DocumentId>,
}

fn open(
    state: &mut ConnectorState,
    changes: &mut ChangeSet,
    key: &FieldKey,
    opening: Opening,
    now: DateTime,
) {
    let Opening { value_source, mapping, policy, policy_id } = opening;
    let Some(field) = state.fields.get(key) else { return };
    let (effective, _) = effective_policy(state, field, &policy, policy_id.as_ref());
    let policy_before = Arc::clone(field.gate().policy());
    let policy = state.fields.share_policy(Arc::new(policy), &policy_before);
    let effective = state.fields.share_policy(effective, &policy);
    let mapping = mapping.map(|mut mapping| {
        state.fields.share_mapping(&mut mapping, key);
        Arc::new(*mapping)
    });
    let Some(mut field) = state.fields.get_mut(key) else { return };
    let was_mapped = field.decision().is_mapped();
    let had_mapping_source = field.decision().value_source == Some(ValueSource::Mapping);
    let is_other_source = field.decision().value_source != Some(value_source)
        || (value_source == ValueSource::Mapping
            && field.decision().mapping.as_deref() != mapping.as_deref());
    // Waiting reports were made by the former policy and source. A wider policy lets all of them out,
    // so they may leave; by any other they might say more than the person who decides has seen.
    if was_mapped && (is_other_source || !effective.allows_all_of(&policy_before)) {
        changes.purge_replaced(field.writer());
    }
    if is_other_source {
        let transform = transform_after(&field, mapping.as_deref());
        field.begin_source(transform, now);
    }
    let is_recorded = field.versions().is_recorded
        && (mapping.is_none() || field.decision().mapping.as_deref() == mapping.as_deref());
    field.set_recorded(is_recorded);
    field.change_decision(|decision| {
        decision.mapping_state = MappingState::Mapped;
        decision.value_source = Some(value_source);
        decision.mapping = mapping.or_else(|| decision.mapping.take());
        decision.policy = policy;
    });
    // A consent that goes on keeps its gate: a correction must not begin a fresh interval, by which
    // the partner would get a value before its time.
    if !was_mapped {
        field.begin_consent(now);
    }
    let id = field.id();
    through_gate(state, id, now, |gate| gate.change_policy(effective, now));
    let Some(field) = state.fields.get(key) else { return };
    if value_source == ValueSource::Mapping {
        // The engine runs an unchanged mapping already.
        let is_new = is_other_source || !was_mapped;
        changes.effects.engine.extend(field.publish_mapping().filter(|_| is_new));
    } else if had_mapping_source {
        changes.effects.engine.push(EngineCommand::Remove(field.mapping_id()));
    }
}

/// Returns the state with which another mapping continues: a counter goes on through a correction,
/// but does not reveal what was counted while nothing was open.
fn transform_after(field: &Field, mapping: Option<&Mapping>) -> Option<mapping::TransformState> {
    mapping.filter(|_| field.decision().is_mapped()).and_then(|mapping| field.state_for(mapping))
}

fn close(
    state: &mut ConnectorState,
    changes: &mut ChangeSet,
    key: &FieldKey,
    mapping_state: MappingState,
    now: DateTime,
) {
    let Some(mut field) = state.fields.get_mut(key) else { return };
    if field.decision().is_open_for(ValueSource::Mapping) {
        changes.effects.engine.push(EngineCommand::Remove(field.mapping_id()));
    }
    field.change_decision(|decision| {
        decision.mapping_state = mapping_state;
        decision.value_source = None;
    });
    field.close(now);
}
