//! Templates: a mapping with gaps, filled once per machine of a series.
//!
//! A template is the JSON of a mapping in which texts contain placeholders: `${machine}` is
//! replaced by the parameter, `${n:3}` by the number padded with zeros to three digits, `$${` is
//! `${`. A text that is nothing but a placeholder may stand where a number belongs.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value as Json;
use utoipa::ToSchema;

use crate::document::Mapping;

/// Deepest nesting of a template.
const DEPTH_MAX: usize = 32;
/// Longest text after filling, in bytes.
const TEXT_BYTES_MAX: usize = 1 << 17;
/// Widest padding.
const WIDTH_MAX: usize = 20;
/// Most members of a series.
const SERIES_MAX: usize = 10_000;

/// A mapping with gaps.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct MappingTemplate {
    /// Its identity within the connector.
    pub template_id: String,
    /// Name for people.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Purpose, for people.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub description: Option<String>,
    /// The parameters, for the form that asks for them.
    pub parameters: Vec<TemplateParameter>,
    /// The JSON of a mapping with placeholders.
    #[schema(value_type = TemplateContent)]
    pub mapping: Json,
}

/// The JSON of a mapping with placeholders: any object, since a placeholder may stand in the place
/// of a number or of a truth value.
#[derive(ToSchema)]
#[allow(dead_code)]
struct TemplateContent(BTreeMap<String, serde_json::Value>);

/// Placeholder in the documents of a template.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct TemplateParameter {
    /// Its name within `${...}`.
    pub name: String,
    /// Meaning, for people.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub description: Option<String>,
    /// Value where none is given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub default: Option<String>,
}

/// Fault of a template that does not become a mapping.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum TemplateFault {
    /// A placeholder names no parameter.
    #[error("{pointer}: the template has no parameter \"{name}\"")]
    UnknownParameter {
        /// JSON pointer into the template's mapping.
        pointer: String,
        /// Name in the placeholder.
        name: String,
    },
    /// A parameter has neither value nor default.
    #[error("the parameter \"{0}\" has no value")]
    MissingParameter(String),
    /// A value for a parameter that the template has not.
    #[error("the template has no parameter \"{0}\"")]
    UnusedValue(String),
    /// A placeholder that is not one.
    #[error("{pointer}: {message}")]
    Malformed {
        /// JSON pointer into the template's mapping.
        pointer: String,
        /// Sentence that names the fault.
        message: &'static str,
    },
    /// The filled template is not a mapping.
    #[error("what comes out is not a mapping: {0}")]
    NotAMapping(String),
}

impl MappingTemplate {
    /// Makes a template of a mapping: every text equal to a parameter's value becomes its
    /// placeholder, within texts too. `values` are tried longest first.
    #[must_use]
    pub fn from_mapping(
        template_id: &str,
        mapping: &Mapping,
        values: &BTreeMap<String, String>,
    ) -> Self {
        let mut sorted: Vec<(&String, &String)> =
            values.iter().filter(|(_, value)| !value.is_empty()).collect();
        sorted.sort_by_key(|(_, value)| std::cmp::Reverse(value.len()));
        let json = serde_json::to_value(mapping).expect("mappings have text keys only");
        let json = each_text(json, &|text| with_gaps(text, &sorted));
        let parameters = values.keys();
        let parameters = parameters.map(|name| TemplateParameter {
            name: name.clone(),
            description: None,
            default: None,
        });
        Self {
            template_id: template_id.to_owned(),
            name: None,
            description: None,
            parameters: parameters.collect(),
            mapping: json,
        }
    }

    /// Fills the gaps.
    ///
    /// # Errors
    /// [`TemplateFault`]. That a mapping comes out does not mean that it is a good one: it is to be
    /// checked.
    pub fn fill(&self, values: &BTreeMap<String, String>) -> Result<Mapping, TemplateFault> {
        if let Some(unused) =
            values.keys().find(|name| self.parameters.iter().all(|p| p.name != **name))
        {
            return Err(TemplateFault::UnusedValue(unused.clone()));
        }
        let mut given = BTreeMap::new();
        for parameter in &self.parameters {
            let value = values.get(&parameter.name).or(parameter.default.as_ref());
            let value =
                value.ok_or_else(|| TemplateFault::MissingParameter(parameter.name.clone()))?;
            given.insert(parameter.name.as_str(), value.as_str());
        }
        let filled = fill(&self.mapping, &given, &mut String::new(), 0)?;
        serde_json::from_value(filled)
            .map_err(|error| TemplateFault::NotAMapping(error.to_string()))
    }

    /// Fills the gaps once per set of values.
    ///
    /// # Errors
    /// The first set that does not fill, by its position, with the reason.
    pub fn fill_all(
        &self,
        sets: &[BTreeMap<String, String>],
    ) -> Result<Vec<Mapping>, (usize, TemplateFault)> {
        sets.iter()
            .enumerate()
            .map(|(index, values)| self.fill(values).map_err(|fault| (index, fault)))
            .collect()
    }
}

/// The numbers of a series: `1..12`, `1,3,7..9`. `None` for anything else, and beyond ten thousand.
#[must_use]
pub fn numbers(text: &str) -> Option<Vec<u32>> {
    let mut numbers = Vec::new();
    for part in text.split(',') {
        let (first, last) = part.split_once("..").unwrap_or((part, part));
        let (first, last): (u32, u32) = (first.trim().parse().ok()?, last.trim().parse().ok()?);
        let count = usize::try_from(last.checked_sub(first)?).ok()?;
        if numbers.len() + count >= SERIES_MAX {
            return None;
        }
        numbers.extend(first..=last);
    }
    Some(numbers)
}

/// Puts the names of parameters in the place of their values, of which the first that fits counts. What was put in is not
/// looked at again: it may have another value in it, and would grow with each of them.
fn with_gaps(text: &str, values: &[(&String, &String)]) -> String {
    let (mut result, mut rest) = (String::with_capacity(text.len()), text);
    while let Some(letter) = rest.chars().next() {
        let found = values.iter().find(|(_, value)| rest.starts_with(value.as_str()));
        let taken = if let Some((name, value)) = found {
            result.push_str("${");
            result.push_str(name);
            result.push('}');
            value.len()
        } else if rest.starts_with("${") {
            result.push_str("$${");
            2
        } else {
            result.push(letter);
            letter.len_utf8()
        };
        rest = &rest[taken..];
    }
    result
}

fn each_text(json: Json, change: &dyn Fn(&str) -> String) -> Json {
    match json {
        Json::String(text) => Json::String(change(&text)),
        Json::Array(elements) => {
            Json::Array(elements.into_iter().map(|element| each_text(element, change)).collect())
        }
        Json::Object(members) => Json::Object(
            members.into_iter().map(|(name, value)| (name, each_text(value, change))).collect(),
        ),
        other => other,
    }
}

fn fill(
    json: &Json,
    given: &BTreeMap<&str, &str>,
    pointer: &mut String,
    depth: usize,
) -> Result<Json, TemplateFault> {
    let malformed =
        |pointer: &str, message| TemplateFault::Malformed { pointer: pointer.to_owned(), message };
    if depth > DEPTH_MAX {
        return Err(malformed(pointer, "the template is nested too deep"));
    }
    let length = pointer.len();
    let filled = match json {
        Json::String(text) => {
            let filled = fill_text(text, given, pointer)?;
            if filled.len() > TEXT_BYTES_MAX {
                return Err(malformed(pointer, "a text gets too long"));
            }
            Json::String(filled)
        }
        Json::Array(elements) => {
            let mut filled = Vec::with_capacity(elements.len());
            for (index, element) in elements.iter().enumerate() {
                pointer.push_str(&format!("/{index}"));
                filled.push(fill(element, given, pointer, depth + 1)?);
                pointer.truncate(length);
            }
            Json::Array(filled)
        }
        Json::Object(members) => {
            let mut filled = serde_json::Map::with_capacity(members.len());
            for (name, member) in members {
                pointer.push_str(&format!("/{}", name.replace('~', "~0").replace('/', "~1")));
                filled.insert(name.clone(), fill(member, given, pointer, depth + 1)?);
                pointer.truncate(length);
            }
            Json::Object(filled)
        }
        other => other.clone(),
    };
    Ok(filled)
}

fn fill_text(
    text: &str,
    given: &BTreeMap<&str, &str>,
    pointer: &str,
) -> Result<String, TemplateFault> {
    let malformed = |message| TemplateFault::Malformed { pointer: pointer.to_owned(), message };
    let mut filled = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(at) = rest.find("${") {
        if let Some(before) = rest[..at].strip_suffix('$') {
            filled.push_str(before);
            filled.push_str("${");
            rest = &rest[at + 2..];
            continue;
        }
        filled.push_str(&rest[..at]);
        let (inside, after) = rest[at + 2..]
            .split_once('}')
            .ok_or_else(|| malformed("a placeholder is not closed"))?;
        let (name, width) =
            inside.split_once(':').map_or((inside, None), |(name, width)| (name, Some(width)));
        let value = given.get(name.trim()).ok_or_else(|| TemplateFault::UnknownParameter {
            pointer: pointer.to_owned(),
            name: name.trim().to_owned(),
        })?;
        match width {
            None => filled.push_str(value),
            Some(width) => {
                let width = width.trim().parse().ok().filter(|width| *width <= WIDTH_MAX);
                let width = width.ok_or_else(|| malformed("a width is a number up to 20"))?;
                let number: u64 =
                    value.parse().map_err(|_| malformed("only a whole number can be padded"))?;
                filled.push_str(&format!("{number:0width$}"));
            }
        }
        rest = after;
    }
    filled.push_str(rest);
    Ok(filled)
}
