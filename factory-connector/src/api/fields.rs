//! Fields, decisions about them, and values that people enter.

use std::sync::Arc;

use asi_model::{
    DateTime, FieldKey,
    messages::{MappingState, ValueSource},
    openapi::PlainValue,
};
use axum::{Json, extract::State, http::HeaderMap};
use connector_state::{
    ConnectorState,
    operator::{Action, EntryFault, OperationKey, OperatorEntry},
    use_cases::{
        decide::{DecisionCommand, DecisionRequest, SeenPreview, decide_as_shown},
        enter::{EntryOutcome, enter},
    },
    writes::PreviewRow,
};
use daemon::web::{ApiJson, ApiPath, Problem, problem::ProblemFault};
use disclosure::{DecisionBasis, DisclosurePolicy, DocumentId, GateOutcome};
use mapping_engine::{Mapping, MappingId, MappingInput, Severity, Step, mapping::LateValues};
use serde::{Deserialize, Serialize};
use shop_floor::ShopFloorHandle;
use utoipa::ToSchema;

use super::{
    context::Api,
    documents::if_match,
    paths::FieldPath,
    problems::{Problems, decision_problem, engine, mapping_faults, shop_floor},
    roles::{BeforeGate, Engineer, Operator, Viewer},
    view::FieldView,
};
use crate::clock::{new_entry_id, now, salt};

/// Time for a server to return the browse path of a variable.
const BROWSE_PATH_TIMEOUT: std::time::Duration = std::time::Duration::from_secs(2);

/// Mapping from local variables to a field, without its target.
#[derive(Debug, Clone, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct MappingDraft {
    /// Variables by their names in the mapping.
    pub inputs: Vec<MappingInput>,
    /// The functions, applied in this order.
    #[serde(default)]
    pub steps: Vec<Step>,
    /// Treatment of values that arrive after newer ones of the same variable.
    #[serde(default)]
    pub late_values: LateValues,
}

/// A decision about a field.
#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct DecisionBody {
    /// `PENDING`, `MAPPED` or `REFUSED`.
    mapping_state: MappingState,
    /// Source of the values; needed with `MAPPED`.
    value_source: Option<ValueSource>,
    /// Needed with the source `MAPPING`.
    mapping: Option<MappingDraft>,
    /// Coarsening of the values; needed with `MAPPED` unless there is a named policy. Every change
    /// leaves as it is only where this is an empty object.
    disclosure: Option<DisclosurePolicy>,
    /// A named policy that holds beside it, in its newest version from now on.
    policy_id: Option<DocumentId>,
    /// Reason that the partner reads; needed with `REFUSED`.
    reason: Option<String>,
    /// The preview of this draft that the engineer saw; the ledger has a salted hash of it.
    preview_id: Option<String>,
}

impl DecisionBody {
    /// Takes the draft of a mapping out, where the values are to come from one.
    pub(super) fn take_draft(&mut self) -> Option<MappingDraft> {
        let is_used = self.mapping_state == MappingState::Mapped
            && self.value_source == Some(ValueSource::Mapping);
        self.mapping.take().filter(|_| is_used)
    }

    /// Returns the decision with the mapping that was made of the draft.
    pub(super) fn request(
        self,
        mapping: Option<Box<Mapping>>,
        preview: Option<SeenPreview>,
        decided_by: &str,
    ) -> Result<DecisionRequest, Problem> {
        let command = match self.mapping_state {
            MappingState::Pending => DecisionCommand::LeavePending,
            MappingState::Refused => DecisionCommand::Refuse,
            MappingState::Mapped => {
                let value_source = self.value_source.ok_or_else(|| missing("valueSource"))?;
                let policy = match self.disclosure {
                    None if self.policy_id.is_none() => return Err(missing("disclosure")),
                    policy => policy.unwrap_or_default(),
                };
                DecisionCommand::Map { value_source, mapping, policy }
            }
        };
        Ok(DecisionRequest {
            command,
            reason: self.reason,
            decided_by: decided_by.to_owned(),
            basis: DecisionBasis { policy_id: self.policy_id, ..DecisionBasis::default() },
            preview,
        })
    }
}

/// Writes a draft as JSON, the same for equal drafts.
pub(super) fn draft_text(
    value_source: ValueSource,
    mapping: Option<&MappingDraft>,
    disclosure: &DisclosurePolicy,
    policy_id: Option<&DocumentId>,
) -> String {
    let mapping = mapping.filter(|_| value_source == ValueSource::Mapping);
    serde_json::json!([value_source, mapping, disclosure, policy_id]).to_string()
}

/// Completes a draft by the field's definition.
pub(super) async fn mapping_of(
    api: &Api,
    field: &FieldKey,
    draft: MappingDraft,
) -> Result<Mapping, Problem> {
    let key = field.clone();
    api.coordinator.read(move |state| complete(state, &key, draft)).await?
}

/// Completes a draft by the definition of its field in a state.
pub(super) fn complete(
    state: &ConnectorState,
    field: &FieldKey,
    draft: MappingDraft,
) -> Result<Mapping, Problem> {
    let known = state.field(field).ok_or_else(|| Problem::not_found("such field"))?;
    let mapping_id = MappingId::new(format!("field-{}", known.id()))
        .map_err(|error| Problem::internal(&error))?;
    let definition = known.definition();
    Ok(Mapping {
        mapping_id,
        target: field.clone(),
        target_type: mapping_engine::TypeName(definition.field_type.0),
        target_unit: definition.unit.clone(),
        target_value_rank: definition.value_rank,
        inputs: draft.inputs,
        steps: draft.steps,
        late_values: draft.late_values,
    })
}

/// Completes a draft by the field's definition and by browse paths; a problem if it has errors.
pub(super) async fn checked(
    api: &Api,
    field: &FieldKey,
    draft: MappingDraft,
) -> Result<Mapping, Problem> {
    let mut mapping = mapping_of(api, field, draft).await?;
    let diagnostics = api.engine.check(mapping.clone()).await.map_err(engine)?;
    if diagnostics.iter().any(|diagnostic| diagnostic.severity == Severity::Error) {
        return Err(mapping_faults(diagnostics));
    }
    for input in &mapping.inputs {
        ShopFloorHandle::check_options(&input.monitor).map_err(shop_floor)?;
    }
    add_browse_paths(api, &mut mapping).await;
    Ok(mapping)
}

/// Adds the browse paths of the variables, so that a mapping finds them again after the server gave
/// them other ids, even while the connector was down. Without an answer of the server in time the
/// mapping works all the same.
async fn add_browse_paths(api: &Api, mapping: &mut Mapping) {
    for input in mapping.inputs.iter_mut().filter(|input| input.monitor.browse_path.is_none()) {
        let asked = tokio::time::timeout(
            BROWSE_PATH_TIMEOUT,
            api.shop_floor.browse_path(&input.source_id, &input.node_id),
        );
        if let Ok(Ok(path)) = asked.await {
            input.monitor.browse_path = Some(path);
        }
    }
}

/// Decides about a field. The partner is notified; values flow or stop at once. Refused (`OVER_CAP`)
/// where partners would get more information than a cap allows. `If-Match` with the `shownTag` of the
/// field that was shown refuses (`DECIDED_SINCE`) what another decision or a changed request has overtaken.
#[utoipa::path(
    put,
    path = "/decision",
    tag = "fields",
    params(FieldPath, ("If-Match" = Option<String>, Header)),
    request_body = DecisionBody,
    responses((status = 200, body = FieldView), Problems)
)]
pub async fn decide_field(
    user: Engineer,
    State(api): State<Api>,
    ApiPath(path): ApiPath<FieldPath>,
    headers: HeaderMap,
    ApiJson(mut body): ApiJson<DecisionBody>,
) -> Result<Json<FieldView>, Problem> {
    let field = path.into_key();
    let tag: Option<String> = if_match(&headers)?;
    let preview = preview_row(&api, &user.principal.user_name, &field, &body)?;
    let mapping = match body.take_draft() {
        Some(draft) => Some(Box::new(checked(&api, &field, draft).await?)),
        None => None,
    };
    let request = body.request(mapping, preview, &user.principal.user_name)?;
    let key = field.clone();
    let decided = api
        .coordinator
        .execute(move |state, now| decide_as_shown(state, &key, tag.as_deref(), request, now));
    decided.await?.map_err(decision_problem)?;
    field_view(&api, field, Some(BeforeGate::from(&user))).await
}

/// Returns the preview that an engineer decides on, to be stored with the consent.
fn preview_row(
    api: &Api,
    user: &str,
    field: &FieldKey,
    body: &DecisionBody,
) -> Result<Option<SeenPreview>, Problem> {
    let (Some(preview_id), Some(value_source)) = (&body.preview_id, body.value_source) else {
        return Ok(None);
    };
    let disclosure = body.disclosure.clone().unwrap_or_default();
    let draft =
        draft_text(value_source, body.mapping.as_ref(), &disclosure, body.policy_id.as_ref());
    let (text, effective) = api.previews.text_for(preview_id, (user, field, &draft))?;
    let row = PreviewRow::new(text, salt());
    Ok(Some(SeenPreview { row, effective: Arc::new(effective) }))
}

/// Shows a field with its decision and its newest disclosed value.
#[utoipa::path(
    get,
    path = "/",
    tag = "fields",
    params(FieldPath),
    responses((status = 200, body = FieldView), Problems)
)]
pub async fn show_field(
    user: Viewer,
    State(api): State<Api>,
    ApiPath(path): ApiPath<FieldPath>,
) -> Result<Json<FieldView>, Problem> {
    field_view(&api, path.into_key(), user.before_gate()).await
}

pub(super) async fn field_view(
    api: &Api,
    field: FieldKey,
    before_gate: Option<BeforeGate>,
) -> Result<Json<FieldView>, Problem> {
    let view = api
        .coordinator
        .read(move |state| {
            state.field(&field).map(|f| FieldView::new(state, field.clone(), f, before_gate))
        })
        .await?;
    view.map(Json).ok_or_else(|| Problem::not_found("such field"))
}

fn missing(member: &str) -> Problem {
    let fault = ProblemFault {
        pointer: format!("/{member}"),
        code: "MISSING".to_owned(),
        message: format!("A mapped field needs {member}."),
    };
    Problem::unprocessable(
        "INVALID_DECISION",
        format!("A mapped field needs {member}."),
        vec![fault],
    )
}

/// A value that a person enters.
#[derive(Deserialize, ToSchema)]
pub struct EnteredValue {
    /// The value as plain JSON; 64-bit integers may be texts.
    #[schema(value_type = PlainValue)]
    value: serde_json::Value,
}

impl EnteredValue {
    /// Returns the value as an entry of a person about a field.
    pub(super) fn entry(self, field: &FieldKey, made_by: &str) -> OperatorEntry {
        let request = &field.request;
        // The store keeps microseconds: rounded here, the time is the same after a restart.
        let moment = DateTime::from_unix_micros(now().unix_micros());
        OperatorEntry {
            entry_id: new_entry_id(),
            operation: OperationKey {
                operation_network_id: request.operation_network_id.clone(),
                operation_id: request.operation_id.clone(),
            },
            made_at: moment,
            received_at: moment,
            made_by: made_by.to_owned(),
            action: Action::Value {
                dynamic_data_request_id: request.dynamic_data_request_id.clone(),
                field_name: field.field_name.clone(),
                value: self.value,
            },
        }
    }
}

/// Outcome of an entered value.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct Entered {
    /// `DISCLOSED`, `UNCHANGED`, `WITHHELD` (it leaves later) or `SUPPRESSED` (the policy withholds
    /// the present state: it never leaves).
    outcome: &'static str,
    /// Less than was entered is disclosed.
    is_coarsened: bool,
    /// Earliest time at which a withheld value may leave.
    until: Option<asi_model::DateTime>,
}

/// Enters a value for a field that was decided Manual. It goes through the same gate as any other.
#[utoipa::path(
    put,
    path = "/value",
    tag = "fields",
    params(FieldPath),
    request_body = EnteredValue,
    responses((status = 200, body = Entered), Problems)
)]
pub async fn enter_value(
    user: Operator,
    State(api): State<Api>,
    ApiPath(path): ApiPath<FieldPath>,
    ApiJson(body): ApiJson<EnteredValue>,
) -> Result<Json<Entered>, Problem> {
    let field = path.into_key();
    let key = field.clone();
    if !api.coordinator.read(move |state| state.field(&key).is_some()).await? {
        return Err(Problem::not_found("such field"));
    }
    let entry = body.entry(&field, &user.principal.user_name);
    let outcome = api.coordinator.execute(|state, now| enter(state, entry, now)).await?;
    match outcome {
        EntryOutcome::Taken(taken) => {
            let outcome =
                taken.into_iter().find(|(key, _)| *key == field).map(|(_, outcome)| outcome);
            outcome.map(|outcome| Json(outcome.into())).ok_or_else(not_manual)
        }
        EntryOutcome::Refused(fault @ EntryFault::WrongType(_)) => {
            let (code, message) = (fault.code().to_owned(), fault.to_string());
            let listed = ProblemFault {
                pointer: "/value".to_owned(),
                code: code.clone(),
                message: message.clone(),
            };
            Err(Problem::unprocessable(&code, message, vec![listed]))
        }
        EntryOutcome::Refused(EntryFault::TooMany) => {
            Err(Problem::conflict("TOO_MANY", EntryFault::TooMany.to_string()))
        }
        EntryOutcome::Refused(_) | EntryOutcome::Repeated => Err(not_manual()),
    }
}

fn not_manual() -> Problem {
    Problem::conflict(
        "NOT_MANUAL",
        "This field takes no entered values; decide it with the source MANUAL first.",
    )
}

impl From<GateOutcome> for Entered {
    fn from(outcome: GateOutcome) -> Self {
        let (outcome, is_coarsened, until) = match outcome {
            GateOutcome::Disclosed { is_coarsened } => ("DISCLOSED", is_coarsened, None),
            GateOutcome::Unchanged { is_coarsened } => ("UNCHANGED", is_coarsened, None),
            GateOutcome::Withheld { until } => ("WITHHELD", false, Some(until)),
            GateOutcome::Suppressed => ("SUPPRESSED", true, None),
        };
        Self { outcome, is_coarsened, until }
    }
}
