//! Preview of a decision: exactly the message that a partner would receive.

use std::{collections::BTreeSet, sync::Arc};

use asi_model::{
    DataValue, DateTime, FieldKey, StatusCode,
    messages::ValueSource,
    pubsub::json::{NetworkMessageHeader, encode_data_set_message},
};
use axum::{Json, extract::State};
use connector_state::{ConnectorState, operator::typed_value, queries};
use daemon::web::{ApiJson, ApiPath, Problem};
use disclosure::{
    CapExcess, DisclosurePolicy, DocumentId, DraftGate, Effect, GateOutcome, LeakWarning,
    Statement, VariableKey, effects, leak_warnings,
};
use mapping_engine::{DryRunSample, FaultKind, MappingDiagnostic, TraceRun};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::{
    context::Api,
    dry_runs::present_value,
    fields::{MappingDraft, draft_text, mapping_of},
    paths::FieldPath,
    previews::ShownPreview,
    problems::{Problems, engine},
    roles::{BeforeGate, Engineer},
    values::ShownValue,
};
use crate::clock::{new_message_id, new_preview_id, now};

/// Draft of a decision.
#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct Draft {
    /// `MAPPING`, `MANUAL` or `EXTERNAL`.
    pub(super) value_source: ValueSource,
    /// Needed with the source `MAPPING`.
    pub(super) mapping: Option<MappingDraft>,
    /// Coarsening of the values.
    #[serde(default)]
    pub(super) disclosure: DisclosurePolicy,
    /// Id of a named policy that would apply besides.
    pub(super) policy_id: Option<DocumentId>,
}

/// A variable with its present value.
#[derive(Serialize, ToSchema)]
pub struct InputView {
    /// Its name in the mapping.
    name: String,
    /// Value, status and time.
    #[serde(flatten)]
    value: ShownValue,
}

/// Result of one function.
#[derive(Serialize, ToSchema)]
pub struct StepView {
    /// Name of the function.
    function: String,
    /// Its result; none if it yielded none or failed.
    value: Option<ShownValue>,
    /// Kind of its fault, for programs; none if it succeeded.
    kind: Option<FaultKind>,
    /// Text of its fault; none if it succeeded.
    message: Option<String>,
}

/// Side by side: machine, mapping, what is disclosed, and the message.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct Preview {
    /// Id by which a decision names this preview, for some minutes.
    preview_id: String,
    /// Present values of the variables.
    inputs: Vec<InputView>,
    /// Results of the mapping's functions, in order.
    steps: Vec<StepView>,
    /// Result of the mapping.
    candidate: Option<ShownValue>,
    /// Coarsened value that would leave; none if nothing would.
    disclosed: Option<ShownValue>,
    /// Time at which it would leave; none if at once.
    disclosed_at: Option<DateTime>,
    /// Statement of the precision that the partner reads.
    #[serde(flatten)]
    statement: Statement,
    /// Policy that would apply: the strictest of the draft, the named policy and the recipients'
    /// policies.
    effective_disclosure: DisclosurePolicy,
    /// Effect of each part of the policy on this value.
    effects: Vec<Effect>,
    #[serde(flatten)]
    leaks: Leaks,
    /// True where nothing would leave now: the policy withholds the present state, or one that is
    /// not known.
    is_withheld: bool,
    /// The NetworkMessage that the partner would receive, byte for byte but for its id, numbers and
    /// times.
    message: Option<String>,
    /// Errors and warnings about the mapping.
    diagnostics: Vec<MappingDiagnostic>,
}

/// Information that the decision would let out.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct Leaks {
    /// Conclusions that the decision would permit to partners.
    warnings: Vec<LeakWarning>,
    /// Caps that the decision would exceed, so that it would be refused.
    cap_excesses: Vec<CapExcess>,
}

/// Runs a draft on the live values of its inputs; nothing is changed and nothing leaves.
#[utoipa::path(
    post,
    path = "/preview",
    tag = "fields",
    params(FieldPath),
    request_body = Draft,
    responses((status = 200, body = Preview), Problems)
)]
pub async fn preview_decision(
    user: Engineer,
    State(api): State<Api>,
    ApiPath(path): ApiPath<FieldPath>,
    ApiJson(draft): ApiJson<Draft>,
) -> Result<Json<Preview>, Problem> {
    let field = path.into_key();
    let shown_draft = draft_text(
        draft.value_source,
        draft.mapping.as_ref(),
        &draft.disclosure,
        draft.policy_id.as_ref(),
    );
    let preview = preview_of(&api, field.clone(), draft, BeforeGate::from(&user)).await?;
    api.previews.remember(ShownPreview {
        preview_id: preview.preview_id.clone(),
        user: user.principal.user_name.clone(),
        field,
        draft: shown_draft,
        text: serde_json::to_string(&preview).map_err(|error| Problem::internal(&error))?,
        effective: preview.effective_disclosure.clone(),
    });
    Ok(Json(preview))
}

/// Computes the preview of a draft.
async fn preview_of(
    api: &Api,
    field: FieldKey,
    draft: Draft,
    before_gate: BeforeGate,
) -> Result<Preview, Problem> {
    let now = now();
    let policy = effective(api, &field, draft.disclosure, draft.policy_id).await?;
    let is_mapping = draft.value_source == ValueSource::Mapping;
    let inputs = draft.mapping.as_ref().filter(|_| is_mapping).map(|mapping| &mapping.inputs[..]);
    let variables = queries::variables_of(inputs.unwrap_or_default());
    let mut preview = Preview {
        preview_id: new_preview_id(),
        inputs: Vec::new(),
        steps: Vec::new(),
        candidate: None,
        disclosed: None,
        disclosed_at: None,
        statement: statement(api, &field, &policy).await?,
        effective_disclosure: (*policy).clone(),
        effects: Vec::new(),
        leaks: leaks(api, &field, &policy, variables, now).await?,
        is_withheld: false,
        message: None,
        diagnostics: Vec::new(),
    };
    let candidate = match (draft.value_source, draft.mapping) {
        (ValueSource::Mapping, Some(mapping)) => {
            run(api, &field, mapping, (&mut preview, before_gate), now).await?
        }
        (ValueSource::Mapping, None) => None,
        _ => current(api, &field).await?,
    };
    let Some(candidate) = candidate else { return Ok(preview) };
    preview.candidate = Some(ShownValue::before_gate(&candidate, before_gate));
    let shown = api
        .coordinator
        .read(move |state| {
            let field_type = state.field(&field)?.definition().field_type.0;
            let mut gate = queries::draft_gate(state, &field, Arc::clone(&policy), now)?;
            let outcome = gate.on(now, candidate.clone());
            let is_withheld = outcome == GateOutcome::Suppressed;
            let effects = effects(&policy, field_type, &candidate, is_withheld, now);
            // A value that is delayed or waits for working hours leaves at its due time.
            let mut held_until = None;
            while let Some(due) = gate.due().filter(|_| gate.shown().is_none()) {
                held_until = Some(due);
                gate.on_time(due);
            }
            let shown = gate.shown().map(|disclosed| {
                let message = message(state, &field, &gate, now);
                (ShownValue::before_gate(disclosed, before_gate), held_until, message)
            });
            Some((effects, is_withheld, shown))
        })
        .await?;
    if let Some((effects, is_withheld, shown)) = shown {
        preview.effects = effects;
        preview.is_withheld = is_withheld;
        if let Some((disclosed, held_until, message)) = shown {
            preview.disclosed = Some(disclosed);
            preview.disclosed_at = held_until;
            preview.message = message;
        }
    }
    Ok(preview)
}

/// The precision that would hold.
async fn effective(
    api: &Api,
    field: &FieldKey,
    draft: DisclosurePolicy,
    policy_id: Option<DocumentId>,
) -> Result<Arc<DisclosurePolicy>, Problem> {
    let key = field.clone();
    let found = api
        .coordinator
        .read(move |state| {
            let field = state.field(&key)?;
            Some(queries::effective_policy(state, field, &draft, policy_id.as_ref()).0)
        })
        .await?;
    found.ok_or_else(|| Problem::not_found("such field"))
}

/// Returns the conclusions that any partner could draw with this field, once each, and the caps that
/// it would exceed.
async fn leaks(
    api: &Api,
    field: &FieldKey,
    policy: &Arc<DisclosurePolicy>,
    variables: BTreeSet<VariableKey>,
    now: DateTime,
) -> Result<Leaks, Problem> {
    let (key, policy) = (field.clone(), Arc::clone(policy));
    let found = api
        .coordinator
        .read(move |state| {
            let mut warnings: Vec<LeakWarning> = Vec::new();
            let open = queries::open_fields(state, now, Some((&key, &policy)));
            for warning in open.into_values().flat_map(|fields| leak_warnings(&fields)) {
                if warning.fields.contains(&key) && !warnings.contains(&warning) {
                    warnings.push(warning);
                }
            }
            let cap_excesses = queries::opening_excesses(state, &key, policy, variables, now);
            Leaks { warnings, cap_excesses }
        })
        .await?;
    Ok(found)
}

async fn statement(
    api: &Api,
    field: &FieldKey,
    policy: &DisclosurePolicy,
) -> Result<Statement, Problem> {
    let key = field.clone();
    let unit = api
        .coordinator
        .read(move |state| state.field(&key).map(|field| field.definition().unit.clone()))
        .await?;
    let unit = unit.ok_or_else(|| Problem::not_found("such field"))?;
    Ok(Statement::of(policy, unit.as_deref()))
}

/// The mapping's result on the live values of its inputs.
async fn run(
    api: &Api,
    field: &FieldKey,
    draft: MappingDraft,
    (preview, before_gate): (&mut Preview, BeforeGate),
    now: DateTime,
) -> Result<Option<DataValue>, Problem> {
    let mapping = mapping_of(api, field, draft).await?;
    let target_type = mapping.built_in_type();
    let mut samples = Vec::new();
    for input in &mapping.inputs {
        let Some(value) = present_value(api, input).await? else { continue };
        let shown = ShownValue::before_gate(&value, before_gate);
        preview.inputs.push(InputView { name: input.name.clone(), value: shown });
        samples.push(DryRunSample { input: input.name.clone(), at: now, value });
    }
    // A counter goes on from what was published rather than from zero.
    let (key, draft) = (field.clone(), mapping.clone());
    let state = api
        .coordinator
        .read(move |state| state.field(&key).and_then(|field| field.state_for(&draft)))
        .await?;
    let trace = api.engine.dry_run(mapping, samples, state).await.map_err(engine)?;
    let trace = trace.seen_by(before_gate);
    preview.diagnostics = trace.diagnostics;
    let last: Option<TraceRun> = trace.runs.into_iter().next_back();
    let Some(last) = last else { return Ok(None) };
    preview.steps = last
        .steps
        .into_iter()
        .map(|step| StepView {
            function: step.function,
            value: step.value.map(|result| ShownValue::of_function(result, before_gate)),
            kind: step.fault.as_ref().map(|fault| fault.kind),
            message: step.fault.map(|fault| fault.message),
        })
        .collect();
    Ok(last.candidate.map(|candidate| {
        let at = candidate.source_timestamp.unwrap_or(now);
        let value = typed_value(&candidate.value, target_type, at).unwrap_or_default();
        DataValue {
            status: StatusCode(candidate.status),
            source_timestamp: candidate.source_timestamp,
            ..value
        }
    }))
}

async fn current(api: &Api, field: &FieldKey) -> Result<Option<DataValue>, Problem> {
    let field = field.clone();
    Ok(api
        .coordinator
        .read(move |state| {
            let field = state.field(&field)?;
            field.gate().disclosed().map(|released| DataValue::clone(released))
        })
        .await?)
}

/// The message as it would be sent with the next number: the request's other open fields, and this
/// one where the request has it.
fn message(
    state: &ConnectorState,
    field: &FieldKey,
    draft: &DraftGate,
    now: DateTime,
) -> Option<String> {
    let frame = queries::draft_frame(state, field, draft, now)?;
    let message_id = new_message_id();
    let header = NetworkMessageHeader {
        message_id: Some(&message_id),
        publisher_id: Some(state.config().factory_id.as_str()),
        ..NetworkMessageHeader::default()
    };
    String::from_utf8(header.wrap([encode_data_set_message(&frame, state.config().encoding)])).ok()
}
