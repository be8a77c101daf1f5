//! Mappings as a table: one line each, for spreadsheets.
//!
//! The common mapping - one variable, perhaps a few functions - is a line of plain cells; what does
//! not fit a cell is JSON within it. Nothing is lost on the way out and back.

use asi_model::{FieldKey, NodeId};
use schemars::JsonSchema;
use serde::{Serialize, de::DeserializeOwned};
use shop_floor_model::SourceId;
use utoipa::ToSchema;

use super::csv;
use crate::document::{LateValues, Mapping, MappingId, MappingInput, Step};

/// The columns, in the order they are written. They may stand in any order when read, and all after
/// `targetType` may be left out.
const COLUMNS: [&str; 13] = [
    "mappingId",
    "operationNetworkId",
    "operationId",
    "dynamicDataRequestId",
    "fieldName",
    "targetType",
    "targetUnit",
    "targetValueRank",
    "lateValues",
    "sourceId",
    "nodeId",
    "inputs",
    "steps",
];
/// Columns that every table has.
const NEEDED: usize = 6;
/// Name of the one input of a plain line.
const PLAIN_INPUT: &str = "input";
/// Most lines.
const ROWS_MAX: usize = 200_000;

/// Fault of a line that is not a mapping.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema, ToSchema, thiserror::Error)]
#[serde(rename_all = "camelCase")]
#[error("line {line}, column {column}: {message}")]
pub struct RowFault {
    /// The line of the file, from 1.
    pub line: usize,
    /// The column by its name; empty where the whole line is meant.
    pub column: String,
    /// Sentence that names the fault.
    pub message: String,
}

/// Mappings as a table.
#[must_use]
pub fn write_table(mappings: &[Mapping]) -> String {
    let mut text = String::new();
    csv::write(&mut text, &COLUMNS);
    for mapping in mappings {
        let plain = mapping.inputs.as_slice().first().filter(|_| is_plain(mapping));
        let cells = [
            mapping.mapping_id.to_string(),
            mapping.target.request.operation_network_id.to_string(),
            mapping.target.request.operation_id.to_string(),
            mapping.target.request.dynamic_data_request_id.to_string(),
            mapping.target.field_name.to_string(),
            mapping.target_type.to_string(),
            mapping.target_unit.clone().unwrap_or_default(),
            if mapping.target_value_rank == -1 {
                String::new()
            } else {
                mapping.target_value_rank.to_string()
            },
            if mapping.late_values == LateValues::Use { "use".to_owned() } else { String::new() },
            plain.map(|input| input.source_id.to_string()).unwrap_or_default(),
            plain.map(|input| input.node_id.to_string()).unwrap_or_default(),
            if plain.is_some() || mapping.inputs.is_empty() {
                String::new()
            } else {
                json(&mapping.inputs)
            },
            if mapping.steps.is_empty() { String::new() } else { json(&mapping.steps) },
        ];
        csv::write(&mut text, &cells.each_ref().map(String::as_str));
    }
    text
}

/// Reads a table. Either all lines are mappings, or everything that is wrong is returned.
///
/// # Errors
/// One [`RowFault`] for each thing that is wrong, in the order of the lines.
pub fn read_table(text: &str) -> Result<Vec<Mapping>, Vec<RowFault>> {
    let fault = |line, message: &str| {
        vec![RowFault { line, column: String::new(), message: message.to_owned() }]
    };
    let rows = csv::read(text).map_err(|error| fault(error.line, error.message))?;
    if rows.len() > ROWS_MAX {
        return Err(fault(ROWS_MAX + 1, "a table has at most 200000 lines"));
    }
    let mut rows = rows.into_iter();
    let Some((line, header)) = rows.next() else { return Err(fault(1, "the table has no header")) };
    let columns = columns(line, &header)?;
    let (mut mappings, mut faults) = (Vec::new(), Vec::new());
    for (line, cells) in rows {
        match (Line { line, cells: &cells, columns: &columns, faults: Vec::new() }).mapping() {
            Ok(mapping) => mappings.push(mapping),
            Err(found) => faults.extend(found),
        }
    }
    if faults.is_empty() { Ok(mappings) } else { Err(faults) }
}

/// One variable under the usual name, with nothing said about how it is monitored.
fn is_plain(mapping: &Mapping) -> bool {
    matches!(mapping.inputs.as_slice(), [input] if *input == plain_input(input.source_id.clone(), input.node_id.clone()))
}

fn plain_input(source_id: SourceId, node_id: NodeId) -> MappingInput {
    MappingInput {
        name: PLAIN_INPUT.to_owned(),
        source_id,
        node_id,
        value_type: None,
        unit: None,
        triggers: true,
        monitor: Default::default(),
    }
}

fn json(value: &impl Serialize) -> String {
    serde_json::to_string(value).expect("mappings have text keys only")
}

/// Returns the index of each of [`COLUMNS`].
fn columns(line: usize, header: &[String]) -> Result<[Option<usize>; 13], Vec<RowFault>> {
    let mut faults = Vec::new();
    let mut wrong = |column: &str, message: &str| {
        faults.push(RowFault { line, column: column.to_owned(), message: message.to_owned() });
    };
    for name in header {
        if !COLUMNS.contains(&name.trim()) {
            wrong(name, "there is no such column");
        } else if header.iter().filter(|other| other.trim() == name.trim()).count() > 1 {
            wrong(name, "the column stands twice");
        }
    }
    let places = COLUMNS.map(|column| header.iter().position(|name| name.trim() == column));
    for (column, place) in COLUMNS.iter().zip(places).take(NEEDED) {
        if place.is_none() {
            wrong(column, "the column is missing");
        }
    }
    if faults.is_empty() { Ok(places) } else { Err(faults) }
}

struct Line<'a> {
    line: usize,
    cells: &'a [String],
    columns: &'a [Option<usize>; 13],
    faults: Vec<RowFault>,
}

impl Line<'_> {
    fn mapping(mut self) -> Result<Mapping, Vec<RowFault>> {
        let mapping_id =
            self.parsed("mappingId", |text| MappingId::new(text).map_err(|e| e.to_string()));
        let target = self.target();
        let target_type = self.parsed("targetType", |text| {
            serde_json::from_value(text.into())
                .map_err(|_| "there is no such built-in type".to_owned())
        });
        let target_value_rank = self.or("targetValueRank", -1, |text| {
            text.parse().map_err(|_| "a ValueRank is a whole number".to_owned())
        });
        let late_values = self.or("lateValues", LateValues::Ignore, |text| {
            serde_json::from_value(text.into())
                .map_err(|_| "it is \"ignore\" or \"use\"".to_owned())
        });
        let inputs = self.inputs();
        let steps = self.or("steps", Vec::new(), from_json::<Vec<Step>>);
        let target_unit = self.cell("targetUnit").map(str::to_owned);
        match (mapping_id, target, target_type) {
            (Some(mapping_id), Some(target), Some(target_type)) if self.faults.is_empty() => {
                Ok(Mapping {
                    mapping_id,
                    target,
                    target_type,
                    target_unit,
                    target_value_rank,
                    inputs,
                    steps,
                    late_values,
                })
            }
            _ => Err(self.faults),
        }
    }

    fn target(&mut self) -> Option<FieldKey> {
        let key = ["operationNetworkId", "operationId", "dynamicDataRequestId", "fieldName"].map(
            |column| {
                let text = self.parsed(column, |text| Ok::<_, String>(text.to_owned()));
                (column.to_owned(), text.unwrap_or_default().into())
            },
        );
        match serde_json::from_value(serde_json::Value::Object(key.into_iter().collect())) {
            Ok(key) => Some(key),
            Err(error) => {
                self.fault("fieldName", error.to_string());
                None
            }
        }
    }

    fn inputs(&mut self) -> Vec<MappingInput> {
        if self.cell("inputs").is_some() {
            if self.cell("nodeId").is_some() {
                self.fault("nodeId", "give either nodeId or inputs".to_owned());
            }
            return self.or("inputs", Vec::new(), from_json::<Vec<MappingInput>>);
        }
        if self.cell("nodeId").is_none() && self.cell("sourceId").is_none() {
            return Vec::new();
        }
        let source =
            self.parsed("sourceId", |text| SourceId::new(text).map_err(|error| error.to_string()));
        let node =
            self.parsed("nodeId", |text| text.parse::<NodeId>().map_err(|error| error.to_string()));
        source.zip(node).map(|(source, node)| plain_input(source, node)).into_iter().collect()
    }

    /// A cell that is not empty.
    fn cell(&self, column: &str) -> Option<&str> {
        let place = COLUMNS.iter().position(|name| *name == column)?;
        let text = self.cells.get((*self.columns.get(place)?)?)?;
        (!text.is_empty()).then_some(text)
    }

    fn parsed<T>(
        &mut self,
        column: &str,
        parse: impl FnOnce(&str) -> Result<T, String>,
    ) -> Option<T> {
        let parsed = match self.cell(column) {
            Some(text) => parse(text),
            None => Err("the cell is empty".to_owned()),
        };
        parsed.map_err(|message| self.fault(column, message)).ok()
    }

    fn or<T>(
        &mut self,
        column: &str,
        default: T,
        parse: impl FnOnce(&str) -> Result<T, String>,
    ) -> T {
        match self.cell(column).map(parse) {
            None => default,
            Some(Ok(value)) => value,
            Some(Err(message)) => {
                self.fault(column, message);
                default
            }
        }
    }

    fn fault(&mut self, column: &str, message: String) {
        self.faults.push(RowFault { line: self.line, column: column.to_owned(), message });
    }
}

fn from_json<T: DeserializeOwned>(text: &str) -> Result<T, String> {
    serde_json::from_str(text).map_err(|error| error.to_string())
}
