//! Import of mappings, from files, templates and versions: checked together, then published or
//! proposed, all or none.

use std::{collections::HashSet, fmt::Write as _};

use asi_model::FieldKey;
use connector_state::{
    queries,
    queries::ImportEffect,
    use_cases::import_mappings::{MappingImport, import_mappings},
};
use daemon::web::{Problem, problem::ProblemFault};
use disclosure::CapExcess;
use mapping_engine::{Mapping, MappingDiagnostic, Severity};
use serde::Serialize;
use utoipa::ToSchema;

use super::{
    context::Api,
    problems::{engine, over_cap_fault},
};
use crate::clock::now;

/// Most faults in one answer.
const FAULTS_MAX: usize = 1000;

/// A mapping to import.
pub(super) struct SubmittedMapping {
    pub mapping: Mapping,
    /// JSON pointer to it in the request, for faults.
    pub pointer: String,
}

/// Author and mode of an import.
#[derive(Clone, Copy)]
pub(super) struct ImportOptions<'o> {
    /// Name of the person who imports.
    pub author: &'o str,
    /// Origin of the mappings, for the list of versions.
    pub note: Option<&'o str>,
    /// True to change nothing and return the outcome that there would be.
    pub is_dry_run: bool,
}

/// Outcome of an import, or of its dry run.
#[derive(Debug, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct ImportOutcome {
    /// True if nothing was changed.
    is_dry_run: bool,
    /// Mappings that are the next version of their field and run, under the consent in force.
    published: usize,
    /// Mappings that are offered with the decision about their field, which is not mapped.
    proposed: usize,
    /// Mappings that were there already.
    unchanged: usize,
    /// Templates that are new or changed.
    pub(super) templates: usize,
    /// Each mapping that was not there already, in the order of the file.
    items: Vec<ImportedMapping>,
}

/// A mapping that an import changes.
#[derive(Debug, Serialize, ToSchema)]
pub struct ImportedMapping {
    key: FieldKey,
    /// Effect on the field.
    outcome: ImportEffect,
}

/// Checks mappings and imports them. A problem lists `faults`, which were found before, and all of
/// the mappings; then nothing is changed.
pub(super) async fn import(
    api: &Api,
    submitted: Vec<SubmittedMapping>,
    options: ImportOptions<'_>,
    mut faults: Vec<ProblemFault>,
) -> Result<ImportOutcome, Problem> {
    let mut outcome = ImportOutcome {
        is_dry_run: options.is_dry_run,
        published: 0,
        proposed: 0,
        unchanged: 0,
        templates: 0,
        items: Vec::new(),
    };
    let (mut changes, mut pointers, mut targets) = (Vec::new(), Vec::new(), HashSet::new());
    for (pointer, validated) in validate_for_fields(api, submitted).await? {
        let (mapping, placed) = match validated {
            Ok(validated) => validated,
            Err(mismatches) => {
                faults.extend(mismatches);
                continue;
            }
        };
        if !targets.insert(mapping.target.clone()) {
            faults.push(duplicate(&mapping, pointer));
            continue;
        }
        match placed {
            ImportEffect::Unchanged => {
                outcome.unchanged += 1;
                continue;
            }
            ImportEffect::Published => outcome.published += 1,
            ImportEffect::Proposed => outcome.proposed += 1,
        }
        let diagnostics = api.engine.check(mapping.clone()).await.map_err(engine)?;
        let errors = diagnostics.into_iter().filter(|found| found.severity == Severity::Error);
        faults.extend(errors.map(|error| invalid(error, &pointer)));
        outcome.items.push(ImportedMapping { key: mapping.target.clone(), outcome: placed });
        let (author, note) = (options.author.to_owned(), options.note.map(str::to_owned));
        pointers.push((pointer, mapping.clone()));
        changes.push(MappingImport { mapping, author, note });
    }
    if !faults.is_empty() {
        return Err(nothing_imported(faults));
    }
    let excesses = if options.is_dry_run || changes.is_empty() {
        let read = api.coordinator.read(move |state| {
            queries::import_excesses(state, changes.iter().map(|change| &change.mapping), now())
        });
        read.await?
    } else {
        let imported =
            api.coordinator.execute(|state, now| import_mappings(state, changes, now)).await?;
        imported.err().unwrap_or_default()
    };
    if excesses.is_empty() {
        Ok(outcome)
    } else {
        Err(nothing_imported(over_cap(&excesses, &pointers)))
    }
}

/// Returns a fault for each input that reads a variable under a cap that the import would exceed.
fn over_cap(excesses: &[CapExcess], mappings: &[(String, Mapping)]) -> Vec<ProblemFault> {
    let mut faults = Vec::new();
    for excess in excesses {
        for (pointer, mapping) in mappings {
            let inputs = mapping.inputs.iter().enumerate().filter(|(_, input)| {
                excess.variable.as_ref().is_none_or(|variable| {
                    variable.source_id == input.source_id && variable.node_id == input.node_id
                })
            });
            faults.extend(inputs.map(|(index, _)| {
                over_cap_fault(excess, format!("{pointer}/inputs/{index}/nodeId"))
            }));
        }
    }
    faults
}

/// Pointer of a mapping, and the mapping with the types of its field or the mismatches.
type Validated = (String, Result<(Mapping, ImportEffect), Vec<ProblemFault>>);

async fn validate_for_fields(
    api: &Api,
    submitted: Vec<SubmittedMapping>,
) -> Result<Vec<Validated>, Problem> {
    let validated = api.coordinator.read(move |state| {
        let validate = |SubmittedMapping { mapping, pointer }| {
            let validated = match queries::validate_for_field(state, mapping) {
                Ok(mapping) => {
                    let placed =
                        queries::import_effect(state, &mapping).unwrap_or(ImportEffect::Unchanged);
                    Ok((mapping, placed))
                }
                Err(mismatches) => Err(mismatches
                    .into_iter()
                    .map(|mismatch| ProblemFault {
                        pointer: format!("{pointer}/{}", mismatch.member),
                        code: "DOES_NOT_FIT".to_owned(),
                        message: mismatch.message,
                    })
                    .collect()),
            };
            (pointer, validated)
        };
        submitted.into_iter().map(validate).collect()
    });
    Ok(validated.await?)
}

fn duplicate(mapping: &Mapping, pointer: String) -> ProblemFault {
    let message = format!(
        "the field {} has another mapping before this one: keep one of them",
        mapping.target
    );
    ProblemFault { pointer, code: "TWICE".to_owned(), message }
}

fn invalid(error: MappingDiagnostic, pointer: &str) -> ProblemFault {
    let mut message = error.message;
    if let (Some(line), Some(column)) = (error.line, error.column) {
        write!(message, " (line {line}, column {column})").ok();
    }
    let pointer = format!("{pointer}{}", error.pointer);
    ProblemFault { pointer, code: "INVALID_MAPPING".to_owned(), message }
}

/// Returns the problem of an import that changed nothing.
pub(super) fn nothing_imported(mut faults: Vec<ProblemFault>) -> Problem {
    let count = faults.len();
    faults.truncate(FAULTS_MAX);
    let faults_are = if count == 1 { "one fault".to_owned() } else { format!("{count} faults") };
    Problem::unprocessable(
        "NOTHING_IMPORTED",
        format!("There are {faults_are}; nothing was changed."),
        faults,
    )
}
