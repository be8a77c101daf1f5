//! Export and import of mappings: as a table for spreadsheets, and as one readable file.

use axum::{
    Json,
    body::Bytes,
    extract::State,
    http::{HeaderMap, HeaderValue, header},
    response::{IntoResponse, Response},
};
use connector_state::queries;
use daemon::web::{ApiQuery, Problem, problem::ProblemFault};
use mapping_engine::exchange::{
    ExchangeError, FILE_BYTES_MAX, MappingFile, RowFault, read_table, write_table,
};
use serde::Deserialize;
use utoipa::{IntoParams, ToSchema};

use super::{
    context::Api,
    mapping_import::{ImportOptions, ImportOutcome, SubmittedMapping, import, nothing_imported},
    problems::Problems,
    roles::Engineer,
    templates,
};

/// Longest file that is accepted, in bytes.
pub const IMPORT_BYTES_MAX: usize = FILE_BYTES_MAX;

/// Format in which mappings are exported.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub enum ExportForm {
    /// A JSON document with mappings and templates, one member per line.
    #[default]
    File,
    /// A table with one line per mapping.
    Csv,
}

/// Choice of the form.
#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct MappingExportQuery {
    /// `file` (the default) or `csv`.
    #[serde(default)]
    #[param(inline)]
    form: ExportForm,
}

/// Exports all mappings, in force and proposed, in a form that can be imported again. The file has
/// the templates too.
#[utoipa::path(
    get,
    path = "/mappings/export",
    tag = "mappings",
    params(MappingExportQuery),
    responses(
        (status = 200, content((MappingFile = "application/json"), (String = "text/csv"))),
        Problems,
    )
)]
pub async fn export_mappings(
    _: Engineer,
    State(api): State<Api>,
    ApiQuery(query): ApiQuery<MappingExportQuery>,
) -> Result<Response, Problem> {
    let mappings = api.coordinator.read(queries::all_mappings).await?;
    let (kind, name, text) = match query.form {
        ExportForm::Csv => (
            "text/csv; charset=utf-8",
            "mappings.csv",
            write_table(&MappingFile::new(Vec::new(), mappings).mappings),
        ),
        ExportForm::File => {
            let templates = templates::load_all(&api).await?;
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

/// Mode of an import.
#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query, rename_all = "camelCase")]
#[serde(rename_all = "camelCase")]
pub struct ImportQuery {
    /// True to change nothing and return the outcome that there would be.
    #[serde(default)]
    dry_run: bool,
}

/// Imports mappings from a table (`text/csv`) or a readable file (`application/json`), as exported:
/// all or, if there is any fault, none, with a list of all faults and their positions. Consents stay
/// as they are: mappings of fields that are not mapped are proposals.
#[utoipa::path(
    post,
    path = "/mappings/import",
    tag = "mappings",
    params(ImportQuery),
    request_body(content((MappingFile = "application/json"), (String = "text/csv"))),
    responses((status = 200, body = ImportOutcome), Problems)
)]
pub async fn import_mappings(
    user: Engineer,
    State(api): State<Api>,
    ApiQuery(query): ApiQuery<ImportQuery>,
    headers: HeaderMap,
    body: Bytes,
) -> Result<Json<ImportOutcome>, Problem> {
    let content_type =
        headers.get(header::CONTENT_TYPE).and_then(|kind| kind.to_str().ok()).unwrap_or_default();
    let is_table = content_type.starts_with("text/csv");
    let file = read_file(&body, is_table)?;
    let submitted = file.mappings.into_iter().enumerate().map(|(index, mapping)| {
        // The line of a mapping in a table is not known here any more; its id is.
        let pointer = if is_table {
            format!("/{}", mapping.mapping_id)
        } else {
            format!("/mappings/{index}")
        };
        SubmittedMapping { mapping, pointer }
    });
    let author = &user.principal.user_name;
    let options = ImportOptions { author, note: Some("imported"), is_dry_run: query.dry_run };
    let faults = templates::faults(&file.templates);
    let mut outcome = import(&api, submitted.collect(), options, faults).await?;
    outcome.templates = templates::store_all(&api, file.templates, author, query.dry_run).await?;
    Ok(Json(outcome))
}

/// Reads a table or a readable file.
pub(super) fn read_file(body: &[u8], is_table: bool) -> Result<MappingFile, Problem> {
    let text = std::str::from_utf8(body).map_err(|_| {
        Problem::bad_request("NOT_TEXT", "The file is not UTF-8 text: export it as UTF-8.")
    })?;
    if is_table {
        Ok(MappingFile::new(Vec::new(), read_table(text).map_err(row_faults)?))
    } else {
        MappingFile::read(text).map_err(unreadable)
    }
}

fn row_faults(faults: Vec<RowFault>) -> Problem {
    let faults = faults.into_iter().map(|fault| ProblemFault {
        pointer: format!("/lines/{}/{}", fault.line, fault.column),
        code: "INVALID_LINE".to_owned(),
        message: fault.to_string(),
    });
    nothing_imported(faults.collect())
}

fn unreadable(error: ExchangeError) -> Problem {
    let fault = ProblemFault {
        pointer: String::new(),
        code: "UNREADABLE".to_owned(),
        message: error.to_string(),
    };
    nothing_imported(vec![fault])
}
