//! Decisions about fields, and values that people enter.

use asi_model::{
    BuiltInType, DynamicDataRequestId, FieldKey, FieldName, OperationId, OperationNetworkId, RequestKey,
    messages::{MappingState, ValueSource},
};
use axum::{Json, extract::State};
use daemon::web::{ApiJson, ApiPath, Problem, problem::ProblemFault, session::SignedIn};
use mapping_engine::{Mapping, MappingId, MappingInput, Severity, Step};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::{
    Api, Principal,
    accounts::{engineer_only, operator_only},
    problems::{Problems, engine, mapping_faults},
    view::FieldView,
};
use crate::{
    books::Verdict,
    desk::{Taken, now},
    disclosure::{DisclosurePolicy, Outcome},
    values::typed_value,
};

/// The parts of a field's path.
pub type FieldPath = (OperationNetworkId, OperationId, DynamicDataRequestId, FieldName);

pub(super) fn key((network, operation, request, field_name): FieldPath) -> FieldKey {
    let request =
        RequestKey { operation_network_id: network, operation_id: operation, dynamic_data_request_id: request };
    FieldKey { request, field_name }
}

/// From local variables to a field: inputs and functions.
#[derive(Debug, Clone, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct MappingDraft {
    /// The variables.
    pub inputs: Vec<MappingInput>,
    /// The functions, applied in this order.
    #[serde(default)]
    pub steps: Vec<Step>,
}

/// What is decided.
#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct DecisionBody {
    /// `PENDING`, `MAPPED` or `REFUSED`.
    #[schema(value_type = String)]
    mapping_state: MappingState,
    /// Where values come from; needed with `MAPPED`.
    #[schema(value_type = Option<String>)]
    value_source: Option<ValueSource>,
    /// Needed with the source `MAPPING`.
    mapping: Option<MappingDraft>,
    /// How values are coarsened; every change as it is without it.
    #[serde(default)]
    disclosure: DisclosurePolicy,
    /// Told to the partner; needed with `REFUSED`.
    reason: Option<String>,
}

/// The mapping of a field, as the engine takes it.
pub(super) async fn mapping_of(api: &Api, field: &FieldKey, draft: MappingDraft) -> Result<Mapping, Problem> {
    let key = field.clone();
    let known = api.desk.read(move |books| books.field(&key).map(|field| (field.id, field.definition.clone()))).await?;
    let (id, definition) = known.ok_or_else(|| Problem::not_found("such field"))?;
    let mapping_id = MappingId::new(format!("field-{id}")).map_err(|error| Problem::internal(&error))?;
    Ok(Mapping {
        mapping_id,
        target: field.clone(),
        target_type: mapping_engine::TypeName(definition.field_type.0),
        target_unit: definition.unit,
        target_value_rank: definition.value_rank,
        inputs: draft.inputs,
        steps: draft.steps,
        late_values: mapping_engine::mapping::LateValues::default(),
    })
}

/// Decides about a field. The partner is told; values flow or stop at once.
#[utoipa::path(put, path = "/fields/{operationNetworkId}/{operationId}/{dynamicDataRequestId}/{fieldName}/decision",
    tag = "fields", security(("session" = [])), params(("operationNetworkId" = String, Path),
    ("operationId" = String, Path), ("dynamicDataRequestId" = String, Path), ("fieldName" = String, Path)),
    request_body = DecisionBody, responses((status = 200, body = FieldView), Problems))]
pub async fn decide(
    State(api): State<Api>,
    who: SignedIn<Principal>,
    ApiPath(path): ApiPath<FieldPath>,
    ApiJson(body): ApiJson<DecisionBody>,
) -> Result<Json<FieldView>, Problem> {
    engineer_only(&who)?;
    let field = key(path);
    let verdict = match body.mapping_state {
        MappingState::Pending => Verdict::LeavePending,
        MappingState::Refused => Verdict::Refuse,
        MappingState::Mapped => {
            let value_source = body.value_source.ok_or_else(|| missing("valueSource"))?;
            let mapping = match body.mapping {
                Some(draft) if value_source == ValueSource::Mapping => {
                    let mapping = mapping_of(&api, &field, draft).await?;
                    let diagnostics = api.engine.check(mapping.clone()).await.map_err(engine)?;
                    if diagnostics.iter().any(|diagnostic| diagnostic.severity == Severity::Error) {
                        return Err(mapping_faults(diagnostics));
                    }
                    Some(Box::new(mapping))
                }
                _ => None,
            };
            Verdict::Map { value_source, mapping, policy: body.disclosure }
        }
    };
    api.desk.decide(field.clone(), verdict, body.reason, &who.principal.user_name).await?;
    show(&api, field).await
}

async fn show(api: &Api, field: FieldKey) -> Result<Json<FieldView>, Problem> {
    let view = api.desk.read(move |books| books.field(&field).map(|f| FieldView::new(field.clone(), f))).await?;
    view.map(Json).ok_or_else(|| Problem::not_found("such field"))
}

fn missing(member: &str) -> Problem {
    let fault = ProblemFault {
        pointer: format!("/{member}"),
        code: "MISSING".to_owned(),
        message: format!("A mapped field needs {member}."),
    };
    Problem::unprocessable("INVALID_DECISION", format!("A mapped field needs {member}."), vec![fault])
}

/// A value that a person enters.
#[derive(Deserialize, ToSchema)]
pub struct EnteredValue {
    /// The value as plain JSON; 64-bit integers may be texts.
    #[schema(value_type = Object)]
    value: serde_json::Value,
}

/// What became of it.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct Entered {
    /// `DISCLOSED`, `UNCHANGED` or `WITHHELD`.
    outcome: &'static str,
    /// Less than was entered is disclosed.
    is_coarsened: bool,
    /// When a withheld value may leave at the earliest.
    #[schema(value_type = Option<String>, format = "date-time")]
    until: Option<asi_model::DateTime>,
}

/// Enters a value for a field that was decided Manual. It goes through the same gate as any other.
#[utoipa::path(put, path = "/fields/{operationNetworkId}/{operationId}/{dynamicDataRequestId}/{fieldName}/value",
    tag = "fields", security(("session" = [])), params(("operationNetworkId" = String, Path),
    ("operationId" = String, Path), ("dynamicDataRequestId" = String, Path), ("fieldName" = String, Path)),
    request_body = EnteredValue, responses((status = 200, body = Entered), Problems))]
pub async fn enter(
    State(api): State<Api>,
    who: SignedIn<Principal>,
    ApiPath(path): ApiPath<FieldPath>,
    ApiJson(body): ApiJson<EnteredValue>,
) -> Result<Json<Entered>, Problem> {
    operator_only(&who)?;
    let field = key(path);
    let wanted = field.clone();
    let field_type: Option<BuiltInType> =
        api.desk.read(move |books| books.field(&wanted).map(|field| field.definition.field_type.0)).await?;
    let field_type = field_type.ok_or_else(|| Problem::not_found("such field"))?;
    let value = typed_value(&body.value, field_type, now()).map_err(|message| {
        let fault =
            ProblemFault { pointer: "/value".to_owned(), code: "WRONG_TYPE".to_owned(), message: message.clone() };
        Problem::unprocessable("WRONG_TYPE", message, vec![fault])
    })?;
    let (outcome, is_coarsened, until) = match api.desk.value(field, ValueSource::Manual, value).await? {
        Taken::Through(Outcome::Disclosed { is_coarsened }) => ("DISCLOSED", is_coarsened, None),
        Taken::Through(Outcome::Unchanged { is_coarsened }) => ("UNCHANGED", is_coarsened, None),
        Taken::Through(Outcome::Withheld { until }) => ("WITHHELD", false, Some(until)),
        Taken::Not(_) => {
            return Err(Problem::conflict(
                "NOT_MANUAL",
                "This field takes no entered values; decide it with the source MANUAL first.",
            ));
        }
    };
    Ok(Json(Entered { outcome, is_coarsened, until }))
}
