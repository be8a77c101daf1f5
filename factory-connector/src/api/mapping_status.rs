//! Status of published mappings: of one, and a survey of all with those in trouble first.

use asi_model::{FieldKey, messages::ValueSource};
use axum::{Json, extract::State};
use daemon::web::{ApiPath, ApiQuery, Problem};
use mapping_engine::{MappingHealth, MappingId, MappingStatus, MappingSurvey};
use serde::Deserialize;
use utoipa::IntoParams;

use super::{
    context::Api,
    paths::FieldPath,
    problems::{Problems, engine},
    roles::{BeforeGate, Engineer},
};

/// Mappings in a survey without a limit, and at most.
const SURVEYED_DEFAULT: usize = 50;
const SURVEYED_MAX: usize = 500;

/// Selection of a survey.
#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct SurveyQuery {
    /// Mappings in this condition only.
    health: Option<MappingHealth>,
    /// Up to 500; 50 without it, none with 0.
    limit: Option<usize>,
}

/// Surveys all published mappings: numbers by condition, and the worst of them.
#[utoipa::path(
    get,
    path = "/mappings/survey",
    tag = "mappings",
    params(SurveyQuery),
    responses((status = 200, body = MappingSurvey), Problems)
)]
pub async fn survey_mappings(
    user: Engineer,
    State(api): State<Api>,
    ApiQuery(query): ApiQuery<SurveyQuery>,
) -> Result<Json<MappingSurvey>, Problem> {
    let most = query.limit.unwrap_or(SURVEYED_DEFAULT).min(SURVEYED_MAX);
    let survey = api.engine.survey(query.health, most).await.map_err(engine)?;
    Ok(Json(survey.seen_by(BeforeGate::from(&user))))
}

/// Shows the status of a field's mapping: last values in and out, counts, faults, time spent.
#[utoipa::path(
    get,
    path = "/mapping-status",
    tag = "mappings",
    params(FieldPath),
    responses((status = 200, body = MappingStatus), Problems)
)]
pub async fn show_mapping_status(
    user: Engineer,
    State(api): State<Api>,
    ApiPath(path): ApiPath<FieldPath>,
) -> Result<Json<MappingStatus>, Problem> {
    let id = mapping_id_of(&api, path.into_key()).await?;
    status_of(&api, &id, BeforeGate::from(&user)).await
}

/// Closes the circuit breakers of a field's scripts that exceeded their budget: they run again at
/// once.
#[utoipa::path(
    post,
    path = "/mapping-status/restart",
    tag = "mappings",
    params(FieldPath),
    responses((status = 200, body = MappingStatus), Problems)
)]
pub async fn restart_mapping(
    user: Engineer,
    State(api): State<Api>,
    ApiPath(path): ApiPath<FieldPath>,
) -> Result<Json<MappingStatus>, Problem> {
    let id = mapping_id_of(&api, path.into_key()).await?;
    api.engine.reset(&id).await.map_err(engine)?;
    status_of(&api, &id, BeforeGate::from(&user)).await
}

async fn status_of(
    api: &Api,
    id: &MappingId,
    before_gate: BeforeGate,
) -> Result<Json<MappingStatus>, Problem> {
    let status = api.engine.status(id).await.map_err(engine)?;
    let status = status.ok_or_else(|| Problem::not_found("mapping at work for this field"))?;
    Ok(Json(status.seen_by(before_gate)))
}

async fn mapping_id_of(api: &Api, field: FieldKey) -> Result<MappingId, Problem> {
    let known = api
        .coordinator
        .read(move |state| {
            let field = state.field(&field)?;
            field.decision().is_open_for(ValueSource::Mapping).then(|| field.mapping_id())
        })
        .await?;
    known.ok_or_else(|| Problem::not_found("mapping at work for this field"))
}
