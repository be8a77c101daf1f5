//! Shadow mappings, which run on live values beside the published ones and write nothing.

use asi_model::{DateTime, messages::ValueSource};
use axum::{Json, extract::State, http::StatusCode};
use connector_state::use_cases::import_mappings::set_shadow;
use daemon::web::{ApiJson, ApiPath, Problem};
use mapping_engine::{
    Mapping, MappingStatus,
    comparison::{MappingChange, compare},
};
use serde::Serialize;
use utoipa::ToSchema;

use super::{
    context::Api,
    fields::{MappingDraft, checked, field_view},
    mapping_import::{ImportOptions, SubmittedMapping, import},
    paths::FieldPath,
    problems::{Problems, decision_problem, engine},
    roles::{BeforeGate, Engineer},
    view::FieldView,
};

/// A shadow mapping beside the published one.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct ShadowView {
    /// The shadow mapping.
    mapping: Mapping,
    /// Name of the person who started it.
    author: String,
    started_at: DateTime,
    /// Differences to the published mapping; none if there is none.
    changes: Vec<MappingChange>,
    /// Status with the last value; none before it runs.
    status: Option<MappingStatus>,
    /// Status of the published mapping; none if there is none.
    published: Option<MappingStatus>,
}

/// Starts a shadow mapping, in place of the present one.
#[utoipa::path(
    put,
    path = "/shadow",
    tag = "mappings",
    params(FieldPath),
    request_body = MappingDraft,
    responses((status = 200, body = ShadowView), Problems)
)]
pub async fn start_shadow_mapping(
    user: Engineer,
    State(api): State<Api>,
    ApiPath(path): ApiPath<FieldPath>,
    ApiJson(draft): ApiJson<MappingDraft>,
) -> Result<Json<ShadowView>, Problem> {
    let field = path.into_key();
    let mapping = checked(&api, &field, draft).await?;
    set(&api, field.clone(), Some(mapping), &user.principal.user_name).await?;
    view(&api, field, BeforeGate::from(&user)).await
}

/// Shows the shadow mapping, with its values beside those of the published one.
#[utoipa::path(
    get,
    path = "/shadow",
    tag = "mappings",
    params(FieldPath),
    responses((status = 200, body = ShadowView), Problems)
)]
pub async fn show_shadow_mapping(
    user: Engineer,
    State(api): State<Api>,
    ApiPath(path): ApiPath<FieldPath>,
) -> Result<Json<ShadowView>, Problem> {
    view(&api, path.into_key(), BeforeGate::from(&user)).await
}

/// Ends the shadow mapping.
#[utoipa::path(
    delete,
    path = "/shadow",
    tag = "mappings",
    params(FieldPath),
    responses((status = 204, description = "Ended"), Problems)
)]
pub async fn end_shadow_mapping(
    user: Engineer,
    State(api): State<Api>,
    ApiPath(path): ApiPath<FieldPath>,
) -> Result<StatusCode, Problem> {
    set(&api, path.into_key(), None, &user.principal.user_name).await?;
    Ok(StatusCode::NO_CONTENT)
}

/// Publishes the shadow mapping as the next version, under the consent in force, and ends it.
#[utoipa::path(
    post,
    path = "/shadow/publish",
    tag = "mappings",
    params(FieldPath),
    responses((status = 200, body = FieldView), Problems)
)]
pub async fn publish_shadow_mapping(
    user: Engineer,
    State(api): State<Api>,
    ApiPath(path): ApiPath<FieldPath>,
) -> Result<Json<FieldView>, Problem> {
    let field = path.into_key();
    let key = field.clone();
    let known = api
        .coordinator
        .read(move |state| {
            let field = state.field(&key)?;
            let shadow = field.versions().shadow.as_ref().map(|shadow| shadow.mapping.clone());
            Some((shadow, field.decision().is_open_for(ValueSource::Mapping)))
        })
        .await?;
    let (mapping, is_mapped) = known.ok_or_else(|| Problem::not_found("such field"))?;
    let mapping = mapping.ok_or_else(no_shadow)?;
    if !is_mapped {
        let message = "The field is not mapped: decide about it with this mapping, which includes what partners may see.";
        return Err(Problem::conflict("NOT_MAPPED", message));
    }
    let author = &user.principal.user_name;
    let submitted = SubmittedMapping { mapping, pointer: "/mapping".to_owned() };
    let options = ImportOptions { author, note: Some("tried as a shadow"), is_dry_run: false };
    import(&api, vec![submitted], options, Vec::new()).await?;
    set(&api, field.clone(), None, author).await?;
    field_view(&api, field, Some(BeforeGate::from(&user))).await
}

/// Starts, replaces or ends a field's shadow mapping.
async fn set(
    api: &Api,
    field: asi_model::FieldKey,
    mapping: Option<Mapping>,
    author: &str,
) -> Result<(), Problem> {
    let author = author.to_owned();
    let set =
        api.coordinator.execute(move |state, now| set_shadow(state, &field, mapping, &author, now));
    set.await?.map_err(decision_problem)
}

async fn view(
    api: &Api,
    field: asi_model::FieldKey,
    before_gate: BeforeGate,
) -> Result<Json<ShadowView>, Problem> {
    let known = api
        .coordinator
        .read(move |state| {
            let field = state.field(&field)?;
            let published = field
                .decision()
                .mapping
                .clone()
                .filter(|_| field.decision().is_open_for(ValueSource::Mapping));
            Some((
                field.versions().shadow.clone(),
                published,
                field.shadow_id(),
                field.mapping_id(),
            ))
        })
        .await?;
    let (shadow, published, shadow_id, mapping_id) =
        known.ok_or_else(|| Problem::not_found("such field"))?;
    let shadow = shadow.ok_or_else(no_shadow)?;
    // Ids are not compared, only what a person wrote.
    let written = Mapping { mapping_id: mapping_id.clone(), ..shadow.mapping.clone() };
    let status = api.engine.status(&shadow_id).await.map_err(engine)?;
    let of_published = api.engine.status(&mapping_id).await.map_err(engine)?;
    Ok(Json(ShadowView {
        changes: published.map(|published| compare(&published, &written)).unwrap_or_default(),
        mapping: shadow.mapping,
        author: shadow.author,
        started_at: shadow.started_at,
        status: status.map(|status| status.seen_by(before_gate)),
        published: of_published.map(|status| status.seen_by(before_gate)),
    }))
}

fn no_shadow() -> Problem {
    Problem::not_found("shadow mapping of this field")
}
