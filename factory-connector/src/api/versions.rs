//! Versions of a field's mapping: list, comparison and rollback.

use asi_model::{DateTime, FieldKey};
use axum::{Json, extract::State};
use daemon::web::{ApiPath, ApiQuery, Problem};
use mapping_engine::{
    Mapping,
    comparison::{MappingChange, compare},
};
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};

use super::{
    context::Api,
    fields::field_view,
    mapping_import::{ImportOptions, SubmittedMapping, import},
    paths::FieldPath,
    problems::Problems,
    roles::{BeforeGate, Engineer, Viewer},
    view::{FieldView, Page},
};

/// Number of a version in a path.
#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Path)]
pub struct VersionPath {
    version: u32,
}

/// A published mapping.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct VersionView {
    /// Number, from 1.
    version: u32,
    /// Name of the person who published it.
    author: Option<String>,
    /// Origin, if not the editor.
    note: Option<String>,
    published_at: DateTime,
    /// True for the mapping that is published now.
    is_current: bool,
    mapping: Mapping,
    /// Differences to the version before; none for the oldest.
    changes: Vec<MappingChange>,
}

/// Lists the last hundred versions of a field's mapping, newest first.
#[utoipa::path(
    get,
    path = "/versions",
    tag = "mappings",
    params(FieldPath),
    responses((status = 200, body = Page<VersionView>), Problems)
)]
pub async fn list_mapping_versions(
    _: Viewer,
    State(api): State<Api>,
    ApiPath(path): ApiPath<FieldPath>,
) -> Result<Json<Page<VersionView>>, Problem> {
    let (stored, current) = versions(&api, path.into_key()).await?;
    let items = stored.iter().enumerate().map(|(index, (row, mapping))| VersionView {
        version: row.version,
        author: row.author.clone(),
        note: row.note.clone(),
        published_at: row.published_at,
        is_current: current.as_ref() == Some(mapping),
        changes: stored
            .get(index + 1)
            .map(|(_, before)| compare(before, mapping))
            .unwrap_or_default(),
        mapping: mapping.clone(),
    });
    Ok(Json(Page::whole(items.collect())))
}

/// Versions to compare.
#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct DifferenceQuery {
    /// The earlier version.
    from: u32,
    /// The later version; the present mapping without it.
    to: Option<u32>,
}

/// Difference between two versions.
#[derive(Serialize, ToSchema)]
pub struct Difference {
    /// The earlier mapping.
    before: Mapping,
    /// The later mapping.
    after: Mapping,
    /// Changes from the earlier to the later mapping.
    changes: Vec<MappingChange>,
}

/// Compares two versions of a field's mapping.
#[utoipa::path(
    get,
    path = "/version-difference",
    tag = "mappings",
    params(FieldPath, DifferenceQuery),
    responses((status = 200, body = Difference), Problems)
)]
pub async fn compare_mapping_versions(
    _: Viewer,
    State(api): State<Api>,
    ApiPath(path): ApiPath<FieldPath>,
    ApiQuery(query): ApiQuery<DifferenceQuery>,
) -> Result<Json<Difference>, Problem> {
    let (stored, current) = versions(&api, path.into_key()).await?;
    let find = |version: u32| {
        stored.iter().find(|(row, _)| row.version == version).map(|(_, mapping)| mapping.clone())
    };
    let before = find(query.from).ok_or_else(|| Problem::not_found("such version"))?;
    let after = query.to.map_or(current, find).ok_or_else(|| Problem::not_found("such version"))?;
    Ok(Json(Difference { changes: compare(&before, &after), before, after }))
}

/// Publishes a version again as the newest one, under the consent in force.
#[utoipa::path(
    post,
    path = "/versions/{version}/rollback",
    tag = "mappings",
    params(FieldPath, VersionPath),
    responses((status = 200, body = FieldView), Problems)
)]
pub async fn roll_mapping_back(
    user: Engineer,
    State(api): State<Api>,
    ApiPath(path): ApiPath<FieldPath>,
    ApiPath(VersionPath { version }): ApiPath<VersionPath>,
) -> Result<Json<FieldView>, Problem> {
    let field = path.into_key();
    let (stored, _) = versions(&api, field.clone()).await?;
    let (_, mapping) = stored
        .into_iter()
        .find(|(row, _)| row.version == version)
        .ok_or_else(|| Problem::not_found("such version"))?;
    let note = format!("as version {version}");
    let submitted = SubmittedMapping { mapping, pointer: "/mapping".to_owned() };
    let author = &user.principal.user_name;
    let options = ImportOptions { author, note: Some(&note), is_dry_run: false };
    import(&api, vec![submitted], options, Vec::new()).await?;
    field_view(&api, field, Some(BeforeGate::from(&user))).await
}

/// Returns the stored versions, newest first, and the present mapping of the field.
async fn versions(
    api: &Api,
    field: FieldKey,
) -> Result<(Vec<(connector_state::writes::VersionRow, Mapping)>, Option<Mapping>), Problem> {
    let known = api
        .coordinator
        .read(move |state| {
            state
                .field(&field)
                .map(|field| (field.id(), field.decision().mapping.as_deref().cloned()))
        })
        .await?;
    let (id, current) = known.ok_or_else(|| Problem::not_found("such field"))?;
    let rows = api.store().await?.mapping_versions().of_field(id).await?;
    let stored = rows
        .into_iter()
        .map(|row| serde_json::from_str(&row.mapping).map(|mapping| (row, mapping)))
        .collect::<Result<_, _>>()
        .map_err(|error| Problem::internal(&error))?;
    Ok((stored, current))
}
