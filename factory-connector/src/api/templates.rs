//! Mapping templates: one mapping for a series of like machines.

use std::collections::BTreeMap;

use asi_model::DateTime;
use axum::{Json, extract::State, http::StatusCode};
use connector_state::{use_cases::configuration, writes::TemplateRow};
use daemon::web::{ApiJson, ApiPath, ApiQuery, Problem, problem::ProblemFault};
use mapping_engine::exchange::{MappingTemplate, numbers};
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};

use super::{
    context::Api,
    mapping_import::{ImportOptions, ImportOutcome, SubmittedMapping, import, nothing_imported},
    paths::FieldPath,
    problems::Problems,
    roles::{Engineer, Viewer},
    view::Page,
};
use crate::clock::now;

/// Most templates, most mappings of one series, most parameters of one, longest id in bytes.
const TEMPLATES_MAX: usize = 1000;
const SERIES_MAX: usize = 10_000;
const PARAMETERS_MAX: usize = 50;
const ID_BYTES_MAX: usize = 64;

/// A stored template.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct TemplateView {
    #[serde(flatten)]
    template: MappingTemplate,
    /// Name of the person who changed it last.
    author: String,
    changed_at: DateTime,
}

/// Lists the templates.
#[utoipa::path(
    get,
    path = "/mapping-templates",
    tag = "mappings",
    responses((status = 200, body = Page<TemplateView>), Problems)
)]
pub async fn list_mapping_templates(
    _: Viewer,
    State(api): State<Api>,
) -> Result<Json<Page<TemplateView>>, Problem> {
    let rows = api.store().await?.mapping_templates().all().await?;
    let items = rows
        .into_iter()
        .map(|row| {
            let template = serde_json::from_str(&row.template)?;
            Ok(TemplateView { template, author: row.author, changed_at: row.changed_at })
        })
        .collect::<Result<_, serde_json::Error>>()
        .map_err(|error| Problem::internal(&error))?;
    Ok(Json(Page::whole(items)))
}

/// Stores a template, in place of the one with the same id.
#[utoipa::path(
    put,
    path = "/mapping-templates/{templateId}",
    tag = "mappings",
    params(("templateId" = String, Path)),
    request_body = MappingTemplate,
    responses((status = 200, body = MappingTemplate), Problems)
)]
pub async fn put_mapping_template(
    user: Engineer,
    State(api): State<Api>,
    ApiPath(template_id): ApiPath<String>,
    ApiJson(template): ApiJson<MappingTemplate>,
) -> Result<Json<MappingTemplate>, Problem> {
    if template.template_id != template_id {
        return Err(Problem::bad_request(
            "OTHER_ID",
            "The document's templateId differs from the path's.",
        ));
    }
    check(&template)?;
    store_all(&api, vec![template.clone()], &user.principal.user_name, false).await?;
    Ok(Json(template))
}

/// Removes a template; mappings made from it stay.
#[utoipa::path(
    delete,
    path = "/mapping-templates/{templateId}",
    tag = "mappings",
    params(("templateId" = String, Path)),
    responses((status = 204, description = "Removed"), Problems)
)]
pub async fn remove_mapping_template(
    _: Engineer,
    State(api): State<Api>,
    ApiPath(template_id): ApiPath<String>,
) -> Result<StatusCode, Problem> {
    api.coordinator.execute(|_, _| configuration::remove_template(template_id)).await?;
    Ok(StatusCode::NO_CONTENT)
}

/// Draft of a template of a field's mapping.
#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct TemplateDraft {
    /// Its id: letters, digits, `_` and `-`.
    pub(super) template_id: String,
    /// Name for people.
    name: Option<String>,
    /// Parameters and the texts that they replace in this mapping, as `machine` for `Press1`.
    pub(super) parameters: BTreeMap<String, String>,
}

impl TemplateDraft {
    /// Returns the problem of more parameters than a template has.
    pub(super) fn check(&self) -> Result<(), Problem> {
        if self.parameters.len() <= PARAMETERS_MAX {
            return Ok(());
        }
        let detail = format!("A template has at most {PARAMETERS_MAX} parameters.");
        Err(Problem::unprocessable("INVALID_TEMPLATE", detail, Vec::new()))
    }
}

/// Makes a template of a field's mapping without storing it.
#[utoipa::path(
    post,
    path = "/template",
    tag = "mappings",
    params(FieldPath),
    request_body = TemplateDraft,
    responses((status = 200, body = MappingTemplate), Problems)
)]
pub async fn make_mapping_template(
    _: Engineer,
    State(api): State<Api>,
    ApiPath(path): ApiPath<FieldPath>,
    ApiJson(draft): ApiJson<TemplateDraft>,
) -> Result<Json<MappingTemplate>, Problem> {
    draft.check()?;
    let field = path.into_key();
    let mapping = api
        .coordinator
        .read(move |state| state.field(&field).map(|field| field.decision().mapping.clone()))
        .await?;
    let mapping = mapping.ok_or_else(|| Problem::not_found("such field"))?;
    let mapping =
        mapping.ok_or_else(|| Problem::conflict("NO_MAPPING", "This field has no mapping yet."))?;
    let template = MappingTemplate::from_mapping(&draft.template_id, &mapping, &draft.parameters);
    Ok(Json(MappingTemplate { name: draft.name, ..template }))
}

/// The members of a series.
#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct Series {
    /// The values of the parameters, one set per mapping.
    #[serde(default)]
    sets: Vec<BTreeMap<String, String>>,
    /// Or patterns of numbers, as `1..12` or `1,3,7..9`: the first mapping gets the first number of
    /// each, and so on; a pattern of one number, or another text, is the same for all.
    #[serde(default)]
    patterns: BTreeMap<String, String>,
}

/// Mode of filling a template.
#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query, rename_all = "camelCase")]
#[serde(rename_all = "camelCase")]
pub struct FillQuery {
    /// True to change nothing and return the outcome that there would be.
    #[serde(default)]
    dry_run: bool,
}

/// Fills a template once per member of a series and imports the mappings, all or none.
#[utoipa::path(
    post,
    path = "/mapping-templates/{templateId}/fill",
    tag = "mappings",
    params(("templateId" = String, Path), FillQuery),
    request_body = Series,
    responses((status = 200, body = ImportOutcome), Problems)
)]
pub async fn fill_mapping_template(
    user: Engineer,
    State(api): State<Api>,
    ApiPath(template_id): ApiPath<String>,
    ApiQuery(query): ApiQuery<FillQuery>,
    ApiJson(series): ApiJson<Series>,
) -> Result<Json<ImportOutcome>, Problem> {
    let template =
        load_all(&api).await?.into_iter().find(|template| template.template_id == template_id);
    let template = template.ok_or_else(|| Problem::not_found("such template"))?;
    let (mut submitted, mut faults) = (Vec::new(), Vec::new());
    for (index, values) in members(series)?.iter().enumerate() {
        let pointer = format!("/sets/{index}");
        match template.fill(values) {
            Ok(mapping) => submitted.push(SubmittedMapping { mapping, pointer }),
            Err(fault) => {
                faults.push(ProblemFault {
                    pointer,
                    code: "NOT_FILLED".to_owned(),
                    message: fault.to_string(),
                });
            }
        }
    }
    if !faults.is_empty() {
        return Err(nothing_imported(faults));
    }
    let note = format!("from the template {template_id}");
    let options = ImportOptions {
        author: &user.principal.user_name,
        note: Some(&note),
        is_dry_run: query.dry_run,
    };
    Ok(Json(import(&api, submitted, options, faults).await?))
}

/// Returns the parameter values of each member.
pub(super) fn members(series: Series) -> Result<Vec<BTreeMap<String, String>>, Problem> {
    let Series { sets, patterns } = series;
    let invalid = |pointer: &str, message: String| {
        let fault = ProblemFault {
            pointer: pointer.to_owned(),
            code: "INVALID_SERIES".to_owned(),
            message: message.clone(),
        };
        Problem::unprocessable("INVALID_SERIES", message, vec![fault])
    };
    // Each is a text per member: some bytes of a request would become gigabytes.
    if patterns.len() > PARAMETERS_MAX {
        return Err(invalid(
            "/patterns",
            format!("A series has at most {PARAMETERS_MAX} patterns."),
        ));
    }
    let sets = if patterns.is_empty() {
        sets
    } else if sets.is_empty() {
        let texts = |pattern: &String| match numbers(pattern) {
            Some(numbers) if numbers.len() > 1 => numbers.iter().map(u32::to_string).collect(),
            _ => vec![pattern.clone()],
        };
        let expanded: BTreeMap<String, Vec<String>> =
            patterns.iter().map(|(name, pattern)| (name.clone(), texts(pattern))).collect();
        let count = expanded.values().map(Vec::len).max().unwrap_or_default();
        if let Some((name, texts)) =
            expanded.iter().find(|(_, texts)| texts.len() != 1 && texts.len() != count)
        {
            let message =
                format!("{name} has {} numbers, but another pattern has {count}.", texts.len());
            return Err(invalid(&format!("/patterns/{name}"), message));
        }
        let value =
            |texts: &Vec<String>, index: usize| texts.get(index).or_else(|| texts.first()).cloned();
        (0..count)
            .map(|index| {
                expanded
                    .iter()
                    .filter_map(|(name, texts)| Some((name.clone(), value(texts, index)?)))
                    .collect()
            })
            .collect()
    } else {
        return Err(invalid("/patterns", "Give either sets or patterns.".to_owned()));
    };
    if sets.is_empty() || sets.len() > SERIES_MAX {
        return Err(invalid("/sets", format!("A series has 1 to {SERIES_MAX} members.")));
    }
    Ok(sets)
}

pub(super) async fn load_all(api: &Api) -> Result<Vec<MappingTemplate>, Problem> {
    let rows = api.store().await?.mapping_templates().all().await?;
    let templates =
        rows.iter().map(|row| serde_json::from_str(&row.template)).collect::<Result<_, _>>();
    templates.map_err(|error: serde_json::Error| Problem::internal(&error))
}

/// Returns the problem that lists the faults of a template.
pub(super) fn check(template: &MappingTemplate) -> Result<(), Problem> {
    let faults = faults(std::slice::from_ref(template));
    if faults.is_empty() {
        return Ok(());
    }
    Err(Problem::unprocessable("INVALID_TEMPLATE", "The template has errors.", faults))
}

/// Returns the faults of templates, except those that only filling shows.
pub(super) fn faults(templates: &[MappingTemplate]) -> Vec<ProblemFault> {
    let mut faults = Vec::new();
    for (index, template) in templates.iter().enumerate() {
        let id = &template.template_id;
        let is_id = (1..=ID_BYTES_MAX).contains(&id.len())
            && id.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_' || byte == b'-');
        let mut fault = |member: &str, message: String| {
            let pointer = if templates.len() > 1 {
                format!("/templates/{index}/{member}")
            } else {
                format!("/{member}")
            };
            faults.push(ProblemFault { pointer, code: "INVALID_TEMPLATE".to_owned(), message });
        };
        if !is_id {
            fault("templateId", "A template's id has 1 to 64 letters, digits, _ and -.".to_owned());
        }
        if !template.mapping.is_object() {
            fault("mapping", "A template's mapping is the JSON object of a mapping.".to_owned());
        }
    }
    faults
}

/// Stores templates and returns the number of new or changed ones.
pub(super) async fn store_all(
    api: &Api,
    templates: Vec<MappingTemplate>,
    author: &str,
    is_dry_run: bool,
) -> Result<usize, Problem> {
    if templates.is_empty() {
        return Ok(0);
    }
    let known = load_all(api).await?;
    let other: Vec<_> =
        templates.into_iter().filter(|template| !known.contains(template)).collect();
    if known.len() + other.len() > TEMPLATES_MAX {
        let message = format!(
            "There are {} templates; {TEMPLATES_MAX} are the limit. Remove some first.",
            known.len()
        );
        return Err(Problem::conflict("LIMIT_REACHED", message));
    }
    let count = other.len();
    for template in other.into_iter().filter(|_| !is_dry_run) {
        let text = serde_json::to_string(&template).map_err(|error| Problem::internal(&error))?;
        let row = TemplateRow {
            template_id: template.template_id,
            template: text,
            author: author.to_owned(),
            changed_at: now(),
        };
        api.coordinator.execute(|_, _| configuration::put_template(row)).await?;
    }
    Ok(count)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_become_sets() {
        let check = |patterns: &[(&str, &str)]| {
            let patterns = patterns
                .iter()
                .map(|(name, text)| ((*name).to_owned(), (*text).to_owned()))
                .collect();
            members(Series { sets: Vec::new(), patterns })
                .map(|sets| {
                    sets.iter()
                        .map(|set| set.values().cloned().collect::<Vec<_>>().join(" "))
                        .collect::<Vec<_>>()
                })
                .map_err(|problem| problem.detail)
        };
        assert_eq!(
            check(&[("line", "A"), ("n", "1..3")]),
            Ok(vec!["A 1".into(), "A 2".into(), "A 3".into()])
        );
        assert_eq!(check(&[("m", "7,9"), ("n", "1..2")]), Ok(vec!["7 1".into(), "9 2".into()]));
        assert!(check(&[("m", "1..2"), ("n", "1..3")]).is_err());
        assert!(check(&[]).is_err());
        let names: Vec<String> = (0..=PARAMETERS_MAX).map(|index| format!("p{index}")).collect();
        let many: Vec<(&str, &str)> = names.iter().map(|name| (name.as_str(), "1..9")).collect();
        assert!(check(&many).is_err(), "a few bytes for each set are no large answer");
        assert!(check(&many[1..]).is_ok());
    }
}
