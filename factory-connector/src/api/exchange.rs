//! Mappings in and out: as a table for spreadsheets, and as one readable file.

use std::fmt::Write as _;

use asi_model::FieldKey;
use axum::{
    Json,
    body::Bytes,
    extract::State,
    http::{HeaderMap, HeaderValue, header},
    response::{IntoResponse, Response},
};
use daemon::web::{ApiQuery, Problem, problem::ProblemFault};
use mapping_engine::{
    Mapping, Severity,
    exchange::{ExchangeError, FILE_BYTES_MAX, MappingFile, read_table, write_table},
};
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};

use super::{
    Api,
    problems::{Problems, engine},
    roles::Engineer,
    templates,
};
use crate::books::{Placed, Placing};

/// Longest file that is taken, in bytes.
pub const IMPORT_BYTES_MAX: usize = FILE_BYTES_MAX;
/// Most faults in one answer.
const FAULTS_MAX: usize = 1000;

/// In which form.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub enum ExportForm {
    /// A JSON document with mappings and templates, one member per line.
    #[default]
    File,
    /// A table with one line per mapping.
    Csv,
}

/// In which form.
#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct ExportQuery {
    /// `file` (the default) or `csv`.
    #[serde(default)]
    #[param(inline)]
    form: ExportForm,
}

/// All mappings, in force and proposed, in a form that can be imported again; the file has the
/// templates too.
#[utoipa::path(
    get,
    path = "/mappings/export",
    tag = "mappings",
    params(ExportQuery),
    responses(
        (status = 200, content((MappingFile = "application/json"), (String = "text/csv"))),
        Problems,
    )
)]
pub async fn export_mappings(
    _: Engineer,
    State(api): State<Api>,
    ApiQuery(query): ApiQuery<ExportQuery>,
) -> Result<Response, Problem> {
    let mappings = api.desk.read(|books| books.all_mappings()).await?;
    let (kind, name, text) = match query.form {
        ExportForm::Csv => (
            "text/csv; charset=utf-8",
            "mappings.csv",
            write_table(&MappingFile::new(Vec::new(), mappings).mappings),
        ),
        ExportForm::File => {
            let templates = templates::all(&api).await?;
            ("application/json", "mappings.json", MappingFile::new(templates, mappings).write())
        }
    };
    let disposition = HeaderValue::from_str(&format!("attachment; filename=\"{name}\""))
        .map_err(|error| Problem::internal(&error))?;
    Ok((
        [
            (header::CONTENT_TYPE, HeaderValue::from_static(kind)),
            (header::CONTENT_DISPOSITION, disposition),
        ],
        text,
    )
        .into_response())
}

/// Whether to do it.
#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query, rename_all = "camelCase")]
#[serde(rename_all = "camelCase")]
pub struct ImportQuery {
    /// True: say what would happen and change nothing.
    #[serde(default)]
    dry_run: bool,
}

/// What an import did, or would do.
#[derive(Debug, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct ImportOutcome {
    /// Nothing was changed.
    is_dry_run: bool,
    /// Mappings that are the next version of their field and run, under the consent in force.
    published: usize,
    /// Mappings that are offered with the decision about their field, which is not mapped.
    proposed: usize,
    /// Mappings that were there already.
    unchanged: usize,
    /// Templates that were new or other.
    templates: usize,
    /// Each mapping that was not there already, in the order of the file.
    items: Vec<PlacedMapping>,
}

/// What became of a mapping.
#[derive(Debug, Serialize, ToSchema)]
pub struct PlacedMapping {
    /// Its field.
    key: FieldKey,
    /// What became of it.
    outcome: Placed,
}

/// Takes mappings from a table (`text/csv`) or a readable file (`application/json`), as exported.
/// Either everything is taken or, where anything is wrong, nothing, and every fault is named with
/// its place. Consents stay as they are: mappings of fields that are not mapped are proposals.
#[utoipa::path(
    post,
    path = "/mappings/import",
    tag = "mappings",
    params(ImportQuery),
    request_body(content((MappingFile = "application/json"), (String = "text/csv"))),
    responses((status = 200, body = ImportOutcome), Problems)
)]
pub async fn import_mappings(
    Engineer(user): Engineer,
    State(api): State<Api>,
    ApiQuery(query): ApiQuery<ImportQuery>,
    headers: HeaderMap,
    body: Bytes,
) -> Result<Json<ImportOutcome>, Problem> {
    let text = std::str::from_utf8(&body).map_err(|_| {
        Problem::bad_request("NOT_TEXT", "The file is not UTF-8 text: export it as UTF-8.")
    })?;
    let content_type =
        headers.get(header::CONTENT_TYPE).and_then(|kind| kind.to_str().ok()).unwrap_or_default();
    let (file, is_table) = if content_type.starts_with("text/csv") {
        (MappingFile::new(Vec::new(), read_table(text).map_err(row_faults)?), true)
    } else {
        (MappingFile::read(text).map_err(unreadable)?, false)
    };
    let wanted = file.mappings.into_iter().enumerate().map(|(index, mapping)| {
        // A mapping of a table is named by its id, since its line is known only to who wrote the
        // file.
        let pointer = if is_table {
            format!("/{}", mapping.mapping_id)
        } else {
            format!("/mappings/{index}")
        };
        Wanted { mapping, pointer }
    });
    let wanted: Vec<Wanted> = wanted.collect();
    let mut faults = templates::faults(&file.templates);
    let placed = place_or_tell(
        &api,
        wanted,
        &user.principal.user_name,
        Some("imported"),
        query.dry_run,
        &mut faults,
    );
    let mut outcome = placed.await?;
    outcome.templates =
        templates::take(&api, file.templates, &user.principal.user_name, query.dry_run).await?;
    Ok(Json(outcome))
}

/// A mapping to place, and where it stands in what was sent.
pub(super) struct Wanted {
    pub mapping: Mapping,
    pub pointer: String,
}

/// Checks mappings and places them, all or none.
pub(super) async fn place(
    api: &Api,
    wanted: Vec<Wanted>,
    author: &str,
    note: Option<String>,
    is_dry_run: bool,
) -> Result<ImportOutcome, Problem> {
    place_or_tell(api, wanted, author, note.as_deref(), is_dry_run, &mut Vec::new()).await
}

async fn place_or_tell(
    api: &Api,
    wanted: Vec<Wanted>,
    author: &str,
    note: Option<&str>,
    is_dry_run: bool,
    faults: &mut Vec<ProblemFault>,
) -> Result<ImportOutcome, Problem> {
    let fitted = api
        .desk
        .read(move |books| {
            wanted
                .into_iter()
                .map(|Wanted { mapping, pointer }| {
                    let outcome = books.fitted(mapping).map(|mapping| {
                        let outcome = books.outcome_of(&mapping).unwrap_or(Placed::Unchanged);
                        (mapping, outcome)
                    });
                    (pointer, outcome)
                })
                .collect::<Vec<_>>()
        })
        .await?;
    let (mut placings, mut items) = (Vec::new(), Vec::new());
    let mut outcome = ImportOutcome {
        is_dry_run,
        published: 0,
        proposed: 0,
        unchanged: 0,
        templates: 0,
        items: Vec::new(),
    };
    let mut seen = std::collections::HashSet::new();
    for (pointer, fitted) in fitted {
        let (mapping, placed) = match fitted {
            Ok(fitted) => fitted,
            Err(misfits) => {
                faults.extend(misfits.into_iter().map(|misfit| ProblemFault {
                    pointer: format!("{pointer}/{}", misfit.member),
                    code: "DOES_NOT_FIT".to_owned(),
                    message: misfit.message,
                }));
                continue;
            }
        };
        if !seen.insert(mapping.target.clone()) {
            let message = format!(
                "the field {} has another mapping before this one: keep one of them",
                mapping.target
            );
            faults.push(ProblemFault { pointer, code: "TWICE".to_owned(), message });
            continue;
        }
        match placed {
            Placed::Unchanged => {
                outcome.unchanged += 1;
                continue;
            }
            Placed::Published => outcome.published += 1,
            Placed::Proposed => outcome.proposed += 1,
        }
        let diagnostics = api.engine.check(mapping.clone()).await.map_err(engine)?;
        faults.extend(
            diagnostics.into_iter().filter(|found| found.severity == Severity::Error).map(
                |found| {
                    let mut message = found.message;
                    if let (Some(line), Some(column)) = (found.line, found.column) {
                        write!(message, " (line {line}, column {column})").ok();
                    }
                    ProblemFault {
                        pointer: format!("{pointer}{}", found.pointer),
                        code: "INVALID_MAPPING".to_owned(),
                        message,
                    }
                },
            ),
        );
        items.push(PlacedMapping { key: mapping.target.clone(), outcome: placed });
        placings.push(Placing {
            mapping,
            author: author.to_owned(),
            note: note.map(str::to_owned),
        });
    }
    if !faults.is_empty() {
        return Err(refused(std::mem::take(faults)));
    }
    if !is_dry_run && !placings.is_empty() {
        api.desk.place(placings).await?;
    }
    outcome.items = items;
    Ok(outcome)
}

/// Nothing was changed, and why.
pub(super) fn refused(mut faults: Vec<ProblemFault>) -> Problem {
    let count = faults.len();
    faults.truncate(FAULTS_MAX);
    let faults_are = if count == 1 { "one fault".to_owned() } else { format!("{count} faults") };
    Problem::unprocessable(
        "NOTHING_IMPORTED",
        format!("There are {faults_are}; nothing was changed."),
        faults,
    )
}

fn row_faults(faults: Vec<mapping_engine::exchange::RowFault>) -> Problem {
    let faults = faults.into_iter().map(|fault| ProblemFault {
        pointer: format!("/lines/{}/{}", fault.line, fault.column),
        code: "INVALID_LINE".to_owned(),
        message: fault.to_string(),
    });
    refused(faults.collect())
}

fn unreadable(error: ExchangeError) -> Problem {
    let fault = ProblemFault {
        pointer: String::new(),
        code: "UNREADABLE".to_owned(),
        message: error.to_string(),
    };
    refused(vec![fault])
}
