//! A mapping on trial: it runs on live values beside the published one and writes nothing.

use asi_model::{DateTime, messages::ValueSource};
use axum::{Json, extract::State, http::StatusCode};
use daemon::web::{ApiJson, ApiPath, Problem};
use mapping_engine::{
    Mapping, MappingStatus,
    comparison::{MappingChange, compare},
};
use serde::Serialize;
use utoipa::ToSchema;

use super::{
    Api,
    exchange::{Wanted, place},
    fields::{MappingDraft, checked, field_view},
    paths::FieldPath,
    problems::{Problems, engine},
    roles::{Engineer, Viewer},
    view::FieldView,
};

/// A mapping on trial beside the published one.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct ShadowView {
    /// The mapping on trial.
    mapping: Mapping,
    /// Who started it.
    author: String,
    /// When.
    started_at: DateTime,
    /// What differs from the published one; none where nothing is published.
    changes: Vec<MappingChange>,
    /// How it is doing, its last value with it.
    status: Option<MappingStatus>,
    /// How the published one is doing.
    published: Option<MappingStatus>,
}

/// Lets a mapping run on live values without writing, in place of the one on trial so far.
#[utoipa::path(
    put,
    path = "/shadow",
    tag = "mappings",
    params(FieldPath),
    request_body = MappingDraft,
    responses((status = 200, body = ShadowView), Problems)
)]
pub async fn start_shadow_mapping(
    Engineer(user): Engineer,
    State(api): State<Api>,
    ApiPath(path): ApiPath<FieldPath>,
    ApiJson(draft): ApiJson<MappingDraft>,
) -> Result<Json<ShadowView>, Problem> {
    let field = path.into_key();
    let mapping = checked(&api, &field, draft).await?;
    api.desk.shadow(field.clone(), Some(mapping), &user.principal.user_name).await?;
    view(&api, field).await
}

/// Shows the mapping on trial, with its values beside those of the published one.
#[utoipa::path(
    get,
    path = "/shadow",
    tag = "mappings",
    params(FieldPath),
    responses((status = 200, body = ShadowView), Problems)
)]
pub async fn show_shadow_mapping(
    _: Viewer,
    State(api): State<Api>,
    ApiPath(path): ApiPath<FieldPath>,
) -> Result<Json<ShadowView>, Problem> {
    view(&api, path.into_key()).await
}

/// Ends the trial.
#[utoipa::path(
    delete,
    path = "/shadow",
    tag = "mappings",
    params(FieldPath),
    responses((status = 204, description = "Ended"), Problems)
)]
pub async fn end_shadow_mapping(
    Engineer(user): Engineer,
    State(api): State<Api>,
    ApiPath(path): ApiPath<FieldPath>,
) -> Result<StatusCode, Problem> {
    api.desk.shadow(path.into_key(), None, &user.principal.user_name).await?;
    Ok(StatusCode::NO_CONTENT)
}

/// Publishes the mapping on trial as the next version, under the consent in force; the trial ends.
#[utoipa::path(
    post,
    path = "/shadow/publish",
    tag = "mappings",
    params(FieldPath),
    responses((status = 200, body = FieldView), Problems)
)]
pub async fn publish_shadow_mapping(
    Engineer(user): Engineer,
    State(api): State<Api>,
    ApiPath(path): ApiPath<FieldPath>,
) -> Result<Json<FieldView>, Problem> {
    let field = path.into_key();
    let wanted = field.clone();
    let known = api
        .desk
        .read(move |books| {
            let field = books.field(&wanted)?;
            let shadow = field.shelf.shadow.as_ref().map(|shadow| shadow.mapping.clone());
            Some((shadow, field.decision.is_open_for(ValueSource::Mapping)))
        })
        .await?;
    let (mapping, is_mapped) = known.ok_or_else(|| Problem::not_found("such field"))?;
    let mapping = mapping.ok_or_else(no_shadow)?;
    if !is_mapped {
        let message = "The field is not mapped: decide about it with this mapping, which includes what partners may see.";
        return Err(Problem::conflict("NOT_MAPPED", message));
    }
    let author = &user.principal.user_name;
    let wanted = Wanted { mapping, pointer: "/mapping".to_owned() };
    place(&api, vec![wanted], author, Some("tried as a shadow".to_owned()), false).await?;
    api.desk.shadow(field.clone(), None, author).await?;
    field_view(&api, field).await
}

async fn view(api: &Api, field: asi_model::FieldKey) -> Result<Json<ShadowView>, Problem> {
    let known = api
        .desk
        .read(move |books| {
            let field = books.field(&field)?;
            let published = field
                .decision
                .mapping
                .clone()
                .filter(|_| field.decision.is_open_for(ValueSource::Mapping));
            Some((field.shelf.shadow.clone(), published, field.shadow_id(), field.mapping_id()))
        })
        .await?;
    let (shadow, published, shadow_id, mapping_id) =
        known.ok_or_else(|| Problem::not_found("such field"))?;
    let shadow = shadow.ok_or_else(no_shadow)?;
    // Only what a person wrote is compared, not the ids.
    let written = Mapping { mapping_id: mapping_id.clone(), ..shadow.mapping.clone() };
    Ok(Json(ShadowView {
        changes: published.map(|published| compare(&published, &written)).unwrap_or_default(),
        mapping: shadow.mapping,
        author: shadow.author,
        started_at: shadow.started_at,
        status: api.engine.status(&shadow_id).await.map_err(engine)?,
        published: api.engine.status(&mapping_id).await.map_err(engine)?,
    }))
}

fn no_shadow() -> Problem {
    Problem::not_found("mapping on trial for this field")
}
